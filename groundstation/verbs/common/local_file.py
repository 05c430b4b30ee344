"""The files of verbs: those of groundstation.disk.local_file, with its errors as those of a verb."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from groundstation.disk import local_file
from groundstation.disk.local_file import LocalFileError
from groundstation.verbs.common.exit_codes import ExitCode, VerbError


@contextlib.contextmanager
def file_errors() -> Iterator[None]:
    """Raise VerbError in place of LocalFileError."""
    try:
        yield
    except LocalFileError as error:
        raise VerbError(ExitCode.USAGE, str(error)) from error


def read_text(path: str) -> str:
    """Return the text of a file. Raises VerbError."""
    with file_errors():
        return local_file.read_text(path)


def check_new_file(path: str, *, overwrite: bool) -> None:
    """Raise VerbError if a file cannot be created there, before the work begins."""
    if not overwrite and Path(path).is_file():
        raise VerbError(ExitCode.USAGE, f"{path}: exists already; --yes overwrites it")
    with file_errors():
        local_file.check_new_file(path, overwrite=overwrite)


def write_text(path: str, text: str) -> None:
    """Write a file, whole or not at all. Raises VerbError."""
    with file_errors():
        local_file.write_text(path, text)
