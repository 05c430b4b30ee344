"""The order in which people look for names: BTN2 before BTN10."""

from __future__ import annotations

import re
from functools import lru_cache

_NUMBERS = re.compile(r"([0-9]+)")


@lru_cache(maxsize=4096)
def natural_key(name: str) -> tuple[str | int, ...]:
    """Return the sort key of a name: its numbers count as numbers, all else as text."""
    return tuple(int(part) if at % 2 else part for at, part in enumerate(_NUMBERS.split(name)))
