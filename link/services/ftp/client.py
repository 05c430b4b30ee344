"""Client half of MAVLink FTP, read-only: downloads a file or lists a folder.

A file arrives as bursts; lost pieces are requested one by one. The size that the vehicle reports is only an upper
bound, because ArduPilot estimates it for files that it generates on open. Source:
https://mavlink.io/en/services/ftp.html.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from dialects import messages as m
from link.core import Outgoing, Received
from link.services.ftp.files import Entry
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, parse_packet
from link.services.ftp.reassembly import FileReassembly

REPEAT_AFTER = 0.7
"""s without a reply before a request is repeated: longer than a round trip on a loaded 57600 baud radio (0.4 s)."""
BURST_TIMEOUT = 1.0
"""s without data before a burst is requested again: at 40 % of a 57600 baud radio a message takes 0.12 s."""
TRIES = 16
"""Requests without a reply before a job fails: 11 s."""
WINDOW = 8
"""Missing pieces requested at once: 2 kB, a third of a second of a 57600 baud radio."""
MAX_SIZE = 32 * 1024 * 1024
"""Bytes of a download: a day's log. More would be an attack on our memory."""
MAX_ENTRIES = 10_000
END = bytes([FtpError.END_OF_FILE])


class FtpOperation(Enum):
    """What the client is doing."""

    DOWNLOAD = "download"
    LIST = "list"


@dataclass(frozen=True, slots=True)
class FtpOutcome:
    """How a job ended."""

    job: FtpOperation
    path: str
    done: bool
    data: bytes = b""
    entries: tuple[Entry, ...] = ()
    error: int | None = None
    """MAV_FTP_ERR of the vehicle; None after success or without a reply."""


class _Phase(Enum):
    REQUEST = 0
    """One request is open: OPEN, LIST or TERMINATE."""
    BURST = 1
    FILL = 2


@dataclass(slots=True)
class _FtpTransfer:
    """The job under way."""

    job: FtpOperation
    path: str
    session: int
    phase: _Phase = _Phase.REQUEST
    pending: FtpPacket | None = None
    due: float = 0.0
    tries: int = 0
    file: FileReassembly = field(default_factory=lambda: FileReassembly(MAX_SIZE))
    entries: list[Entry] = field(default_factory=list)


