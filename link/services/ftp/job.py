"""What all jobs of the FTP client share: the outcome, the numbering of packets, a request that is repeated."""

from __future__ import annotations

from enum import Enum
from typing import Protocol

import msgspec

from link.core import Outgoing
from link.services.ftp.files import DirectoryEntry
from link.services.ftp.protocol import MAX_DATA, SEQUENCE_MASK, FtpError, FtpOpcode, FtpPacket, ftp_error_text

REPEAT_AFTER = 0.7
"""s without a reply before a request is repeated: longer than a round trip on a loaded 57600 baud radio (0.4 s)."""
TRIES = 16
"""Requests without a reply before a job fails: 11 s."""
MAX_SIZE = 32 * 1024 * 1024
"""Bytes of a file: a day's log. More would be an attack on our memory."""


class FtpOperation(Enum):
    """What a job does."""

    DOWNLOAD = "download"
    LIST = "list"
    UPLOAD = "upload"
    REMOVE = "remove"
    CHECKSUM = "checksum"


class FtpOutcome(msgspec.Struct, frozen=True):
    """How a job ended."""

    job: FtpOperation
    path: str
    done: bool
    data: bytes = b""
    """Of a download; of one that failed, what arrived without a gap from the start, with which it can be resumed."""
    entries: tuple[DirectoryEntry, ...] = ()
    error: int | None = None
    """MAV_FTP_ERR of the vehicle; None after success or without a reply."""
    problem: str = ""
    """What went wrong, one line; empty after success."""
    checksum: int | None = None
    """CRC-32 (protocol.crc32) that the vehicle has computed; None: not requested, or the vehicle cannot."""
    number: int = 0
    """Number of the job (FtpClient)."""


class FtpLine(msgspec.Struct):
    """Numbers the packets of one job and queues them for sending."""

    target: tuple[int, int]
    session: int
    sequence: int
    outbox: list[Outgoing] = msgspec.field(default_factory=list)

    def packet(self, op: FtpOpcode, data: bytes = b"", offset: int = 0, size: int | None = None) -> FtpPacket:
        """Return a new packet."""
        self.sequence = (self.sequence + 1) & SEQUENCE_MASK
        return FtpPacket(self.sequence, op, self.session, data, offset, size=size)

    def send(self, packet: FtpPacket) -> None:
        """Send a packet."""
        self.outbox.append(Outgoing(packet.message(*self.target)))


class Exchange(msgspec.Struct):
    """One request that is repeated until its reply. `patience`: requests without a reply before it fails."""

    line: FtpLine
    patience: int = TRIES
    packet: FtpPacket | None = None
    due: float = 0.0
    sent: int = 0

    def begin(self, packet: FtpPacket, now: float, timeout: float = REPEAT_AFTER) -> None:
        """Send a request, in place of the one before."""
        self.packet, self.sent = packet, 0
        self.repeat(now, timeout)

    def repeat(self, now: float, timeout: float = REPEAT_AFTER) -> None:
        """Send the request again."""
        assert self.packet is not None
        self.line.send(self.packet)
        self.sent += 1
        self.due = now + timeout

    def take(self, reply: FtpPacket) -> bool:
        """Return whether this is the reply to the request, which then is no longer repeated."""
        request = self.packet
        if request is None or reply.req_opcode != request.op:
            return False
        if reply.sequence != (request.sequence + 1) & SEQUENCE_MASK:
            return False
        self.packet = None
        return True

    def tick(self, now: float) -> bool:
        """Repeat the request if its reply is overdue; return False if that is enough."""
        if self.packet is None or now < self.due:
            return True
        if self.sent >= self.patience:
            return False
        self.repeat(now)
        return True


class FtpJob(Protocol):
    """One job: sends its first packet in begin() and sets `outcome` at the end."""

    outcome: FtpOutcome | None

    @property
    def progress(self) -> tuple[int, int | None]:
        """Bytes that were transferred, and all."""

    def begin(self, now: float) -> None:
        """Send the first request."""

    def receive(self, reply: FtpPacket, now: float) -> None:
        """Handle a reply of the vehicle; it may belong to another job."""

    def tick(self, now: float) -> None:
        """Repeat what is overdue, and give up at last."""

    def abandon(self) -> None:
        """Close the session of a job that is cancelled."""


def encode_path(path: str) -> bytes | None:
    """Return the path as a request holds it; None if it is too long or empty."""
    raw = path.encode()
    return raw if 0 < len(raw) <= MAX_DATA and b"\0" not in raw else None


def error_of(reply: FtpPacket) -> int:
    """Return MAV_FTP_ERR of a NAK."""
    return reply.data[0] if reply.data else FtpError.FAIL


def failure(job: FtpOperation, path: str, reply: FtpPacket | None, tries: int) -> FtpOutcome:
    """Return the outcome of a job that the vehicle has refused, or did not answer (`reply` is None)."""
    if reply is None:
        return FtpOutcome(job, path, False, problem=f"no answer after {tries} tries")
    error = error_of(reply)
    return FtpOutcome(job, path, False, error=error, problem=ftp_error_text(error))
