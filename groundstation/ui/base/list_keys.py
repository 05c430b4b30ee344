"""Keys that move in a list: arrows, pages, the first and the last row; those of vi where they are free.

`k` stops on every screen, so that there is neither `k` nor `j`: docs/decisions.md.
"""

from __future__ import annotations

ALL_ROWS = 10**6
"""More rows than any list has."""

_STEPS = {"up": -1, "down": 1, "home": -ALL_ROWS, "end": ALL_ROWS}
_PAGES = {"pageup": -1, "pagedown": 1, "ctrl+b": -1, "ctrl+f": 1}
_HALVES = {"ctrl+u": -1, "ctrl+d": 1}
_LETTERS = {"g": -ALL_ROWS, "G": ALL_ROWS}


def rows_to_move(key: str, height: int, *, letters: bool = True) -> int:
    """Return by how many rows a key moves in a list of this height; 0 for any other key. A page keeps one row.

    `letters`: g and G mean nothing else on the screen.
    """
    if letters and key in _LETTERS:
        return _LETTERS[key]
    half = _HALVES.get(key, 0) * max(1, height // 2)
    return _STEPS.get(key, 0) + _PAGES.get(key, 0) * max(1, height - 1) + half
