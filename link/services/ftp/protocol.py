"""MAVLink FTP packets: the payload of FILE_TRANSFER_PROTOCOL, and its CRC-32.

Source: https://mavlink.io/en/services/ftp.html.
"""

from __future__ import annotations

import struct
import zlib
from enum import IntEnum

import msgspec

from dialects.messages import FileTransferProtocol

MAX_DATA = 239
"""Bytes of data in one message."""
_HEADER = struct.Struct("<HBBBBBxI")
_PAYLOAD = 251
SEQUENCE_MASK = 0xFFFF


class FtpOpcode(IntEnum):
    """MAV_FTP_OPCODE: the requests, and the two replies."""

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
    """The operating system's error number follows. Never sent here."""
    INVALID_SIZE = 3
    INVALID_SESSION = 4
    NO_SESSIONS = 5
    END_OF_FILE = 6
    UNKNOWN_COMMAND = 7
    FILE_EXISTS = 8
    PROTECTED = 9
    NOT_FOUND = 10


_ERROR_TEXTS: dict[int, str] = {
    FtpError.FAIL: "the vehicle reports a failure",
    FtpError.FAIL_ERRNO: "the vehicle's file system reports an error",
    FtpError.INVALID_SIZE: "the vehicle does not accept the size",
    FtpError.INVALID_SESSION: "the vehicle has closed the file",
    FtpError.NO_SESSIONS: "the vehicle has too many files open",
    FtpError.UNKNOWN_COMMAND: "the vehicle cannot do this",
    FtpError.FILE_EXISTS: "the file exists already",
    FtpError.PROTECTED: "the vehicle protects the file",
    FtpError.NOT_FOUND: "no such file on the vehicle",
}


def ftp_error_text(error: int) -> str:
    """Return what a MAV_FTP_ERR means, for the operator."""
    return _ERROR_TEXTS.get(error, f"the vehicle reports FTP error {error}")


class FtpPacket(msgspec.Struct, frozen=True):
    """One request or reply."""

    sequence: int
    """A reply has its request's plus one."""
    op: int
    session: int = 0
    data: bytes = b""
    offset: int = 0
    req_opcode: int = 0
    """In a reply: the opcode of its request."""
    burst_complete: bool = False
    size: int | None = None
    """Length of the data in the header; None: the actual length. In a READ, how much is requested."""

    def payload(self) -> bytes:
        """Return the 251 bytes of the message's payload."""
        size = len(self.data) if self.size is None else self.size
        head = _HEADER.pack(
            self.sequence, self.session, self.op, size, self.req_opcode, self.burst_complete, self.offset
        )
        return (head + self.data).ljust(_PAYLOAD, b"\0")

    def message(self, system: int, component: int) -> FileTransferProtocol:
        """Return the message to `system` and `component`."""
        return FileTransferProtocol(0, system, component, self.payload())


def parse_packet(message: FileTransferProtocol) -> FtpPacket:
    """Return the packet of a message. `data` is no longer than `size`, and shorter if `size` is wrong."""
    raw = bytes(message.payload)
    sequence, session, op, size, req_opcode, burst_complete, offset = _HEADER.unpack_from(raw)
    data = raw[_HEADER.size : _HEADER.size + size]
    return FtpPacket(sequence, op, session, data, offset, req_opcode, bool(burst_complete), size)


def crc32(data: bytes, start: int = 0) -> int:
    """Return MAVLink's CRC-32 of `data`, continued from `start`.

    The common polynomial, but started with 0 and not inverted at the end (https://mavlink.io/en/crc.html). PX4 uses it
    for metadata files as well.
    """
    return zlib.crc32(data, start ^ 0xFFFF_FFFF) ^ 0xFFFF_FFFF
