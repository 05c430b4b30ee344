"""Error of a definition file."""

from __future__ import annotations


class DialectError(Exception):
    """A definition file that cannot be used: one line with file, line, what is wrong and what to do."""
