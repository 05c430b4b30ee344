"""Saves a file of a screen: whole or not at all."""

from __future__ import annotations

from pathlib import Path

from link.runtime.whole_file import replace_file


def save_text(path: Path, text: str) -> str | None:
    """Write a file; return why it could not be written, or None."""
    try:
        replace_file(path, text.encode())
    except OSError as error:
        return error.strerror or str(error)
    return None
