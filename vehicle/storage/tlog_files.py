"""The vehicle's telemetry logs as files: numbered, the time in the name where it is known, the oldest removed first.

Everything here is called in the recorder's thread, but for names and times. Names are ArduPilot's numbers with a time
behind: 00000012_2026-11-21T14-05-09Z.tlog sorts by number, also where a clock was wrong.
"""

from __future__ import annotations

import datetime
import errno
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from link.tlog.recorder import RawFile

SUFFIX = ".tlog"
CLOCK_KNOWN = 1_767_225_600
"""Unix time of 2026, when this program was young: a computer that says less has no clock and no network yet."""
FILE_SIZE_MAX = 32 * 1024 * 1024
"""Bytes after which a new file begins, about two hours: more than this no ground station of ours fetches."""
FREE_SPACE_MIN = 8 * 1024 * 1024
"""Bytes that stay free: parameters and the system's own log need room too (ArduPilot leaves as much)."""
SYNC_INTERVAL = 5.0
"""s between two times that a file is brought to the disk: what a cut of the power may take."""
MEGABYTE = 1024 * 1024
_NAME = re.compile(r"(\d{8})(?:_(\d{4}-\d\d-\d\dT\d\d-\d\d-\d\dZ))?\.tlog")
_TIME = "%Y-%m-%dT%H-%M-%SZ"


class LogLimits(NamedTuple):
    """What older logs may take."""

    files: int
    """At most so many, with the new one."""
    free: int
    """Bytes that shall be free when a log begins."""


def log_name(number: int, unix_time: float) -> str:
    """A log's name."""
    if unix_time < CLOCK_KNOWN:
        return f"{number:08}{SUFFIX}"
    return f"{number:08}_{datetime.datetime.fromtimestamp(unix_time, datetime.UTC).strftime(_TIME)}{SUFFIX}"


def log_number(name: str) -> int | None:
    """Its number, None where it is none of our logs."""
    found = _NAME.fullmatch(name)
    return int(found[1]) if found else None


def log_time(name: str) -> int:
    """When it was begun, Unix time in s; 0 where that is not known."""
    found = _NAME.fullmatch(name)
    if found is None or found[2] is None:
        return 0
    try:
        return int(datetime.datetime.strptime(found[2], _TIME).replace(tzinfo=datetime.UTC).timestamp())
    except ValueError:  # digits, but no date
        return 0


class LogFiles:
    """The files of a folder."""

    def __init__(
        self,
        folder: Path,
        *,
        clock: Callable[[], float] = time.time,
        free: Callable[[Path], int] = lambda folder: os.statvfs(folder).f_bavail * os.statvfs(folder).f_frsize,
    ) -> None:
        self.current: str | None = None
        """The file that is being written."""
        self._folder = folder
        self._clock = clock
        self._free = free
        self._last = 0
        """The number of the last log: none is used twice, also when all were erased."""

    def require_writable(self) -> None:
        """Raises OSError where nothing could be recorded now."""
        self._folder.mkdir(parents=True, exist_ok=True)
        if not os.access(self._folder, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(self._folder))

    def open(self, limits: LogLimits) -> NumberedLog:
        """A new log, and room for it. Raises OSError."""
        self.require_writable()
        self.remove_oldest(limits)
        return NumberedLog(self, limits)

    def open_next_file(self) -> RawFile:
        """A new file. Raises OSError."""
        self.require_free_space()
        self._last = max([self._last, *map(_sure_number, self._names())]) + 1
        self.current = log_name(self._last, self._clock())
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC | os.O_NOFOLLOW
        return RawFile(os.open(self._folder / self.current, flags, 0o644))

    def require_free_space(self) -> None:
        """Raises OSError where the disk is all but full."""
        if self._free(self._folder) < FREE_SPACE_MIN:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self._folder))

    def remove_oldest(self, limits: LogLimits) -> None:
        """Remove the oldest. Raises OSError."""
        names = self._names()
        while names and (len(names) >= limits.files or self._free(self._folder) < limits.free):
            os.unlink(self._folder / names.pop(0))

    def _names(self) -> list[str]:
        """Our logs, the oldest first."""
        return sorted(name for name in os.listdir(self._folder) if log_number(name) is not None)


class NumberedLog:
    """One log: a file, and another when it has grown long. Fits `link.tlog.recorder.LogFile`."""

    def __init__(self, files: LogFiles, limits: LogLimits) -> None:
        self._files = files
        self._limits = limits
        self._file = files.open_next_file()
        self._size = 0
        self._synced = time.monotonic()

    def write(self, data: bytes) -> None:
        """Raises OSError, also where somebody took the file away."""
        if self._size and self._size + len(data) > FILE_SIZE_MAX:
            self._begin_next()
        if time.monotonic() - self._synced >= SYNC_INTERVAL:
            self._check()
        self._file.write(data)
        self._size += len(data)

    def close(self) -> None:
        """Raises OSError."""
        self._files.current = None
        try:
            self._file.sync()
        finally:
            self._file.close()

    def _begin_next(self) -> None:
        self._files.remove_oldest(self._limits)
        full, self._file, self._size = self._file, self._files.open_next_file(), 0
        full.close()  # last: where there is no next one, close() is still to come, and twice would close another's file

    def _check(self) -> None:
        self._synced = time.monotonic()
        self._file.sync()
        self._files.require_free_space()
        if self._file.is_removed():
            raise FileNotFoundError(errno.ENOENT, "somebody removed the file")


def _sure_number(name: str) -> int:
    return log_number(name) or 0
