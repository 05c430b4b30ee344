"""A verb's connection to a station that runs, in the place of links of its own."""

from __future__ import annotations

import asyncio
import contextlib
import math
import socket
from collections.abc import Callable, Sequence

import msgspec

from dialects import codec
from dialects.messages import MESSAGES
from groundstation.station_socket.about import describe_stations
from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.station_socket.hello import HELLO_WITHIN, Hello, StationFailed
from groundstation.station_socket.packets import read_packet
from groundstation.station_socket.relay import (
    ALIVE_PERIOD,
    MAX_RELAYED,
    Alive,
    DemandRefused,
    Heard,
    HeardMessage,
    LinksReport,
    MessageRefused,
    ToSend,
    VerbReady,
    decode_from_station,
    encode,
)
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from link.core import Core, Peer, Received, RefusalListener
from link.protocol.log_tap import LogTap
from link.transport.receive_buffer import ReceiveBuffer

AUTO, ONLY, NEVER = "auto", "only", "never"
"""Values of --station; another one is a process id."""


def station_choice(text: str) -> str:
    """Check a value of --station. Raises ValueError."""
    if text in (AUTO, ONLY, NEVER) or text.isdecimal():
        return text
    raise ValueError(text)


class StationLostError(VerbError):
    """No station takes a verb, though one runs: it does not answer, or has ended."""

    def __init__(self, code: ExitCode, text: str, endpoints: Sequence[str] = ()) -> None:
        super().__init__(code, text)
        self.endpoints = endpoints
        """Those that it had open, if it has said so."""


class SeveralStationsError(VerbError):
    """Several stations run, of which none is named."""

    def __init__(self, pids: Sequence[int]) -> None:
        super().__init__(ExitCode.USAGE, "")
        self.pids = pids

    def __str__(self) -> str:
        """Return one line; asks the stations what they are, for which a stop does not wait."""
        return f"stations {describe_stations(self.pids)} run here: name one with --station PID"


class StationLink:
    """An open connection; `ready` has the ids and the session of the station."""

    def __init__(self, sock: socket.socket, ready: VerbReady) -> None:
        self.sock = sock
        self.ready = ready

    @classmethod
    def open(cls, pid: int, hello: Hello, within: float = HELLO_WITHIN) -> StationLink:
        """Connect to the station with this process id. Raises StationLostError."""
        try:
            sock = connect(pid, hello, within)
        except (NoStationError, FolderError) as error:
            raise StationLostError(ExitCode.USAGE, str(error)) from error
        try:
            answer = decode_from_station(sock.recv(MAX_RELAYED))
        except (OSError, msgspec.DecodeError):
            answer = StationFailed(f"station {pid} does not answer; --station never opens links without it")
        if isinstance(answer, VerbReady):
            sock.setblocking(False)
            return cls(sock, answer)
        sock.close()
        line = answer.line if isinstance(answer, StationFailed) else f"station {pid} has another version"
        raise StationLostError(ExitCode.USAGE, line)


def find_station(
    choice: str,
    endpoints: Sequence[str],
    hello: Hello,
    note: Callable[[str], None],
    within: float = HELLO_WITHIN,
) -> StationLink | None:
    """Return the station that a verb goes through; None: it opens links of its own. Raises VerbError.

    That is StationLostError or SeveralStationsError where a stop has another way. With `endpoints`, those that the user
    named, a station counts only if it has them open. `note` gets why stations cannot be looked for. A station that does
    not answer `within` s is none.
    """
    if choice == NEVER:
        return None
    if choice.isdecimal():
        return StationLink.open(int(choice), hello, within)
    try:
        pids = running_stations()
    except FolderError as error:
        if choice == AUTO:
            note(f"no running station is used: {error}")
            return None
        raise VerbError(ExitCode.USAGE, str(error)) from error
    found = _matching(pids, endpoints, hello, within) if endpoints else pids
    if len(found) > 1:
        raise SeveralStationsError(found)
    if found:
        return StationLink.open(found[0], hello, within)
    if choice == ONLY:
        which = f"no station here has {' '.join(endpoints)} open" if pids else "no station runs here"
        raise VerbError(ExitCode.NO_VEHICLE, which)
    return None


def _matching(pids: Sequence[int], endpoints: Sequence[str], hello: Hello, within: float) -> list[int]:
    """Return the stations that have the endpoints open."""
    found = []
    for pid in pids:
        with contextlib.suppress(VerbError):
            link = StationLink.open(pid, hello, within)
            link.sock.close()
            if set(endpoints) <= set(link.ready.endpoints):
                found.append(pid)
    return found


