"""Files on this machine that verbs read and write; errors are one line for the user."""

from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path

from groundstation.verbs.exit_codes import ExitCode, VerbError

MAX_SIZE = 16 * 1024 * 1024
"""Bytes of a file that is read: more is no parameter file and no plan, and takes hours to upload."""


def read_text(path: str) -> str:
    """Return the text of a file. Raises VerbError."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError:
        raise VerbError(ExitCode.USAGE, f"{path}: this is not a text file") from None


def read_bytes(path: str) -> bytes:
    """Return the content of a file. Raises VerbError."""
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_SIZE + 1)
    except OSError as error:
        raise VerbError(ExitCode.USAGE, f"{path}: {error.strerror}") from error
    if len(data) > MAX_SIZE:
        raise VerbError(ExitCode.USAGE, f"{path}: more than {MAX_SIZE} bytes")
    return data


def check_new_file(path: str, *, overwrite: bool) -> None:
    """Raise VerbError if a file cannot be created there, before the work begins."""
    target = Path(path)
    if target.is_dir():
        raise VerbError(ExitCode.USAGE, f"{path}: this is a folder; name a file")
    if target.exists() and not overwrite:
        raise VerbError(ExitCode.USAGE, f"{path}: exists already; --yes overwrites it")
    if not target.absolute().parent.is_dir():
        raise VerbError(ExitCode.USAGE, f"{path}: there is no folder {target.absolute().parent}")


def write_text(path: str, text: str) -> None:
    """Write a file, whole or not at all. Raises VerbError."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str, data: bytes) -> None:
    """Write a file, whole or not at all. Raises VerbError."""
    target = Path(path).absolute()
    if target.exists() and not target.is_file():  # a device or a pipe cannot be replaced
        _write_directly(target, path, data)
        return
    temporary = ""
    try:
        descriptor, temporary = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)
        Path(temporary).chmod(0o666 & ~_umask())
        Path(temporary).replace(target)
    except OSError as error:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise VerbError(ExitCode.USAGE, f"{path}: {error.strerror}") from error


def _write_directly(target: Path, path: str, data: bytes) -> None:
    try:
        target.write_bytes(data)
    except OSError as error:
        raise VerbError(ExitCode.USAGE, f"{path}: {error.strerror}") from error


def _umask() -> int:
    """Return the process's umask, which can only be read by setting it."""
    mask = os.umask(0)
    os.umask(mask)
    return mask
