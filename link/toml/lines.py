"""Finds the line of a key in a TOML text, which Python's parser does not report."""

from __future__ import annotations

import tomllib
from bisect import bisect_left
from collections.abc import Sequence
from typing import Any


def find_line(text: str, path: Sequence[str]) -> int | None:
    """Return the line, from 1, at which the key at `path` begins. None: the text is not TOML, or has no such key.

    The first lines of a TOML text are TOML as well, unless they end inside a value, which the next lines complete.
    """
    lines = text.replace("\r\n", "\n").split("\n")  # splitlines knows more ends of lines than TOML does
    if not _has(_parse_lines(lines, len(lines)), path):
        return None
    return bisect_left(range(len(lines) + 1), True, key=lambda count: _has(_parse_lines(lines, count), path))


def _parse_lines(lines: Sequence[str], count: int) -> dict[str, Any]:
    """Return the content of the first `count` lines, and of those that complete the last value."""
    for end in range(count, len(lines) + 1):
        try:
            return tomllib.loads("\n".join(lines[:end]))
        except tomllib.TOMLDecodeError:
            continue
    return {}


def _has(table: Any, path: Sequence[str]) -> bool:
    for key in path:
        if not isinstance(table, dict) or key not in table:
            return False
        table = table[key]
    return True
