"""The screen's end of the pipe: starts the station process, sends it intents, receives its snapshots."""

from __future__ import annotations

import contextlib
import socket
import subprocess
import threading
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from groundstation.intents.session import Quit
from groundstation.intents.union import AnyIntent
from groundstation.ipc import (
    MAX_PACKET,
    SOCKET_BUFFER,
    IntentBatch,
    StationFailed,
    StationReady,
    clock,
    decode_from_station,
    encode,
)
from groundstation.processes import end_process, start_module
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.views.base import View

START_TIMEOUT = 15.0
"""s for the station to open its links: Python's start on a slow Pi (3 s) and a host name to resolve (10 s)."""

CLOSE_TIMEOUT = 1.0
"""s for the station to send its neutral frames and exit before it is killed. It needs 0.25 s."""

MAX_PENDING = 256
"""Intents kept for a station that does not read. Only those that are `valid_when_late` are kept."""


OUTAGE_TAG, TAG_BYTES = StationOutage.__name__.encode(), 32
"""The tag of a StationOutage, and where it stands in a packet: snapshots in between are not even decoded."""


class StationError(RuntimeError):
    """The station process could not start; the message is one line for the user."""


class StationClient:
    """One station process, and the pipe to it. `send` may be called from any thread, the rest from one."""

    def __init__(self, pipe: socket.socket, process: subprocess.Popen[bytes], endpoints: tuple[str, ...]) -> None:
        self.endpoints = endpoints
        self._pipe = pipe
        self._process = process
        self._lock = threading.Lock()
        self._pending: deque[AnyIntent] = deque(maxlen=MAX_PENDING)
        self._open = True
        self._newest = Snapshot()
        self._views: dict[type[View], View] = {}
        self.outage = StationOutage()
        """What the watchdog reports of a station process that has ended or does not respond."""

    @classmethod
    def start(
        cls,
        endpoints: Sequence[str],
        *,
        system: int = 255,
        style: str = "hold",
        speed: float = 0.6,
        sitl: bool = False,
        log_file: Path | None = None,
        dialect: str | None = None,
        param_docs: Path | None = None,
        terminal: str | None = None,
        meanwhile: Callable[[], object] = lambda: None,
    ) -> StationClient:
        """Start the station process and wait until its links are open. Raises StationError.

        `dialect` is an XML file that the station reads. `terminal` is the path of the terminal that is reset if this
        process is killed. `meanwhile` is called first: the process takes 0.2 s to import its modules.
        """
        options = [f"--system={system}", f"--style={style}", f"--speed={speed}", *(["--sitl"] if sitl else [])]
        if log_file is not None:
            options.append(f"--log-file={log_file}")
        if dialect is not None:
            options.append(f"--dialect={dialect}")
        if param_docs is not None:
            options.append(f"--param-docs={param_docs}")
        if terminal is not None:
            options.append(f"--terminal={terminal}")
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            for half in (ours, theirs):
                half.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
            process = _spawn(theirs.fileno(), options, endpoints)
        try:
            meanwhile()
            hello = _hello(ours)
        except BaseException:
            end_process(process, CLOSE_TIMEOUT)
            ours.close()
            raise
        ours.setblocking(False)
        return cls(ours, process, hello.endpoints)

    @property
    def pid(self) -> int:
        """Process id of the station."""
        return self._process.pid

    def send(self, *intents: AnyIntent) -> None:
        """Send intents to the station; never blocks, never raises. The intents of one call stay together."""
        with self._lock:
            if not self._open:
                return
            packet = (*self._pending, *intents)
            try:
                self._pipe.send(encode(IntentBatch(clock(), packet)))
                self._pending.clear()
            except BlockingIOError:
                self._pending.extend(intent for intent in intents if intent.valid_when_late)
            except OSError:  # the station has exited; `alive` is False from now on
                self._open = False

    def fileno(self) -> int:
        """Return the descriptor of the pipe, for the screen's loop to wait on."""
        return self._pipe.fileno()

    def receive(self) -> Snapshot | None:
        """Return the newest snapshot received, or None. Never blocks; `alive` is False once the station has exited.

        The watchdog writes to the same pipe; its newest report becomes `outage`.
        """
        snapshot: Snapshot | None = None
        while True:
            try:
                packet = self._pipe.recv(MAX_PACKET)
            except BlockingIOError:
                break
            except OSError:
                packet = b""
            if not packet:
                self._open = False
                break
            with contextlib.suppress(msgspec.DecodeError):
                message = decode_from_station(packet)
                if isinstance(message, View):
                    self._views[type(message)] = message
                elif isinstance(message, StationOutage):
                    self.outage = message
                elif isinstance(message, Snapshot):
                    snapshot = message
        self._newest = snapshot or self._newest
        return snapshot

    def pop_views(self) -> list[View]:
        """Return the newest view of each kind that `receive` has read since the last call."""
        views, self._views = self._views, {}
        return list(views.values())

    @property
    def open(self) -> bool:
        """Packets may still arrive: the station or its watchdog runs."""
        return self._open

    @property
    def left_armed(self) -> tuple[str, ...]:
        """One line for each vehicle that the station armed and left armed, by its newest snapshot.

        After the station has ended too early, the last report of the watchdog comes first.
        """
        lines = self._newest.left_armed
        if not self.outage.ended:
            return lines
        return (self.outage.text, *(f"last known before: {line}" for line in lines))

    @property
    def vehicle_name(self) -> str:
        """Name of the vehicle in the newest snapshot; "" if there is none."""
        return self._newest.vehicle.name if self._newest.vehicle is not None else ""

    @property
    def alive(self) -> bool:
        """The station runs. False once its end of the pipe is closed: intents can no longer be sent."""
        return self._open and self._process.poll() is None

    def close(self) -> int | None:
        """Let the station send neutral and exit, within about a second. Returns its exit code (negative: signal)."""
        self.send(Quit())
        code = end_process(self._process, CLOSE_TIMEOUT)
        self.receive()
        with self._lock:
            self._open = False
            self._pipe.close()
        return code


def _spawn(descriptor: int, options: Sequence[str], endpoints: Sequence[str]) -> subprocess.Popen[bytes]:
    try:
        arguments = [f"--fd={descriptor}", *options, "--", *endpoints]
        return start_module("groundstation.station_process", arguments, pass_fds=[descriptor])
    except OSError as error:
        raise StationError(f"the station process did not start: {error.strerror}") from error


def _hello(pipe: socket.socket) -> StationReady:
    pipe.settimeout(START_TIMEOUT)
    try:
        packet = pipe.recv(MAX_PACKET)
    except TimeoutError as error:
        raise StationError(f"the station process did not answer within {START_TIMEOUT:.0f} s") from error
    except OSError as error:
        raise StationError(f"the station process ended: {error.strerror}") from error
    first = (
        decode_from_station(packet)
        if packet
        else StationFailed("the station process ended before it was ready; its log says why")
    )
    if isinstance(first, StationFailed):
        raise StationError(first.line)
    if not isinstance(first, StationReady):
        raise StationError("the station process has a different version")
    return first