class StationRunner:
    """Drives the core of a verb over the connection, as link.runner.Runner does over links."""

    def __init__(
        self,
        core: Core,
        link: StationLink,
        period: float,
        take_reports: Callable[[LinksReport], None],
        log_tap: LogTap | None = None,
        patience: float = math.inf,
    ) -> None:
        """`log_tap` records what the station hears, as frames without signatures.

        A station that does not answer for `patience` s is lost.
        """
        self._core = core
        self._socket = link.sock
        self._buffer = ReceiveBuffer(MAX_RELAYED)
        self._period = period
        self._take_reports = take_reports
        self._log_tap = log_tap
        self._endpoints = link.ready.endpoints
        self._patience = patience
        self._asked_at = -math.inf
        self._unanswered_since = math.inf
        self._ended: asyncio.Future[None] = asyncio.get_running_loop().create_future()

    async def run(self) -> None:
        """Run until stop(); raise what the core raises, StationLostError, and VerbError for a refused demand."""
        loop = asyncio.get_running_loop()
        loop.add_reader(self._socket, self._guard, self._read)
        ticking = loop.create_task(self._tick())
        try:
            await self._ended
        finally:
            ticking.cancel()
            loop.remove_reader(self._socket)
            with contextlib.suppress(Exception):
                self._flush()
            self._socket.close()

    def stop(self) -> None:
        """End run()."""
        if not self._ended.done():
            self._ended.set_result(None)

    def flush(self) -> None:
        """Send the core's messages now."""
        self._guard(self._flush)

    def observe(self) -> None:
        """Do nothing: the station reports its links by itself."""

    async def _tick(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            self._guard(self._run_tick)
            await asyncio.sleep(self._period)
            if loop.time() - self._asked_at >= ALIVE_PERIOD:
                self._guard(self._ask)

    def _ask(self) -> None:
        """Ask whether the station runs. What it has said while this process stood still is read first."""
        self._read()
        now = self._asked_at = asyncio.get_running_loop().time()
        if now - self._unanswered_since > self._patience:
            silence = f"the station has not answered for {now - self._unanswered_since:.1f} s"
            raise StationLostError(ExitCode.NO_ANSWER, silence, self._endpoints)
        self._unanswered_since = min(self._unanswered_since, now)
        self._send(ToSend())

    def _run_tick(self) -> None:
        self._core.tick(asyncio.get_running_loop().time())
        self._flush()

    def _guard(self, step: Callable[[], None]) -> None:
        if self._ended.done():
            return
        try:
            step()
        except Exception as error:
            self._ended.set_exception(error)

    def _flush(self) -> None:
        messages = tuple(
            (type(each.message).id, codec.encode_payload(each.message)) for each in self._core.messages_to_send()
        )
        if messages:
            self._send(ToSend(messages))

    def _send(self, packet: ToSend) -> None:
        with contextlib.suppress(OSError):  # a full queue: what must arrive is repeated; a station that ended: _read
            self._socket.send(encode(packet))

    def _read(self) -> None:
        now = asyncio.get_running_loop().time()
        while (packet := read_packet(self._socket, self._buffer)) is not None:
            if not packet:
                ended = "the station that this verb went through has ended"
                raise StationLostError(ExitCode.NO_ANSWER, ended, self._endpoints)
            self._unanswered_since = math.inf
            self._handle(packet, now)
        self._flush()

    def _handle(self, packet: bytes, now: float) -> None:
        match decode_from_station(packet):
            case Heard(messages):
                for heard in messages:
                    self._take(heard, now)
            case LinksReport() as links:
                self._take_reports(links)
            case MessageRefused(number, payload, why):
                if isinstance(self._core, RefusalListener):
                    self._core.handle_refused(codec.decode(number, payload), why, now)
            case Alive():
                pass
            case DemandRefused(line):
                raise VerbError(ExitCode.NOT_IN_CONTROL, line)

    def _take(self, heard: HeardMessage, now: float) -> None:
        if heard.message not in MESSAGES:
            return
        if self._log_tap is not None:
            raw = codec.frame(heard.message, heard.payload, heard.sequence, heard.system, heard.component)
            frame = (heard.message, heard.system, heard.component, heard.sequence, raw)
            self._log_tap.record_received([frame], heard.link, now)
        self._core.receive(_received(heard), now)


def _received(heard: HeardMessage) -> Received:
    message = codec.decode(heard.message, heard.payload)
    peer = Peer(heard.link, heard.address or "station", name=heard.name)
    return Received(message, heard.system, heard.component, heard.sequence, peer, introduced=True, named=True,
                    numbering=heard.numbering, clash=heard.clash)  # fmt: skip
