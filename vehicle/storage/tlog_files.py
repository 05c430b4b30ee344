"""The vehicle's telemetry log files: numbered, with the time in the name if it is known, the oldest removed first.

Everything here is called in the recorder's thread, except names and times. Names are ArduPilot's numbers followed by a
time: 00000012_2026-11-21T14-05-09Z.tlog sorts by number even if the clock was wrong.
"""

from __future__ import annotations

import contextlib
import datetime
import errno
import os
import re
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from link.runtime.whole_file import PRIVATE, sync_folder
from link.tlog.raw_file import RawFile
from link.tlog.split_file import SYNC_INTERVAL, SplitFile

SUFFIX = ".tlog"
CLOCK_KNOWN = 1_767_225_600
"""Unix time of 2026, the first year of this program: an earlier time means that the clock is not set yet."""
FILE_SIZE_MAX = 32 * 1024 * 1024
"""Bytes after which a new file starts, about two hours: the largest file that the ground station downloads."""
FREE_SPACE_MIN = 8 * 1024 * 1024
"""Bytes that stay free: parameters and the system log need space too (ArduPilot leaves as much)."""
MEGABYTE = 1024 * 1024
_NAME = re.compile(r"(\d{8})(?:_(\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ))?\.tlog")
_TIME = "%Y-%m-%dT%H-%M-%SZ"


class FlightLogLimits(NamedTuple):
    """Limits for the space of older logs."""

    files: int
    """Maximum number of logs, including the new one."""
    free: int
    """Bytes that must be free when a log starts."""


def log_name(number: int, unix_time: float) -> str:
    """Return the file name of a log."""
    if unix_time < CLOCK_KNOWN:
        return f"{number:08}{SUFFIX}"
    return f"{number:08}_{datetime.datetime.fromtimestamp(unix_time, datetime.UTC).strftime(_TIME)}{SUFFIX}"


def log_number(name: str) -> int | None:
    """Return the number of a log, None if `name` is not the name of a log."""
    found = _NAME.fullmatch(name)
    return int(found[1]) if found else None


def log_time(name: str) -> int:
    """Return the start of a log, Unix time in s; 0 if unknown."""
    found = _NAME.fullmatch(name)
    if found is None or found[2] is None:
        return 0
    try:
        return int(datetime.datetime.strptime(found[2], _TIME).replace(tzinfo=datetime.UTC).timestamp())
    except ValueError:  # digits that are not a date
        return 0


class LogFiles:
    """The log files of a folder."""

    def __init__(
        self,
        folder: Path,
        *,
        clock: Callable[[], float] = time.time,
        free: Callable[[Path], int] = lambda folder: os.statvfs(folder).f_bavail * os.statvfs(folder).f_frsize,
    ) -> None:
        self.current: str | None = None
        """Name of the file that is being written."""
        self._folder = folder
        self._clock = clock
        self._free = free
        self._last = 0
        """Number of the last log: a number is not used again, even after all logs were erased."""

    def require_writable(self) -> None:
        """Create the folder if needed. Raises OSError if nothing can be recorded."""
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not os.access(self._folder, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(self._folder))

    def open(self, limits: FlightLogLimits) -> SplitFile:
        """Start a new log after removing the oldest ones as needed; it does so for each file. Raises OSError."""
        self.require_writable()
        return SplitFile(
            partial(self._open_within, limits),
            size_max=FILE_SIZE_MAX,
            check=self.require_free_space,
            closed=self._forget_current,
            sync_interval=SYNC_INTERVAL,
        )

    def _open_within(self, limits: FlightLogLimits) -> RawFile:
        self.remove_oldest(limits)
        return self.open_next_file()

    def _forget_current(self) -> None:
        self.current = None

    def open_next_file(self) -> RawFile:
        """Create the file with the next number. Raises OSError."""
        self.require_free_space()
        self._last = max([self._last, *(log_number(name) or 0 for name in self._names())]) + 1
        self.current = log_name(self._last, self._clock())
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC | os.O_NOFOLLOW
        file = RawFile(os.open(self._folder / self.current, flags, PRIVATE))
        with contextlib.suppress(OSError):  # a file system that cannot
            sync_folder(self._folder)
        return file

    def require_free_space(self) -> None:
        """Raise OSError if the disk is nearly full."""
        if self._free(self._folder) < FREE_SPACE_MIN:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self._folder))

    def remove_oldest(self, limits: FlightLogLimits) -> None:
        """Remove the oldest logs until `limits` are met. Raises OSError."""
        names = self._names()
        while names and (len(names) >= limits.files or self._free(self._folder) < limits.free):
            os.unlink(self._folder / names.pop(0))

    def _names(self) -> list[str]:
        """Return the names of the logs, the oldest first."""
        return sorted(name for name in os.listdir(self._folder) if log_number(name) is not None)
