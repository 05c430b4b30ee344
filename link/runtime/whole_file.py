"""Writes small files whole or not at all."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

SHARED, PRIVATE = 0o666, 0o600
"""Modes of a new file, before the process's umask: as usual, or for its user only."""


def replace_file(
    path: Path, data: bytes, *, mode: int = SHARED, durable: bool = False, folders_owner: bool = False
) -> None:
    """Write `data` to a temporary file beside `path` and rename it to `path`. Raises OSError.

    Programs that read the file see the old content or the new one, and after an error the old one stays. `durable`: the
    same holds after a power failure. `folders_owner`: if root writes, the file belongs to the owner of its folder.
    """
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode)
    try:
        with os.fdopen(descriptor, "wb") as file:
            if folders_owner and os.geteuid() == 0:
                folder = path.parent.stat()
                os.fchown(descriptor, folder.st_uid, folder.st_gid)
            file.write(data)
            if durable:
                file.flush()
                os.fsync(descriptor)
        temporary.replace(path)
        if durable:
            sync_folder(path.parent)
    except OSError:
        with contextlib.suppress(OSError):
            temporary.unlink()
        raise


def sync_folder(folder: Path) -> None:
    """Write the names in a folder to the disk: a new file is there after a power failure. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
