"""Fuzzy names: "gpi" finds GLOBAL_POSITION_INT, "sysvolt" finds SYS_STATUS.voltage_battery."""

from __future__ import annotations

from functools import lru_cache

_SEPARATORS = "_.[ /"


def is_match(query: str, name: str) -> bool:
    """Return whether a word matches a name, see match_score. Case does not count."""
    return match_score(query, name) is not None


@lru_cache(maxsize=20_000)
def match_score(query: str, name: str) -> float | None:
    """Return how well a word matches a name, less is better; None if it does not.

    It matches as a part of the name, or letter by letter where each letter goes on from the one before or begins a word
    of the name.
    """
    query, name = query.lower(), name.lower()
    at = name.find(query)
    if at >= 0:
        begins = at == 0 or name[at - 1] in _SEPARATORS
        return (0.0 if begins else 1.0) + len(name) / 1000
    return 2.0 + len(name) / 1000 if _matches(query, name, 0) else None


def _matches(query: str, name: str, start: int) -> bool:
    """Return whether the letters of `query` are found from `start` on, in pieces that each begin a word."""
    if not query:
        return True
    for at in _word_starts(name, start):
        size = _shared(query, name, at)
        if any(_matches(query[taken:], name, at + taken) for taken in range(size, 0, -1)):
            return True
    return False


def _word_starts(name: str, start: int) -> list[int]:
    return [at for at in range(start, len(name)) if at == 0 or name[at - 1] in _SEPARATORS]


def _shared(query: str, name: str, at: int) -> int:
    size = 0
    while size < len(query) and at + size < len(name) and query[size] == name[at + size]:
        size += 1
    return size
