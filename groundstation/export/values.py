"""Values of messages as numbers and texts in files: as many digits as the type has, and no more."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from typing import Any

from dialects.messages import Message, field_value

_FLOAT = struct.Struct("<f")


def field_values(message: Message) -> Iterator[tuple[str, Any]]:
    """Yield name and value of each field: numbers, texts, and lists of numbers."""
    kind = type(message)
    for name, of in zip(kind.fieldnames, kind.fieldtypes, strict=True):
        value = field_value(message, name)
        if of == "float":
            value = [shortest(each) for each in value] if isinstance(value, list) else shortest(value)
        yield name, value


def shortest(value: float) -> float:
    """Return the number with the fewest digits that is the same float32: 0.1 and not 0.10000000149011612."""
    if not math.isfinite(value):
        return value
    for digits in (7, 8):
        near = float(f"{value:.{digits}g}")
        if abs(near) < 3.4e38 and _FLOAT.unpack(_FLOAT.pack(near))[0] == value:
            return near
    return float(f"{value:.9g}")
