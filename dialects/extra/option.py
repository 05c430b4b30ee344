"""The option --dialect of the programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dialects.extra.notes import Note


def use_dialect(file: str | None) -> tuple[Note, ...]:
    """Read the file that the user named, and use it from now on; return what to tell the user. None: no file.

    To be called before the first link opens. Raises DialectError; nothing is changed then.
    """
    if file is None:
        return ()
    from dialects.extra.dialect import load  # only here: most sessions need no parser
    from dialects.extra.install import fingerprint, install

    dialect = load(file)
    notes = install(dialect, file)
    USED[file] = fingerprint(dialect)
    return notes


USED: dict[str, str] = {}
"""File in use -> its fingerprint, which is the same for the same definitions."""


def used_dialect() -> str:
    """Return the fingerprint of the file that was read last; "": none is in use."""
    return next(reversed(USED.values()), "")
