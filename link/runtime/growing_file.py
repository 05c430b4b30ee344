"""Files that one program writes for long, such as logs: locked meanwhile, so that no other one removes them."""

from __future__ import annotations

import contextlib
import errno
import fcntl
import os
from collections.abc import Callable
from pathlib import Path

_CREATE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC | os.O_NOFOLLOW


def create_locked(path: Path) -> int:
    """Create a file for its user only, and lock it. Raises OSError, if there is one, too."""
    descriptor = os.open(path, _CREATE, 0o600)
    with contextlib.suppress(OSError):  # a file system without locks
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return descriptor


def is_locked(path: Path) -> bool:
    """Return whether a program writes the file, or it cannot be opened."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW)
    except OSError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(descriptor)
    return False


def free_space(folder: Path) -> int:
    """Return the bytes that are free for this user. Raises OSError."""
    status = os.statvfs(folder)
    return status.f_bavail * status.f_frsize


def require_free_space(folder: Path, least: int, free: Callable[[Path], int] = free_space) -> None:
    """Raise OSError if less than `least` bytes are free."""
    if free(folder) < least:
        raise OSError(errno.ENOSPC, f"less than {least >> 20} MiB free", str(folder))
