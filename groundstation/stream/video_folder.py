"""VideoFolder: writes pictures beside the telemetry log in parts, and removes the oldest ones. Used in one thread."""

from __future__ import annotations

import errno
import os
import time
from collections.abc import Callable
from pathlib import Path

from groundstation.stream.names import find_parts, part_name, part_number, recorded_order
from link.runtime.growing_file import create_locked, free_space, is_locked, require_free_space

PART_MAX = 100_000_000
"""Bytes after which the next part begins, with a picture that needs no earlier one."""
PARTS_MIN = 4
"""Parts that the limit has room for at least: smaller limits have smaller parts."""
FREE_SPACE_MIN = 64 << 20
"""Bytes that stay free: the telemetry log goes on when pictures do not."""
CHECK_PERIOD = 1.0
"""s between two looks at the free space."""


class VideoFolder:
    """`limit`: bytes of all recorded pictures in the folder."""

    def __init__(self, limit: int, *, free: Callable[[Path], int] = free_space) -> None:
        self.path: Path | None = None
        """The part that is being written."""
        self._limit, self._part_max, self._free = limit, min(PART_MAX, limit // PARTS_MIN), free
        self._log: Path | None = None
        self._number = 0
        """Of the newest part: never used again, also when that was removed."""
        self._descriptor = -1
        self._size = 0
        self._checked = 0.0

    def write(self, log: Path, data: bytes, *, key: bool) -> None:
        """Write a unit beside this log. The first one of a part must be a key picture. Raises OSError."""
        if self._descriptor < 0 or log != self._log or self._size + len(data) > self._part_max:
            if not key and (self._descriptor < 0 or log != self._log):
                self.close()
                return
            if key:
                self._open(log)
        elif time.monotonic() - self._checked > CHECK_PERIOD:
            self._check(log.parent)
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self._descriptor, rest) :]
        self._size += len(data)

    def close(self) -> None:
        """Close the part; an empty one is removed."""
        descriptor, self._descriptor, path, self.path = self._descriptor, -1, self.path, None
        if descriptor < 0:
            return
        if not self._size and path is not None:
            path.unlink(missing_ok=True)
        os.close(descriptor)

    def _open(self, log: Path) -> None:
        self.close()
        self._check(log.parent)
        self._remove_oldest(log.parent)
        self._number = max([self._number if log == self._log else 0, *map(part_number, find_parts(log))]) + 1
        self._log, self._size = log, 0
        path = part_name(log, self._number)
        self._descriptor, self.path = create_locked(path), path

    def _check(self, folder: Path) -> None:
        self._checked = time.monotonic()
        require_free_space(folder, FREE_SPACE_MIN, self._free)
        if self.path is not None and not self.path.exists():
            raise FileNotFoundError(errno.ENOENT, "the file was removed", str(self.path))

    def _remove_oldest(self, folder: Path) -> None:
        found = sorted((order, path) for path in folder.iterdir() if (order := recorded_order(path)) is not None)
        sizes = {path: path.stat().st_size for _, path in found if path.is_file() and not path.is_symlink()}
        for path in list(sizes):
            if sum(sizes.values()) <= self._limit - self._part_max:
                break
            if not is_locked(path):
                path.unlink(missing_ok=True)
                del sizes[path]
