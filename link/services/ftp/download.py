"""Downloads a file: bursts, then the lost pieces one by one, then the checksum.

The size that the vehicle reports is only an upper bound, because ArduPilot estimates it for files that it generates on
open.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from msgspec.structs import replace

from link.services.ftp.job import (
    MAX_SIZE,
    REPEAT_AFTER,
    TRIES,
    Exchange,
    FtpLine,
    FtpOperation,
    FtpOutcome,
    error_of,
    failure,
)
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, crc32
from link.services.ftp.reassembly import FileReassembly

BURST_TIMEOUT = 1.0
"""s without data before a burst is requested again: at 40 % of a 57600 baud radio a message takes 0.12 s."""
WINDOW = 8
"""Missing pieces requested at once: 2 kB, a third of a second of a 57600 baud radio."""
CHECKSUM_TIMEOUT = 5.0
"""s for the vehicle to compute a checksum: ArduPilot reads 1 MB/s from a card."""
CHECKSUM_TRIES = 3
MAX_GROWTHS = 8
"""How often a file that has grown meanwhile, such as the log that is being written, is followed to its new end."""
CHANGED = "the checksum differs: the file was changed while it was downloaded"


class _Phase(Enum):
    OPEN = 0
    BURST = 1
    FILL = 2
    CHECKSUM = 3


@dataclass(slots=True)
class Download:
    """An FtpJob. `have`: the beginning of the file, from an earlier job. `verify`: compare the checksum at the end."""

    line: FtpLine
    path: str
    raw: bytes
    have: bytes = b""
    verify: bool = False
    patience: int = TRIES
    outcome: FtpOutcome | None = None
    _phase: _Phase = _Phase.OPEN
    _due: float = 0.0
    _tries: int = 0
    _growths: int = 0
    _exchange: Exchange = field(init=False)
    _file: FileReassembly = field(default_factory=lambda: FileReassembly(MAX_SIZE))

    def __post_init__(self) -> None:
        self._exchange = Exchange(self.line, self.patience)

    @property
    def progress(self) -> tuple[int, int | None]:
        """Bytes that have arrived, and the most that the file may have."""
        if self._phase is _Phase.OPEN:
            return len(self.have), None
        return self._file.received.bytes, self._file.end

    @property
    def holes(self) -> int:
        """Gaps in what has arrived."""
        return sum(1 for _ in self._file.received.gaps(self._file.received.end))

    @property
    def beginning(self) -> bytes:
        """What arrived without a gap from the start."""
        return self.have if self._phase is _Phase.OPEN else self._file.beginning

    def begin(self, now: float) -> None:
        """Open the file."""
        self._exchange.begin(self.line.packet(FtpOpcode.OPEN, self.raw), now)

    def receive(self, reply: FtpPacket, now: float) -> None:
        """Handle a reply."""
        match reply.req_opcode:
            case FtpOpcode.OPEN | FtpOpcode.CRC if self._exchange.take(reply):
                if reply.req_opcode == FtpOpcode.OPEN:
                    self._opened(reply, now)
                else:
                    self._verified(reply, now)
            case FtpOpcode.BURST if self._is_transferring and reply.session == self.line.session:
                self._burst(reply, now)
            case FtpOpcode.READ if self._phase is _Phase.FILL:
                self._piece(reply, now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, and give up at last."""
        match self._phase:
            case _Phase.OPEN if not self._exchange.tick(now):
                self.outcome = failure(FtpOperation.DOWNLOAD, self.path, None, self.patience)
            case _Phase.CHECKSUM if now >= self._exchange.due:
                self._repeat_checksum(now)
            case _Phase.BURST | _Phase.FILL if now >= self._due:
                self._continue(now)

    def abandon(self) -> None:
        """Close the file on the vehicle."""
        if self._is_transferring:
            self.line.send(self.line.packet(FtpOpcode.TERMINATE))

    @property
    def _is_transferring(self) -> bool:
        return self._phase in (_Phase.BURST, _Phase.FILL)

    def _opened(self, reply: FtpPacket, now: float) -> None:
        if reply.op != FtpOpcode.ACK:
            self.outcome = failure(FtpOperation.DOWNLOAD, self.path, reply, 0)
            return
        self.line.session = reply.session
        announced = int.from_bytes(reply.data[:4], "little") if len(reply.data) >= 4 else MAX_SIZE
        self._phase = _Phase.BURST
        if announced > MAX_SIZE:
            self._fail(f"{announced} bytes are more than {MAX_SIZE}")
            return
        if self._growths and announced <= len(self.have):
            self._fail(CHANGED)
            return
        self._file = FileReassembly(announced)
        if len(self.have) <= announced:
            self._file.add_piece(0, self.have)
        self._request_burst(now)

    def _continue(self, now: float) -> None:
        if self._tries >= TRIES:
            self._fail(f"no answer after {TRIES} tries")
        elif self._phase is _Phase.BURST:
            self._request_burst(now)
        else:
            self._fill(now)

    # ---- transfer ----

    def _request_burst(self, now: float) -> None:
        if self._file.received.end >= self._file.end:
            self._start_filling(now)
            return
        self._due, self._tries = now + BURST_TIMEOUT, self._tries + 1
        self.line.send(self.line.packet(FtpOpcode.BURST, b"", self._file.received.end, MAX_DATA))

    def _burst(self, reply: FtpPacket, now: float) -> None:
        if reply.op == FtpOpcode.NAK:
            if error_of(reply) == FtpError.END_OF_FILE:
                self._start_filling(now)
            elif self._phase is _Phase.BURST:
                self._fail_by(reply)
            return
        self._file.add_piece(reply.offset, reply.data)
        if self._phase is not _Phase.BURST:
            return
        self._tries, self._due = 0, now + BURST_TIMEOUT
        if self._file.received.end >= self._file.end:
            self._start_filling(now)
        elif reply.burst_complete:
            self._request_burst(now)

    def _start_filling(self, now: float) -> None:
        if self._phase is not _Phase.FILL:
            self._phase, self._tries = _Phase.FILL, 0
            self._fill(now)

    def _piece(self, reply: FtpPacket, now: float) -> None:
        offset = self._file.pop_request(reply.sequence)
        if offset is None:
            return
        if reply.op == FtpOpcode.ACK and reply.data:
            self._file.add_piece(reply.offset, reply.data)
        elif reply.op == FtpOpcode.ACK or error_of(reply) == FtpError.END_OF_FILE:
            self._file.truncate(offset)
        else:
            self._fail_by(reply)
            return
        self._tries = 0
        self._fill(now)

    def _fill(self, now: float) -> None:
        """Request a few of the missing pieces; finish if there are none."""
        if self._file.complete:
            self._close(now)
            return
        self._tries += self._file.expire_requests(now)
        for offset, size in self._file.next_missing(WINDOW, MAX_DATA):
            packet = self.line.packet(FtpOpcode.READ, b"", offset, size)
            self._file.mark_requested((packet.sequence + 1) & SEQUENCE_MASK, offset, now + REPEAT_AFTER)
            self.line.send(packet)
        self._due = self._file.next_due(now + REPEAT_AFTER)

    # ---- end ----

    def _close(self, now: float) -> None:
        self.abandon()
        if self.verify:
            self._phase = _Phase.CHECKSUM
            self._exchange = Exchange(self.line, CHECKSUM_TRIES)
            self._exchange.begin(self.line.packet(FtpOpcode.CRC, self.raw), now, CHECKSUM_TIMEOUT)
        else:
            self.outcome = FtpOutcome(FtpOperation.DOWNLOAD, self.path, True, self._file.data)

    def _repeat_checksum(self, now: float) -> None:
        if self._exchange.sent < CHECKSUM_TRIES:
            self._exchange.repeat(now, CHECKSUM_TIMEOUT)
        else:
            self._finish(None)

    def _verified(self, reply: FtpPacket, now: float) -> None:
        """Compare with the checksum of the vehicle; if it differs, get what the file has grown by since then."""
        computed = reply.op == FtpOpcode.ACK and len(reply.data) >= 4
        checksum = int.from_bytes(reply.data[:4], "little") if computed else None
        if checksum in (None, crc32(self._file.data)):
            self._finish(checksum)
        elif self._growths < MAX_GROWTHS:
            self.have, self._growths, self._phase, self._tries = self._file.data, self._growths + 1, _Phase.OPEN, 0
            self._exchange = Exchange(self.line, self.patience)
            self.begin(now)
        else:
            self._fail(CHANGED)

    def _finish(self, checksum: int | None) -> None:
        """End with the checksum of the vehicle; without one the file counts as it is."""
        self.outcome = FtpOutcome(FtpOperation.DOWNLOAD, self.path, True, self._file.data, checksum=checksum)

    def _fail_by(self, reply: FtpPacket) -> None:
        self._fail("")
        self.outcome = replace(failure(FtpOperation.DOWNLOAD, self.path, reply, 0), data=self.beginning)

    def _fail(self, problem: str) -> None:
        self.abandon()
        self.outcome = FtpOutcome(FtpOperation.DOWNLOAD, self.path, False, self.beginning, problem=problem)
