"""MAVLink FTP on the wire: what is inside a FILE_TRANSFER_PROTOCOL message, and its checksum.

Source: mavlink.io/en/services/ftp.html. The two halves are server.py and client.py.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from enum import IntEnum

from dialects.messages import FileTransferProtocol

MAX_DATA = 239
"""Bytes of data in one message."""
_HEADER = struct.Struct("<HBBBBBxI")
_PAYLOAD = 251
SEQUENCE_MASK = 0xFFFF


class FtpOpcode(IntEnum):
    """MAV_FTP_OPCODE: what is asked, and the two answers."""

    NONE = 0
    TERMINATE = 1
    RESET = 2
    LIST = 3
    OPEN = 4
    READ = 5
    CREATE = 6
    WRITE = 7
    REMOVE = 8
    MAKE_DIRECTORY = 9
    REMOVE_DIRECTORY = 10
    OPEN_TO_WRITE = 11
    TRUNCATE = 12
    RENAME = 13
    CRC = 14
    BURST = 15
    ACK = 128
    NAK = 129


class FtpError(IntEnum):
    """MAV_FTP_ERR: the data of a NAK."""

    FAIL = 1
    FAIL_ERRNO = 2
    """The operating system's number follows. We never tell it."""
    INVALID_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    PROTECTED = 9
    NOT_FOUND = 10


@dataclass(frozen=True, slots=True)
class FtpPacket:
    """One question or answer."""

    sequence: int
    """An answer has its question's plus one."""
    op: int
    session: int = 0
    data: bytes = b""
    offset: int = 0
    asked: int = 0
    """In an answer: the Op it answers."""
    burst_complete: bool = False
    size: int | None = None
    """What the header says of the data's length; None: as long as it is. In a READ, how much is wanted."""

    def payload(self) -> bytes:
        """The 251 bytes of the message."""
        size = len(self.data) if self.size is None else self.size
        head = _HEADER.pack(self.sequence, self.session, self.op, size, self.asked, self.burst_complete, self.offset)
        return (head + self.data).ljust(_PAYLOAD, b"\0")

    def message(self, system: int, component: int) -> FileTransferProtocol:
        """To `system` and `component`."""
        return FileTransferProtocol(0, system, component, self.payload())


def parse_packet(message: FileTransferProtocol) -> FtpPacket:
    """What the message says. `data` is never longer than its `size`, but may be shorter where the size is a lie."""
    raw = bytes(message.payload)
    sequence, session, op, size, asked, burst_complete, offset = _HEADER.unpack_from(raw)
    data = raw[_HEADER.size : _HEADER.size + size]
    return FtpPacket(sequence, op, session, data, offset, asked, bool(burst_complete), size)


def crc32(data: bytes, start: int = 0) -> int:
    """MAVLink's CRC32 of `data`, going on from `start`: the common polynomial, but begun with 0 and not inverted at the
    end (mavlink.io/en/crc.html), which PX4 uses for metadata files too.
    """
    return zlib.crc32(data, start ^ 0xFFFF_FFFF) ^ 0xFFFF_FFFF
