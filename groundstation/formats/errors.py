"""What is wrong with a file."""

from __future__ import annotations

MAX_SHOWN = 40


class FileFormatError(ValueError):
    """A file cannot be read; the message is one line with the file, the place in it, and the error."""


def shown(text: str) -> str:
    """Return a piece of a file for an error: quoted, its control characters escaped, cut where it is long."""
    return repr(text if len(text) <= MAX_SHOWN else f"{text[: MAX_SHOWN - 3]}...")
