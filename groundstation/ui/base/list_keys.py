"""Keys that move in a list: arrows, pages, the first and the last row."""

from __future__ import annotations

ALL_ROWS = 10**6
"""More rows than any list has."""

_STEPS = {"up": -1, "down": 1, "home": -ALL_ROWS, "end": ALL_ROWS}
_PAGES = {"pageup": -1, "pagedown": 1}


def rows_to_move(key: str, height: int) -> int:
    """Return by how many rows a key moves in a list of this height; 0 for any other key. A page keeps one row."""
    return _STEPS.get(key, 0) + _PAGES.get(key, 0) * max(1, height - 1)
