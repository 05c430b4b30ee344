"""The option --dialect of the programs."""

from __future__ import annotations

import msgspec

from dialects.enums import Severity


class Note(msgspec.Struct, frozen=True):
    """One line for the log."""

    text: str
    severity: Severity = Severity.INFO


def use_dialect(file: str | None) -> tuple[Note, ...]:
    """Read the file that the user named, and use it from now on; return what to tell the user. None: no file.

    To be called before the first link opens. Raises DialectError; nothing is changed then.
    """
    if file is None:
        return ()
    from dialects.extra.dialect import load  # only here: most sessions need no parser
    from dialects.extra.install import install

    return install(load(file), file)
