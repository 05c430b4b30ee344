"""float32 values as numbers and texts: what PARAM_VALUE can hold, and its shortest decimal form. Knows no dialect."""

from __future__ import annotations

import math
import struct

_FLOAT = struct.Struct("<f")


def shortest_float32(value: float) -> float:
    """Return the number with the fewest digits that is the same float32: 0.45, not 0.44999998807907104."""
    try:
        packed = _FLOAT.pack(float(value))  # of an int that is too large for a float, pack() raises struct.error
    except OverflowError:  # beyond every float32
        return value
    for digits in range(6, 10):  # nine digits tell all float32 apart
        short = float(f"{value:.{digits}g}")
        if _FLOAT.pack(short) == packed:
            return short
    return value


def is_float32(value: float) -> bool:
    """Return whether a finite float32 is near `value`."""
    try:
        return math.isfinite(_FLOAT.unpack(_FLOAT.pack(float(value)))[0])
    except OverflowError:
        return False


def same_float32(one: float, other: float) -> bool:
    """Return whether both are the same float32."""
    try:
        return bool(_FLOAT.unpack(_FLOAT.pack(float(one))) == _FLOAT.unpack(_FLOAT.pack(float(other))))
    except OverflowError:  # beyond every float32
        return one == other


def value_text(value: float) -> str:
    """Return a value for people and files: whole numbers exactly, others with up to nine digits."""
    return f"{value:.0f}" if math.isfinite(value) and value == int(value) and abs(value) < 1e15 else f"{value:.9g}"
