"""What a PARAM_VALUE carries: numbers of several types inside one float, and how a float32 is best written down."""

from __future__ import annotations

import math
import struct

REAL32 = 9
"""MAV_PARAM_TYPE_REAL32."""
NAME_SIZE = 16
"""Bytes of `param_id`."""

_FORMATS: dict[int, tuple[str, int, int]] = {
    1: ("<I", 0, 0xFF),
    2: ("<i", -0x80, 0x7F),
    3: ("<I", 0, 0xFFFF),
    4: ("<i", -0x8000, 0x7FFF),
    5: ("<I", 0, 0xFFFF_FFFF),
    6: ("<i", -0x8000_0000, 0x7FFF_FFFF),
}
"""MAV_PARAM_TYPE of a whole number -> its four bytes, smallest, largest."""
_FLOAT = struct.Struct("<f")


def from_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """The number that `param_value` means. `bytewise`: whole numbers lie in the float's bytes (PX4), not in its value.

    Types that do not fit into four bytes (UINT64, INT64, REAL64) come as their value.
    """
    if not bytewise or kind not in _FORMATS:
        return shortest_float32(value)
    return float(struct.unpack(_FORMATS[kind][0], _FLOAT.pack(value))[0])


def to_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """What `param_value` must be for `value`; whole numbers are rounded and kept inside their type."""
    if kind not in _FORMATS:
        return value
    form, low, high = _FORMATS[kind]
    whole = max(low, min(high, round(value)))
    if not bytewise:
        return float(whole)
    return float(_FLOAT.unpack(struct.pack(form, whole))[0])


def shortest_float32(value: float) -> float:
    """The number with the fewest digits that is the same float32: 0.45 and not 0.44999998807907104."""
    try:
        packed = _FLOAT.pack(value)
    except OverflowError:  # no float32 comes near
        return value
    for digits in range(6, 9):
        short = float(f"{value:.{digits}g}")
        if _FLOAT.pack(short) == packed:
            return short
    return value


def is_float32(value: float) -> bool:
    """Is there a finite float32 near it?"""
    try:
        return math.isfinite(_FLOAT.unpack(_FLOAT.pack(value))[0])
    except OverflowError:
        return False


def same_float32(one: float, other: float) -> bool:
    """Are both the same float32?"""
    return shortest_float32(one) == shortest_float32(other)
