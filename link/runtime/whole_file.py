"""Writes small files whole or not at all."""

from __future__ import annotations

import contextlib
import fcntl
import os
import re
import secrets
from pathlib import Path

SHARED, PRIVATE = 0o666, 0o600
"""Modes of a new file, before the process's umask: as usual, or for its user only."""

WRITING = 1.0
"""s in which a new temporary file may not be locked yet by the program that writes it."""


def replace_file(
    path: Path, data: bytes, *, mode: int = SHARED, durable: bool = False, folders_owner: bool = False
) -> None:
    """Write `data` to a temporary file beside `path` and rename it to `path`. Raises OSError.

    Programs that read the file see the old content or the new one, and after an error the old one stays. `durable`: the
    same holds after a power failure. `folders_owner`: if root writes, the file belongs to the owner of its folder.
    What a program that was killed meanwhile has left of the same file, which may hold keys, is removed.
    """
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode)
    try:
        with os.fdopen(descriptor, "wb") as file:
            with contextlib.suppress(OSError):  # a file system without locks: then only its age tells
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            _remove_leftovers(path, temporary, os.fstat(descriptor).st_mtime)
            if folders_owner and os.geteuid() == 0:
                folder = path.parent.stat()
                os.fchown(descriptor, folder.st_uid, folder.st_gid)
            file.write(data)
            file.flush()
            if durable:
                os.fsync(descriptor)
            temporary.replace(path)  # before the lock ends
        if durable:
            sync_folder(path.parent)
    except OSError:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise


def _remove_leftovers(path: Path, own: Path, now: float) -> None:
    """Remove temporary files of `path` but `own` that nobody writes any more. Never raises.

    `now`: time of `own`, by the clock of the file system.
    """
    name = re.compile(rf"\.{re.escape(path.name)}\.[0-9a-f]{{8}}")
    with contextlib.suppress(OSError):
        for each in os.listdir(path.parent):
            if name.fullmatch(each) and each != own.name:
                _remove_leftover(path.with_name(each), now)


def _remove_leftover(path: Path, now: float) -> None:
    with contextlib.suppress(OSError):
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            age = abs(now - os.fstat(descriptor).st_mtime)  # either way: a clock may have been set meanwhile
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if age >= WRITING:
                path.unlink()
        finally:
            os.close(descriptor)


def sync_folder(folder: Path) -> None:
    """Write the names in a folder to the disk: a new file is there after a power failure. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
