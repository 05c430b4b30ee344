"""The time in the pictures of our vehicle's camera: black and white fields in the top rows, which survive H.264.

The fields are SYNC, 32 bits of ms of the clock that answers TIMESYNC, and 8 bits of CRC, the highest bit first. The
decoder averages each field over its whole area, so that no edge counts.
"""

from __future__ import annotations

from collections.abc import Sequence

SYNC = (1, 0, 1, 1, 0, 1, 0, 0)
FIELDS = len(SYNC) + 32 + 8
"""Fields side by side; an even number, because a narrow picture has them in two halves."""
ROWS = 8
"""Rows of pixels at the top: half a macroblock of H.264, at full height in the chroma planes as well."""
BLACK, WHITE = 16, 235
"""Brightness of the fields, as in ITU-R BT.601."""
_MIDDLE = 128
_POLYNOMIAL = 0x07
"""Of the CRC-8 of ITU-T I.432.1, x^8 + x^2 + x + 1."""


def build_stamp(seconds: float) -> tuple[int, ...]:
    """Return the fields of a time: 1 is white."""
    stamp = int(seconds * 1000) & 0xFFFFFFFF
    return (*SYNC, *_bits(stamp, 32), *_bits(_crc(stamp), 8))


def draw_stamp(seconds: float, width: int) -> bytes:
    """Return one row of brightness with the stamp of a time."""
    fields = build_stamp(seconds)
    values = bytes(WHITE if field else BLACK for field in fields)
    return bytes(values[x * FIELDS // width] for x in range(width))


def read_stamp(brightness: Sequence[int]) -> float | None:
    """Return the s that the brightness of all fields means; None if there is no whole stamp. It has 32 bits of ms."""
    if len(brightness) != FIELDS:
        return None
    bits = tuple(int(value > _MIDDLE) for value in brightness)
    stamp, crc = _number(bits[len(SYNC) : -8]), _number(bits[-8:])
    return stamp / 1000 if bits[: len(SYNC)] == SYNC and crc == _crc(stamp) else None


def _bits(number: int, count: int) -> tuple[int, ...]:
    return tuple(number >> shift & 1 for shift in reversed(range(count)))


def _number(bits: Sequence[int]) -> int:
    number = 0
    for bit in bits:
        number = number << 1 | bit
    return number


def _crc(stamp: int) -> int:
    crc = 0
    for byte in stamp.to_bytes(4, "big"):
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ _POLYNOMIAL if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0x55
