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

from groundstation.host_process import REPLAY, STATION, ArgumentsError, HostProcess
from groundstation.intents.session import Detach, Quit
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import TAKE_OFF_ALTITUDE
from groundstation.ipc import (
    MAX_PACKET,
    IntentBatch,
    StationReady,
    clock,
    decode_from_station,
    encode,
    protocol_version,
)
from groundstation.recording.options import RecordOptions
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.station_socket.connect import SOCKET_BUFFER, NoStationError, connect
from groundstation.station_socket.folder import FolderError
from groundstation.station_socket.hello import HELLO_WITHIN, SCREEN, Hello, StationFailed
from groundstation.views.base import View
from link.runtime.child_process import end_process
from link.transport.receive_buffer import ReceiveBuffer

START_TIMEOUT = 60.0
"""s for the station to open its links: Python's start on a slow Pi (3 s, far more beside other work) and a host name to
resolve (10 s). A station that ends meanwhile is not waited for."""

CLOSE_TIMEOUT = 1.0
"""s for the station to send its neutral frames and exit before it is killed. It needs 0.25 s."""

MAX_PENDING = 256
"""Intents kept for a station that does not read. Only those that are `valid_when_late` are kept."""


class StationError(RuntimeError):
    """The station process could not start; the message is one line for the user."""


