"""The attachment of each message: who has sent it, which one it is, and when. And the id that follows from a token.

int64 number from 1, int64 ns of Unix time, a length (16), 16 bytes of id; little endian.
https://github.com/ros2/rmw_zenoh/blob/rolling/docs/design.md#publishers
"""

from __future__ import annotations

import struct

import msgspec
import xxhash

GID_SIZE = 16
_LAYOUT = struct.Struct("<qqB16s")


class Attachment(msgspec.Struct, frozen=True):
    """One attachment."""

    number: int
    """Of the message or request, from 1 on."""
    stamp: int
    """Unix time of the sender, ns."""
    gid: bytes
    """Of the publisher or client, 16 bytes."""

    def encode(self) -> bytes:
        """Return the 33 bytes."""
        return _LAYOUT.pack(self.number, self.stamp, GID_SIZE, self.gid)


def decode(data: bytes) -> Attachment | None:
    """Return the attachment; None for bytes that are none."""
    if len(data) != _LAYOUT.size:
        return None
    number, stamp, size, gid = _LAYOUT.unpack(data)
    return Attachment(number, stamp, gid) if size == GID_SIZE and number >= 0 and stamp >= 0 else None


def gid_of(token: str) -> bytes:
    """Return the id of the publisher or client with this liveliness token: the 128 bits of XXH3 of its text."""
    return xxhash.xxh3_128_intdigest(token.encode()).to_bytes(GID_SIZE, "little")
