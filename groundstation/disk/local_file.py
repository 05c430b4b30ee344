"""Files on this machine, read and written whole. Errors are one line for the user.

A download that was interrupted leaves FILE.part, with which the next one resumes.
"""

from __future__ import annotations

import contextlib
from pathlib import Path

from link.runtime.whole_file import replace_file
from link.services.ftp.job import MAX_SIZE as MAX_DOWNLOAD
from link.services.ftp.protocol import crc32

MAX_SIZE = 16 * 1024 * 1024
"""Bytes of a file that is read: more is neither a parameter file nor a plan, and takes hours to upload."""

PIECE = 1024 * 1024
"""Bytes that are read at once for a checksum."""


class LocalFileError(Exception):
    """A file cannot be read or written; the message is one line that names it."""


def read_text(path: str) -> str:
    """Return the text of a file. Raises LocalFileError."""
    try:
        return read_bytes(path).decode("utf-8")
    except UnicodeDecodeError:
        raise LocalFileError(f"{path}: this is not a text file") from None


def read_bytes(path: str) -> bytes:
    """Return the content of a file. Raises LocalFileError."""
    try:
        with Path(path).open("rb") as file:
            data = file.read(MAX_SIZE + 1)
    except OSError as error:
        raise LocalFileError(f"{path}: {error.strerror}") from error
    if len(data) > MAX_SIZE:
        raise LocalFileError(f"{path}: more than {MAX_SIZE} bytes")
    return data


def checksum_of(path: str) -> int:
    """Return MAVLink's CRC-32 of a file of any size. Raises LocalFileError."""
    checksum = 0
    try:
        with Path(path).open("rb") as file:
            while piece := file.read(PIECE):
                checksum = crc32(piece, checksum)
    except OSError as error:
        raise LocalFileError(f"{path}: {error.strerror}") from error
    return checksum


def check_new_file(path: str, *, overwrite: bool) -> None:
    """Raise LocalFileError if a file cannot be created there, before the work begins."""
    target = Path(path)
    if target.is_dir():
        raise LocalFileError(f"{path}: this is a folder; name a file")
    if target.exists() and not overwrite:
        raise LocalFileError(f"{path}: exists already")
    if not target.absolute().parent.is_dir():
        raise LocalFileError(f"{path}: there is no folder {target.absolute().parent}")


def write_text(path: str, text: str) -> None:
    """Write a file, whole or not at all. Raises LocalFileError."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: str, data: bytes) -> None:
    """Write a file, whole or not at all. Raises LocalFileError."""
    target = Path(path).absolute()
    if target.exists() and not target.is_file():  # a device or a pipe cannot be replaced
        _write_directly(target, path, data)
        return
    try:
        replace_file(target, data)
    except OSError as error:
        raise LocalFileError(f"{path}: {error.strerror}") from error


def part_of(path: str) -> str:
    """Return the name of the beginning that an interrupted download of this file leaves."""
    return f"{path}.part"


def read_part(path: str) -> bytes:
    """Return what an earlier download of this file left; nothing if there was none. Raises LocalFileError."""
    part = Path(part_of(path))
    try:
        with part.open("rb") as opened:
            return opened.read(MAX_DOWNLOAD)
    except FileNotFoundError:
        return b""
    except OSError as error:
        raise LocalFileError(f"{part}: {error.strerror}") from error


def keep_part(path: str, data: bytes) -> None:
    """Keep the beginning of a file for the next download. Raises LocalFileError."""
    if data:
        write_bytes(part_of(path), data)


def store(path: str, data: bytes) -> None:
    """Write a whole download, and remove what was kept of it. Raises LocalFileError."""
    write_bytes(path, data)
    with contextlib.suppress(OSError):
        Path(part_of(path)).unlink(missing_ok=True)


def _write_directly(target: Path, path: str, data: bytes) -> None:
    try:
        target.write_bytes(data)
    except OSError as error:
        raise LocalFileError(f"{path}: {error.strerror}") from error
