"""Recorded pictures as a file: H.264 that any player shows, with the time of each picture in it.

Before each access unit is an SEI message of user data (H.264, annex D.2.7), which decoders skip: our UUID, then as text
the Unix time in us, the size of the unit, flags, and a CRC-32 of those and the unit. So no other file is needed, a cut
file is good up to the cut, and damaged parts are found.
"""

from __future__ import annotations

import struct
import zlib

import msgspec

from groundstation.stream.rtp import START

UUID = b"mavhelm camera 1"
MAGIC = START + b"\x06\x05" + bytes([len(UUID) + 34]) + UUID
"""SEI, user data without registration, its size."""
TEXT = struct.Struct(">16s8s2s8s")
HEAD = len(MAGIC) + TEXT.size + 1
"""Bytes before a unit."""
KEY, STAMPED = 1, 2
"""Flags: it needs no earlier picture; its time is in its top rows (link/services/video_stamp.py)."""
_END = b"\x80"


class UnitHead(msgspec.Struct, frozen=True):
    """What is known of a unit."""

    time: int
    """Unix time at which it came, us."""
    size: int
    """Bytes without this head."""
    flags: int
    crc: int

    @property
    def key(self) -> bool:
        """It needs no earlier picture."""
        return bool(self.flags & KEY)

    @property
    def stamped(self) -> bool:
        """Its time is in its top rows."""
        return bool(self.flags & STAMPED)

    def fits(self, unit: bytes) -> bool:
        """Return whether the unit is whole and unchanged."""
        return len(unit) == self.size and _crc(_text(self.time, self.size, self.flags), unit) == self.crc


def encode_unit(time: int, unit: bytes, *, key: bool, stamped: bool) -> bytes:
    """Return a unit with its head. `time`: Unix time, us."""
    text = _text(time, len(unit), KEY * key | STAMPED * stamped)
    return b"".join((MAGIC, text, b"%08x" % _crc(text, unit), _END, unit))


def read_head(data: bytes) -> UnitHead | None:
    """Return the head at the begin of the data; None if there is none."""
    if len(data) < HEAD or not data.startswith(MAGIC) or data[HEAD - 1 : HEAD] != _END:
        return None
    try:
        return UnitHead(*(int(part, 16) for part in TEXT.unpack(data[len(MAGIC) : HEAD - 1])))
    except ValueError:
        return None


def _text(time: int, size: int, flags: int) -> bytes:
    return b"%016x%08x%02x" % (time, size, flags)


def _crc(text: bytes, unit: bytes) -> int:
    return zlib.crc32(unit, zlib.crc32(text))
