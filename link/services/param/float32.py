"""float32 values as numbers and texts: what PARAM_VALUE can hold, and its shortest decimal form. Knows no dialect."""

from __future__ import annotations

import math
import struct

_FLOAT = struct.Struct("<f")
_BITS = struct.Struct("<i")
_EXACT = 2.0**32
"""Whole numbers of up to four bytes keep all their digits: identifiers, counters, bits."""


def shortest_float32(value: float) -> float:
    """Return the number with the fewest digits that is the same float32: 0.45, not 0.44999998807907104.

    Whole numbers up to 2**32 are returned exactly: 287454016, not 287454000.
    """
    try:
        packed = _FLOAT.pack(float(value))  # of an int that is too large for a float, pack() raises struct.error
    except OverflowError:  # beyond every float32
        return value
    (exact,) = _FLOAT.unpack(packed)
    if abs(exact) <= _EXACT and exact.is_integer():
        return float(exact)
    for digits in range(6, 10):  # nine digits tell all float32 apart
        short = float(f"{value:.{digits}g}")
        if _FLOAT.pack(short) == packed:
            return short
    return value


def as_float32(value: float) -> float:
    """Return the float32 nearest to a number, or the number if it is beyond every float32."""
    try:
        return float(_FLOAT.unpack(_FLOAT.pack(float(value)))[0])
    except OverflowError:
        return value


def is_float32(value: float) -> bool:
    """Return whether a finite float32 is near `value`."""
    try:
        return math.isfinite(_FLOAT.unpack(_FLOAT.pack(float(value)))[0])
    except OverflowError:
        return False


def is_exact_float32(value: float) -> bool:
    """Return whether `value` itself is a float32."""
    return is_float32(value) and bool(_FLOAT.unpack(_FLOAT.pack(float(value)))[0] == value)


def same_float32(one: float, other: float) -> bool:
    """Return whether both are the same float32."""
    try:
        return bool(_FLOAT.unpack(_FLOAT.pack(float(one))) == _FLOAT.unpack(_FLOAT.pack(float(other))))
    except OverflowError:  # beyond every float32
        return one == other


def float32_neighbours(value: float) -> tuple[float, float]:
    """Return the float32 below and above a number that lies between two; twice the same where it is one."""
    packed = _FLOAT.pack(value)
    (nearest,), (bits,) = _FLOAT.unpack(packed), _BITS.unpack(packed)
    if nearest == value:
        return nearest, nearest
    farther = (nearest < value) == (value > 0)  # away from zero the bits count upwards, whatever the sign
    (other,) = _FLOAT.unpack(_BITS.pack(bits + (1 if farther else -1)))
    return min(nearest, other), max(nearest, other)


def value_text(value: float) -> str:
    """Return a value for people and files: whole numbers exactly, others with up to nine digits."""
    return f"{value:.0f}" if math.isfinite(value) and value == int(value) and abs(value) < 1e15 else f"{value:.9g}"
