"""The file that is replayed, as the cores see it."""

from __future__ import annotations

from typing import Protocol


class LogSource(Protocol):
    """Bytes at a place of a file, which may grow while it is open."""

    @property
    def size(self) -> int:
        """Bytes in the file now."""

    def read(self, at: int, count: int) -> bytes:
        """Return up to `count` bytes from `at` on; fewer at the end of the file."""
