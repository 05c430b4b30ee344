"""The FTP jobs that repeat one kind of request: list a folder, remove a file, have its checksum computed."""

from __future__ import annotations

from dataclasses import dataclass, field

from dialects.printable import printable
from link.services.ftp.files import DirectoryEntry
from link.services.ftp.job import TRIES, Exchange, FtpLine, FtpOperation, FtpOutcome, error_of, failure
from link.services.ftp.protocol import FtpError, FtpOpcode, FtpPacket

MAX_ENTRIES = 10_000
CHECKSUM_TRIES = 48
"""Requests for a checksum without a reply before it fails: 34 s, in which ArduPilot reads 32 MB from a card."""


@dataclass(slots=True)
class ListFolderRequest:
    """An FtpJob."""

    line: FtpLine
    path: str
    raw: bytes
    outcome: FtpOutcome | None = None
    _exchange: Exchange = field(init=False)
    _entries: list[DirectoryEntry] = field(default_factory=list)
    _offset: int = 0

    def __post_init__(self) -> None:
        self._exchange = Exchange(self.line)

    @property
    def progress(self) -> tuple[int, int | None]:
        """A listing has no size."""
        return 0, None

    def begin(self, now: float) -> None:
        """Request the first entries."""
        self._exchange.begin(self.line.packet(FtpOpcode.LIST, self.raw, self._offset), now)

    def receive(self, reply: FtpPacket, now: float) -> None:
        """Keep entries and request the next."""
        if not self._exchange.take(reply):
            return
        ended = reply.op == FtpOpcode.NAK and error_of(reply) == FtpError.END_OF_FILE
        if reply.op != FtpOpcode.ACK and not ended:
            self.outcome = failure(FtpOperation.LIST, self.path, reply, 0)
            return
        lines = [] if ended else [line for line in reply.data.split(b"\0") if line]
        self._entries += [entry for entry in map(parse_entry, lines) if entry]
        if not lines or len(self._entries) >= MAX_ENTRIES:
            self.outcome = FtpOutcome(FtpOperation.LIST, self.path, True, entries=tuple(self._entries))
            return
        self._offset += len(lines)
        self.begin(now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, and give up at last."""
        if not self._exchange.tick(now):
            self.outcome = failure(FtpOperation.LIST, self.path, None, TRIES)

    def abandon(self) -> None:
        """Do nothing: a listing has no session."""


@dataclass(slots=True)
class SingleRequest:
    """An FtpJob: REMOVE or CRC."""

    line: FtpLine
    path: str
    raw: bytes
    job: FtpOperation
    outcome: FtpOutcome | None = None
    _exchange: Exchange = field(init=False)

    def __post_init__(self) -> None:
        self._exchange = Exchange(self.line, CHECKSUM_TRIES if self.job is FtpOperation.CHECKSUM else TRIES)

    @property
    def progress(self) -> tuple[int, int | None]:
        """One request has no parts."""
        return 0, None

    def begin(self, now: float) -> None:
        """Send the request."""
        self._exchange.begin(self.line.packet(_OPCODES[self.job], self.raw), now)

    def receive(self, reply: FtpPacket, now: float) -> None:
        """End with the reply."""
        if not self._exchange.take(reply):
            return
        if reply.op != FtpOpcode.ACK:
            self.outcome = failure(self.job, self.path, reply, 0)
            return
        computed = self.job is FtpOperation.CHECKSUM and len(reply.data) >= 4
        checksum = int.from_bytes(reply.data[:4], "little") if computed else None
        self.outcome = FtpOutcome(self.job, self.path, True, checksum=checksum)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, and give up at last."""
        if not self._exchange.tick(now):
            self.outcome = failure(self.job, self.path, None, self._exchange.patience)

    def abandon(self) -> None:
        """Do nothing: the request has no session."""


_OPCODES = {FtpOperation.REMOVE: FtpOpcode.REMOVE, FtpOperation.CHECKSUM: FtpOpcode.CRC}


def parse_entry(line: bytes) -> DirectoryEntry | None:
    """Parse a line of a listing; None if it is neither file nor folder. Names are made printable."""
    name, _, size = line[1:].decode("utf-8", "replace").partition("\t")
    match line[:1]:
        case b"D":
            return DirectoryEntry(printable(name), None)
        case b"F" if size.isdecimal() and size.isascii():
            return DirectoryEntry(printable(name), int(size))
    return None
