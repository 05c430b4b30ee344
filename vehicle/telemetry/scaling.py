"""Converts numbers to message fields: scaled, rounded, clamped, and "unknown" for None and NaN."""

from __future__ import annotations

import math

INT16 = (-32768, 32767)
INT32 = (-(2**31), 2**31 - 1)
UINT8 = (0, 255)
UINT16 = (0, 65535)
UINT32 = (0, 2**32 - 1)
INT8 = (-128, 127)


def scale_to_int(value: float | None, bounds: tuple[int, int], scale: float = 1.0, unknown: int = 0) -> int:
    """Return `value` x `scale` as an integer within `bounds`; `unknown` for None and NaN."""
    if value is None or not math.isfinite(value):
        return unknown
    low, high = bounds
    return int(max(low, min(high, round(value * scale)))) if math.isfinite(value * scale) else unknown


def to_float32(value: float | None, unknown: float = 0.0) -> float:
    """Return `value` clamped to the range of a 32-bit float; `unknown` for None and NaN."""
    if value is None or not math.isfinite(value):
        return unknown
    return max(-3.4e38, min(3.4e38, value))


def parse_message_id(value: float) -> int | None:
    """Return the message id in a command parameter; None if it is not a whole number of 24 bits."""
    if not math.isfinite(value) or value != int(value) or not 0 <= value < 2**24:
        return None
    return int(value)