class StationClient:
    """One station process, and the pipe to it. `send` may be called from any thread, the rest from one."""

    def __init__(
        self,
        pipe: socket.socket,
        watchdog: socket.socket | None,
        process: subprocess.Popen[bytes] | None,
        ready: StationReady,
    ) -> None:
        """`watchdog` leads to that of the station. It and `process` are None for a station that was there before."""
        self.endpoints = ready.endpoints
        self.first_request = ready.first_request
        self._pipe = pipe
        self._watchdog = watchdog
        self._buffer = ReceiveBuffer(MAX_PACKET)
        self._process = process
        self._keep = False
        self._lock = threading.Lock()
        self._pending: deque[AnyIntent] = deque(maxlen=MAX_PENDING)
        self._open = True
        """Intents can be sent."""
        self._ended = False
        """All that the station has sent is read."""
        self._newest = Snapshot()
        self._logs: dict[str, None] = {}
        """Logs of this session, in their order."""
        self._goes_on = process is None
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
        take_off: float = TAKE_OFF_ALTITUDE,
        sitl: bool = False,
        simulators: Sequence[Sequence[str]] = (),
        log_file: Path | None = None,
        dialect: str | None = None,
        sign_key: str | None = None,
        require_signing: bool = False,
        param_docs: Path | None = None,
        record: RecordOptions | None = None,
        terminal: str | None = None,
        keep: bool = False,
        process: HostProcess | None = None,
        meanwhile: Callable[[], object] = lambda: None,
    ) -> StationClient:
        """Start the station process and wait until its links are open. Raises StationError.

        `simulators`: with `sitl`, options of each rover, in place of the usual one. `dialect` is an XML file that the
        station reads. `terminal` is the path of the terminal that is reset if this
        process is killed. `keep`: the station goes on then. `process` runs already and waits for its arguments.
        `meanwhile` is called first: the process takes 0.1 s to import its modules.
        """
        options = [f"--system={system}", f"--style={style}", f"--speed={speed}", f"--take-off={take_off}"]
        options += ["--sitl"] if sitl else []
        options += [f"--simulator={' '.join(each)}" for each in simulators]
        options += ["--keep"] if keep else []
        if log_file is not None:
            options.append(f"--log-file={log_file}")
        if dialect is not None:
            options.append(f"--dialect={dialect}")
        if sign_key is not None:
            options.append(f"--sign-key={sign_key}")
        options += ["--require-signing"] if require_signing else []
        if param_docs is not None:
            options.append(f"--param-docs={param_docs}")
        if record is not None:
            options += record.arguments
        if terminal is not None:
            options.append(f"--terminal={terminal}")
        client = cls._open_process(process or _spawn(STATION), [*options, "--", *endpoints], meanwhile)
        client._keep = keep
        return client

    @classmethod
    def start_replay(
        cls,
        file: Path,
        *,
        at: str = "",
        speed: float = 1.0,
        log_file: Path | None = None,
        dialect: str | None = None,
        param_docs: Path | None = None,
        meanwhile: Callable[[], object] = lambda: None,
    ) -> StationClient:
        """Start a process that replays a telemetry log in place of a station: it has no links. Raises StationError.

        `at`: time at which it begins, as a text; `speed`: factor. The others as for start().
        """
        given = {"--log-file": log_file, "--dialect": dialect, "--param-docs": param_docs}
        options = [f"{name}={value}" for name, value in given.items() if value is not None]
        words = [*options, f"--at={at}", f"--speed={speed}", "--", str(file)]
        return cls._open_process(_spawn(REPLAY), words, meanwhile)

    @classmethod
    def _open_process(
        cls, process: HostProcess, arguments: Sequence[str], meanwhile: Callable[[], object]
    ) -> StationClient:
        """Give a process its arguments, and wait until it is ready. Raises StationError."""
        try:
            process.pipe.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
            with contextlib.suppress(OSError):  # it has ended: reading says so
                process.send_arguments(arguments)
            meanwhile()
            ready = _read_ready(process.pipe, START_TIMEOUT)
        except ArgumentsError as error:
            process.end()
            raise StationError(str(error)) from error
        except BaseException:
            process.end(CLOSE_TIMEOUT)
            raise
        for pipe in filter(None, (process.pipe, process.watchdog)):
            pipe.setblocking(False)
        return cls(*process.release(), ready)

    @classmethod
    def attach(cls, pid: int, name: str, *, watches: bool = False) -> StationClient:
        """Connect to a station that runs, as one more screen of this name. Raises StationError.

        `watches`: it does not drive unless its operator asks to.
        """
        try:
            pipe = connect(pid, Hello(SCREEN, protocol_version(), name, watches=watches))
        except (NoStationError, FolderError, OSError) as error:
            raise StationError(str(error)) from error
        try:
            ready = _read_ready(pipe, HELLO_WITHIN)
        except BaseException:
            pipe.close()
            raise
        pipe.setblocking(False)
        return cls(pipe, None, None, ready)

    @property
    def pid(self) -> int:
        """Process id of the station that this screen has started."""
        assert self._process is not None
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

    def filenos(self) -> list[int]:
        """Return the descriptors for the screen's loop to wait on: of the station and its watchdog while they run."""
        ends = (None if self._ended else self._pipe, self._watchdog)
        return [end.fileno() for end in ends if end is not None]

    def receive(self) -> Snapshot | None:
        """Return the newest snapshot received, or None. Never blocks; `alive` is False once the station has exited.

        The newest report of the watchdog becomes `outage`.
        """
        snapshot: Snapshot | None = None
        while not self._ended and (packet := self._read_packet(self._pipe)) is not None:
            if not packet:
                self._open, self._ended = False, True
                break
            with contextlib.suppress(msgspec.DecodeError):
                message = decode_from_station(packet)
                if isinstance(message, View):
                    self._views[type(message)] = message
                elif isinstance(message, Snapshot):
                    snapshot = message
                    if message.recording is not None and message.recording.path:
                        self._logs[message.recording.path] = None
        self._read_watchdog()
        self._newest = snapshot or self._newest
        return snapshot

    def _read_watchdog(self) -> None:
        while self._watchdog is not None and (packet := self._read_packet(self._watchdog)) is not None:
            if not packet:
                self._watchdog.close()
                self._watchdog = None
                break
            with contextlib.suppress(msgspec.DecodeError):
                message = decode_from_station(packet)
                if isinstance(message, StationOutage):
                    self.outage = message

    def _read_packet(self, pipe: socket.socket) -> bytes | None:
        """Return the next packet, b"" at the end, None if none has arrived."""
        try:
            return self._buffer.recv(pipe)
        except BlockingIOError:
            return None
        except ConnectionResetError:  # raised once, if intents were unread at the end; what was sent before follows
            return self._read_packet(pipe)
        except OSError:
            return b""

    def pop_views(self) -> list[View]:
        """Return the newest view of each kind that `receive` has read since the last call."""
        views, self._views = self._views, {}
        return list(views.values())

    @property
    def left_armed(self) -> tuple[str, ...]:
        """One line for each vehicle that the station armed and left armed, by its newest snapshot.

        Simulators of a station that has ended are gone with it. After the station has ended too early, the last report
        of the watchdog comes first.
        """
        ended = () if self._goes_on else self._newest.end_armed
        lines = tuple(line for line in self._newest.left_armed if line not in ended)
        if not self.outage.ended:
            return lines
        return (self.outage.text, *(f"last known before: {line}" for line in lines))

    @property
    def logs(self) -> tuple[str, ...]:
        """Paths of the logs of this session, the oldest first; none of a station that goes on."""
        return () if self._goes_on else tuple(self._logs)

    @property
    def vehicle_name(self) -> str:
        """Name of the vehicle in the newest snapshot; "" if there is none."""
        return self._newest.vehicle.name if self._newest.vehicle is not None else ""

    @property
    def alive(self) -> bool:
        """The station runs. False once its end of the pipe is closed: intents can no longer be sent."""
        return self._open and (self._process is None or self._process.poll() is None)

    def close(self, *, quits: bool = True) -> int | None:
        """End the connection: a station that this screen has started sends neutral and exits, within about a second.

        `quits`: the operator wants that; else one that is to be kept goes on. Returns the exit code of the station
        (negative: signal), None while it runs.
        """
        self.send(Quit() if quits else Detach())
        if self._watchdog is not None:
            with contextlib.suppress(OSError):  # it has ended
                self._watchdog.send(encode(IntentBatch(clock(), (Quit(),))))  # the terminal is in order
        self._goes_on = self._process is None or (self._keep and not quits)
        code = None if self._goes_on or self._process is None else end_process(self._process, CLOSE_TIMEOUT)
        self.receive()
        with self._lock:
            self._open, self._ended = False, True
            self._pipe.close()
        if self._watchdog is not None:
            self._watchdog.close()
            self._watchdog = None
        return code


def _spawn(module: str) -> HostProcess:
    try:
        return HostProcess(module)
    except OSError as error:
        raise StationError(f"the station process did not start: {error.strerror}") from error


def _read_ready(pipe: socket.socket, within: float) -> StationReady:
    pipe.settimeout(within)
    try:
        packet = pipe.recv(MAX_PACKET)
    except TimeoutError as error:
        raise StationError(f"the station process did not answer within {within:.0f} s") from error
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