class FtpClient:
    """Talks to one vehicle, one job at a time; a new job replaces the one under way."""

    def __init__(self, system: int, component: int, *, target_system: int, target_component: int = 1) -> None:
        self._ids = (system, component)
        self._target = (target_system, target_component)
        self._sequence = 0
        self._session = 0
        self._work: _FtpTransfer | None = None
        self._outbox: list[Outgoing] = []
        self._outcomes: list[FtpOutcome] = []

    def download(self, path: str, now: float) -> None:
        """Download a file. `path` is ASCII, e.g. "/logs/1.bin" or "@PARAM/param.pck"."""
        self._begin(FtpOperation.DOWNLOAD, FtpOpcode.OPEN, path, now)

    def list_folder(self, path: str, now: float) -> None:
        """List a folder."""
        self._begin(FtpOperation.LIST, FtpOpcode.LIST, path, now)

    def cancel(self) -> None:
        """Cancel the job under way, without an outcome."""
        if self._work and self._work.job is FtpOperation.DOWNLOAD:
            self._send(self._packet(FtpOpcode.TERMINATE, self._work.session))
        self._work = None

    @property
    def busy(self) -> bool:
        """Whether a job is under way."""
        return self._work is not None

    @property
    def progress(self) -> tuple[int, int | None]:
        """Bytes that have arrived, and the most that the file may have."""
        work = self._work
        if work is None or work.phase is _Phase.REQUEST:
            return 0, None
        return work.file.received.bytes, work.file.end

    def receive(self, received: Received, now: float) -> None:
        """Handle a reply of the vehicle; other messages are ignored."""
        message, work = received.message, self._work
        if work is None or received.system != self._target[0] or not isinstance(message, m.FileTransferProtocol):
            return
        if message.target_system != self._ids[0] or message.target_component not in (0, self._ids[1]):
            return
        packet = parse_packet(message)
        match packet.req_opcode:
            case FtpOpcode.OPEN if self._is_reply(work, packet):
                self._opened(work, packet, now)
            case FtpOpcode.LIST if self._is_reply(work, packet):
                self._listed(work, packet, now)
            case FtpOpcode.BURST if work.phase is not _Phase.REQUEST and packet.session == work.session:
                self._burst(work, packet, now)
            case FtpOpcode.READ if work.phase is _Phase.FILL:
                self._piece(work, packet, now)

    def tick(self, now: float) -> None:
        """Repeat overdue requests, and give up at last."""
        work = self._work
        if work is None or now < work.due:
            return
        if work.tries >= TRIES:
            self._fail(work, None)
        elif work.phase is _Phase.REQUEST and work.pending:
            self._repeat(work, work.pending, now, REPEAT_AFTER)
        elif work.phase is _Phase.BURST:
            self._request_burst(work, now)
        else:
            self._fill(work, now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[FtpOutcome]:
        """Return the jobs that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    # ---- start and end ----

    def _begin(self, job: FtpOperation, op: FtpOpcode, path: str, now: float) -> None:
        self.cancel()
        self._session = (
            self._session + 1
        ) & 0xFF  # a new session, so that late data of the last job is not taken for this one's
        work = self._work = _FtpTransfer(job, path, self._session)
        self._repeat(
            work, self._packet(op, work.session, path.encode("ascii", "replace")[:MAX_DATA]), now, REPEAT_AFTER
        )

    def _opened(self, work: _FtpTransfer, packet: FtpPacket, now: float) -> None:
        if packet.op != FtpOpcode.ACK:
            self._fail(work, packet)
            return
        work.session = packet.session
        announced = int.from_bytes(packet.data[:4], "little") if len(packet.data) >= 4 else MAX_SIZE
        if announced > MAX_SIZE:
            self._fail(work, None)
            return
        work.file, work.tries = FileReassembly(announced), 0
        self._request_burst(work, now)

    def _finish(self, work: _FtpTransfer) -> None:
        self._work = None
        if work.job is FtpOperation.DOWNLOAD:
            self._send(self._packet(FtpOpcode.TERMINATE, work.session))
        data = work.file.data if work.job is FtpOperation.DOWNLOAD else b""
        self._outcomes.append(FtpOutcome(work.job, work.path, True, data, tuple(work.entries)))

    def _fail(self, work: _FtpTransfer, packet: FtpPacket | None) -> None:
        self._work = None
        if work.phase is not _Phase.REQUEST:
            self._send(self._packet(FtpOpcode.TERMINATE, work.session))
        error = (packet.data[0] if packet.data else FtpError.FAIL) if packet else None
        self._outcomes.append(FtpOutcome(work.job, work.path, False, error=error))

    # ---- listing ----

    def _listed(self, work: _FtpTransfer, packet: FtpPacket, now: float) -> None:
        ended = packet.op == FtpOpcode.NAK and packet.data[:1] == END
        if packet.op != FtpOpcode.ACK and not ended:
            self._fail(work, packet)
            return
        lines = [] if ended else [line for line in packet.data.split(b"\0") if line]
        work.entries += [entry for entry in map(_entry, lines) if entry]
        if not lines or len(work.entries) >= MAX_ENTRIES:
            self._finish(work)
            return
        work.tries = 0
        offset = (work.pending.offset if work.pending else 0) + len(lines)
        path = work.path.encode("ascii", "replace")[:MAX_DATA]
        self._repeat(work, self._packet(FtpOpcode.LIST, work.session, path, offset), now, REPEAT_AFTER)

    # ---- downloading ----

    def _burst(self, work: _FtpTransfer, packet: FtpPacket, now: float) -> None:
        if packet.op == FtpOpcode.NAK:
            if packet.data[:1] == END:
                self._start_filling(work, now)
            elif work.phase is _Phase.BURST:
                self._fail(work, packet)
            return
        work.file.add_piece(packet.offset, packet.data)
        if work.phase is not _Phase.BURST:
            return
        work.tries, work.due = 0, now + BURST_TIMEOUT
        if work.file.received.end >= work.file.end:
            self._start_filling(work, now)
        elif packet.burst_complete:
            self._request_burst(work, now)

    def _start_filling(self, work: _FtpTransfer, now: float) -> None:
        if work.phase is not _Phase.FILL:
            work.phase, work.tries = _Phase.FILL, 0
            self._fill(work, now)

    def _piece(self, work: _FtpTransfer, packet: FtpPacket, now: float) -> None:
        offset = work.file.pop_request(packet.sequence)
        if offset is None:
            return
        if packet.op == FtpOpcode.ACK and packet.data:
            work.file.add_piece(packet.offset, packet.data)
        elif packet.op == FtpOpcode.ACK or packet.data[:1] == END:
            work.file.truncate(offset)
        else:
            self._fail(work, packet)
            return
        work.tries = 0
        self._fill(work, now)

    def _fill(self, work: _FtpTransfer, now: float) -> None:
        """Request a few of the missing pieces; finish if there are none."""
        if work.file.complete:
            self._finish(work)
            return
        work.tries += work.file.expire_requests(now)
        for offset, size in work.file.next_missing(WINDOW, MAX_DATA):
            packet = self._packet(FtpOpcode.READ, work.session, b"", offset, size)
            work.file.mark_requested((packet.sequence + 1) & SEQUENCE_MASK, offset, now + REPEAT_AFTER)
            self._send(packet)
        work.due = work.file.next_due(now + REPEAT_AFTER)

    def _request_burst(self, work: _FtpTransfer, now: float) -> None:
        work.phase = _Phase.BURST
        self._repeat(
            work, self._packet(FtpOpcode.BURST, work.session, b"", work.file.received.end, MAX_DATA), now, BURST_TIMEOUT
        )

    # ---- packets ----

    def _is_reply(self, work: _FtpTransfer, packet: FtpPacket) -> bool:
        pending = work.pending
        return (
            pending is not None
            and packet.req_opcode == pending.op
            and packet.sequence == (pending.sequence + 1) & SEQUENCE_MASK
        )

    def _packet(
        self, op: FtpOpcode, session: int, data: bytes = b"", offset: int = 0, size: int | None = None
    ) -> FtpPacket:
        self._sequence = (self._sequence + 1) & SEQUENCE_MASK
        return FtpPacket(self._sequence, op, session, data, offset, size=size)

    def _repeat(self, work: _FtpTransfer, packet: FtpPacket, now: float, timeout: float) -> None:
        work.pending, work.due = packet, now + timeout
        work.tries += 1
        self._send(packet)

    def _send(self, packet: FtpPacket) -> None:
        self._outbox.append(Outgoing(packet.message(*self._target)))


def _entry(line: bytes) -> Entry | None:
    """Parse a line of a listing; None if it is neither file nor folder. Names are made printable."""
    name, _, size = line[1:].decode("ascii", "replace").partition("\t")
    match line[:1]:
        case b"D":
            return Entry(m.printable(name), None)
        case b"F" if size.isdigit():
            return Entry(m.printable(name), int(size))
    return None
