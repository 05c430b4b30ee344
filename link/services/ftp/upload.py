"""Uploads a file: creates it, writes several pieces at once, closes it and compares the checksum."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum

from link.services.ftp.job import REPEAT_AFTER, TRIES, Exchange, FtpLine, FtpOperation, FtpOutcome, failure
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpOpcode, FtpPacket, crc32

WINDOW = 4
"""Pieces under way: 1 kB, which a 57600 baud radio holds in its buffer."""
CHECKSUM_TIMEOUT = 5.0
DIFFERS = "the checksum of the file on the vehicle differs: upload it again"


class _Phase(Enum):
    CREATE = 0
    WRITE = 1
    CLOSE = 2
    CHECKSUM = 3


@dataclass(slots=True)
class Upload:
    """An FtpJob. An existing file is replaced."""

    line: FtpLine
    path: str
    raw: bytes
    data: bytes
    outcome: FtpOutcome | None = None
    _phase: _Phase = _Phase.CREATE
    _exchange: Exchange = field(init=False)
    _waiting: dict[int, tuple[FtpPacket, float, int]] = field(default_factory=dict)
    """Sequence of the reply -> the piece, when it is sent again, how often it was sent."""
    _next: int = 0
    """Offset of the next piece."""
    _written: int = 0

    def __post_init__(self) -> None:
        self._exchange = Exchange(self.line)

    @property
    def progress(self) -> tuple[int, int | None]:
        """Bytes that the vehicle has written, and all."""
        return self._written, len(self.data)

    def begin(self, now: float) -> None:
        """Create the file."""
        self._exchange.begin(self.line.packet(FtpOpcode.CREATE, self.raw), now)

    def receive(self, reply: FtpPacket, now: float) -> None:
        """Handle a reply."""
        if reply.req_opcode == FtpOpcode.WRITE:
            self._acknowledged(reply, now)
        elif self._exchange.take(reply):
            self._answered(reply, now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, and give up at last."""
        if self._phase is not _Phase.WRITE:
            if not self._exchange.tick(now):
                self._end_without_answer()
            return
        for key, (packet, due, sent) in list(self._waiting.items()):
            if now < due:
                continue
            if sent >= TRIES:
                self._fail(None)
                return
            self.line.send(packet)
            self._waiting[key] = (packet, now + REPEAT_AFTER, sent + 1)

    def abandon(self) -> None:
        """Close the file on the vehicle."""
        if self._phase in (_Phase.WRITE, _Phase.CLOSE):
            self.line.send(self.line.packet(FtpOpcode.TERMINATE))

    def _answered(self, reply: FtpPacket, now: float) -> None:
        if reply.op != FtpOpcode.ACK and self._phase is not _Phase.CHECKSUM:
            self._fail(reply)
            return
        match self._phase:
            case _Phase.CREATE:
                self.line.session, self._phase = reply.session, _Phase.WRITE
                self._write(now)
            case _Phase.CLOSE:
                self._phase = _Phase.CHECKSUM
                self._exchange.begin(self.line.packet(FtpOpcode.CRC, self.raw), now, CHECKSUM_TIMEOUT)
            case _Phase.CHECKSUM:
                computed = reply.op == FtpOpcode.ACK and len(reply.data) >= 4
                self._finish(int.from_bytes(reply.data[:4], "little") if computed else None)

    def _acknowledged(self, reply: FtpPacket, now: float) -> None:
        found = self._waiting.pop(reply.sequence, None)
        if found is None:
            return
        if reply.op != FtpOpcode.ACK:
            self._fail(reply)
            return
        self._written += len(found[0].data)
        self._write(now)

    def _write(self, now: float) -> None:
        """Send the next pieces; close the file behind the last."""
        while len(self._waiting) < WINDOW and self._next < len(self.data):
            packet = self.line.packet(FtpOpcode.WRITE, self.data[self._next : self._next + MAX_DATA], self._next)
            self._waiting[(packet.sequence + 1) & SEQUENCE_MASK] = (packet, now + REPEAT_AFTER, 1)
            self._next += len(packet.data)
            self.line.send(packet)
        if not self._waiting:
            self._phase = _Phase.CLOSE
            self._exchange.begin(self.line.packet(FtpOpcode.TERMINATE), now)

    def _end_without_answer(self) -> None:
        """End a job without a reply; a vehicle that only lacks checksums has the file."""
        if self._phase is _Phase.CHECKSUM:
            self._finish(None)
        else:
            self._fail(None)

    def _finish(self, checksum: int | None) -> None:
        same = checksum in (None, crc32(self.data))
        self.outcome = FtpOutcome(
            FtpOperation.UPLOAD, self.path, same, problem="" if same else DIFFERS, checksum=checksum
        )

    def _fail(self, reply: FtpPacket | None) -> None:
        self.abandon()
        self.outcome = failure(FtpOperation.UPLOAD, self.path, reply, TRIES)
