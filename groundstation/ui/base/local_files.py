"""The files in a folder of this machine, as screens list them."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

MAX_HERE = 500
"""Files that are listed, the newest ones."""

LOG_ENDINGS = (".tlog", ".bin", ".ulg")
"""Endings of telemetry and flight logs."""


class LocalFile(msgspec.Struct, frozen=True):
    """A file."""

    name: str
    size: int
    changed: float
    """s since 1970."""


def list_files(folder: Path) -> tuple[LocalFile, ...]:
    """Return the files of a folder without hidden ones, the newest first; none of a folder that cannot be read."""
    found = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if not entry.name.startswith(".") and entry.is_file():
                    status = entry.stat()
                    found.append(LocalFile(entry.name, status.st_size, status.st_mtime))
    except OSError:
        return ()
    return tuple(sorted(found, key=lambda each: -each.changed)[:MAX_HERE])


def list_logs(folder: Path) -> tuple[LocalFile, ...]:
    """Return the logs of a folder, the newest first."""
    return tuple(each for each in list_files(folder) if each.name.endswith(LOG_ENDINGS))


def short_path(path: Path) -> str:
    """Return a path with "~" in place of the home folder."""
    home = Path.home()
    return f"~/{path.relative_to(home)}" if path.is_relative_to(home) else str(path)
