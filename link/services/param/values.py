"""Values of PARAM_VALUE: several types inside one float, and the shortest decimal form of a float32."""

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
"""MAV_PARAM_TYPE of an integer -> its four bytes, smallest, largest."""
_FLOAT = struct.Struct("<f")


def from_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """Return the number in `param_value`. `bytewise`: integers are stored in the float's bytes (PX4).

    Types that do not fit into four bytes (UINT64, INT64, REAL64) are sent as their value.
    """
    if not bytewise or kind not in _FORMATS:
        return shortest_float32(value)
    return float(struct.unpack(_FORMATS[kind][0], _FLOAT.pack(value))[0])


def to_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """Return `param_value` for `value`; integers are rounded and clamped to their type."""
    if kind not in _FORMATS:
        return value
    form, low, high = _FORMATS[kind]
    whole = max(low, min(high, round(value)))
    if not bytewise:
        return float(whole)
    return float(_FLOAT.unpack(struct.pack(form, whole))[0])


def shortest_float32(value: float) -> float:
    """Return the number with the fewest digits that is the same float32: 0.45, not 0.44999998807907104."""
    try:
        packed = _FLOAT.pack(value)
    except OverflowError:  # beyond every float32
        return value
    for digits in range(6, 9):
        short = float(f"{value:.{digits}g}")
        if _FLOAT.pack(short) == packed:
            return short
    return value


def is_float32(value: float) -> bool:
    """Return whether a finite float32 is near `value`."""
    try:
        return math.isfinite(_FLOAT.unpack(_FLOAT.pack(value))[0])
    except OverflowError:
        return False


def same_float32(one: float, other: float) -> bool:
    """Return whether both are the same float32."""
    return shortest_float32(one) == shortest_float32(other)
