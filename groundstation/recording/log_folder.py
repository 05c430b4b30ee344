"""LogFolder: the telemetry logs of this station's sessions, named by their time, the oldest removed first.

Everything here is called in the recorder's thread, except `current` and `size`. A file that is being written, by this
station or another one, is locked and never removed. Files with other names are left alone.
"""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from groundstation.stream.names import find_parts
from link.runtime.growing_file import create_locked, free_space, is_locked, require_free_space
from link.runtime.whole_file import sync_folder
from link.tlog.raw_file import RawFile
from link.tlog.split_file import SplitFile

MEGABYTE = 1_000_000
FREE_SPACE_MIN = 32 * 1024 * 1024
"""Bytes that stay free: other programs of the user need some space too."""
SYNC_INTERVAL = 1.0
"""s between two syncs to the disk: what a power cut may lose, beside the time that a sync takes."""
_NAME = re.compile(r"\d{4}-\d\d-\d\d_\d\d-\d\d-\d\d(?:-\d+)?\.tlog")
_TIME = "%Y-%m-%d_%H-%M-%S"


class LogLimits(NamedTuple):
    """Limits in bytes."""

    file: int
    """After so many the next file begins."""
    folder: int
    """The oldest files are removed so that all, with the next one at its largest, have no more."""


class CurrentLog(NamedTuple):
    """The file that is being written."""

    path: Path
    begun: float
    """time.monotonic() of its start, s."""


class LogFolder:
    """The folder. Names have the local time, as the user's clock shows it."""

    def __init__(
        self,
        path: Path,
        limits: LogLimits,
        *,
        clock: Callable[[], float] = time.time,
        free: Callable[[Path], int] = free_space,
    ) -> None:
        self.path = path
        self.current: CurrentLog | None = None
        self._log: SplitFile | None = None
        self._limits = limits
        self._clock = clock
        self._free = free

    def open(self) -> SplitFile:
        """Start a log. Raises OSError."""
        self.path.mkdir(mode=0o700, parents=True, exist_ok=True)
        self._log = SplitFile(
            self._open_next,
            size_max=self._limits.file,
            check=self._require_free_space,
            closed=self._close_current,
            sync_interval=SYNC_INTERVAL,
        )
        return self._log

    @property
    def size(self) -> int:
        """Bytes written to the current file."""
        return self._log.size if self._log is not None else 0

    def _open_next(self) -> RawFile:
        self._require_free_space()
        self._remove_oldest()
        path, descriptor = self._create()
        with contextlib.suppress(OSError):  # a file system that cannot
            sync_folder(self.path)
        self.current = CurrentLog(path, time.monotonic())
        return RawFile(descriptor)

    def _create(self) -> tuple[Path, int]:
        """Create a file that did not exist, readable by its user only: two in one second get two names."""
        stamp, number = time.strftime(_TIME, time.localtime(self._clock())), 1
        while True:
            path = self.path / (f"{stamp}.tlog" if number == 1 else f"{stamp}-{number}.tlog")
            try:
                return path, create_locked(path)
            except FileExistsError:
                number += 1

    def _close_current(self) -> None:
        """Forget the file; remove it if nothing could be written."""
        current, self.current = self.current, None
        if current is not None:
            with contextlib.suppress(OSError):
                if current.path.stat().st_size == 0:
                    current.path.unlink()

    def _require_free_space(self) -> None:
        require_free_space(self.path, FREE_SPACE_MIN, self._free)

    def _remove_oldest(self) -> None:
        sizes = {path: path.stat().st_size for path in self._logs()}
        room = self._limits.folder - self._limits.file
        for path in sorted(sizes, key=_order):
            if sum(sizes.values()) <= room:
                break
            if not is_locked(path):
                for each in (*find_parts(path), path):  # its pictures, too
                    each.unlink(missing_ok=True)
                del sizes[path]

    def _logs(self) -> Iterator[Path]:
        for path in self.path.iterdir():
            if _NAME.fullmatch(path.name) and path.is_file() and not path.is_symlink():
                yield path


def _order(path: Path) -> tuple[str, int]:
    """Return the time of a name and the number behind it, which are older first in this order."""
    stem = path.name.removesuffix(".tlog")
    return stem[:19], int(stem[20:] or 1)
