"""SplitFile: one log in several files of limited size, synced to the disk without delaying the writes."""

from __future__ import annotations

import contextlib
import errno
import threading
import time
from collections.abc import Callable

from link.tlog.raw_file import RawFile


class DiskSync:
    """One sync at a time, each in a thread of its own: an SD card may take a second for it."""

    def __init__(self) -> None:
        self._running: threading.Thread | None = None
        self._failure: OSError | None = None

    def begin(self, file: RawFile) -> None:
        """Begin to sync what was written so far, unless a sync still runs. Raises the OSError of an earlier one."""
        if self._failure is not None:
            raise self._failure
        if self._running is None or not self._running.is_alive():
            copy = file.duplicate()  # the file may be closed before the sync ends
            self._running = threading.Thread(target=self._sync, args=(copy,), name="log sync", daemon=True)
            self._running.start()

    def wait(self, patience: float) -> None:
        """Wait for a sync that runs, at most `patience` s."""
        if self._running is not None:
            self._running.join(patience)

    def _sync(self, file: RawFile) -> None:
        try:
            file.sync()
        except OSError as error:
            self._failure = error
        finally:
            with contextlib.suppress(OSError):
                file.close()


SYNC_INTERVAL = 5.0
"""s between two syncs to the disk."""
SYNC_PATIENCE = 2.0
"""s that the end of a file waits for a sync that runs."""


class SplitFile:
    """Opens the next file by `open_next` when one has `size_max` bytes. Fits `link.tlog.recorder.LogFile`.

    With each sync, which delays no write, `check` may raise OSError, for example because the disk is nearly full.
    `closed` is called last.
    """

    def __init__(
        self,
        open_next: Callable[[], RawFile],
        *,
        size_max: int,
        check: Callable[[], None],
        closed: Callable[[], None],
        sync_interval: float = SYNC_INTERVAL,
    ) -> None:
        self._open_file = open_next
        self._check_disk = check
        self._closed = closed
        self._size_max = size_max
        self._sync_interval = sync_interval
        self._file = open_next()
        self.size = 0
        """Bytes written to the current file."""
        self._synced = time.monotonic()
        self._sync = DiskSync()

    def write(self, data: bytes) -> None:
        """Append `data`. Raises OSError, also if the file was removed."""
        if self.size and self.size + len(data) > self._size_max:
            self._open_next()
        if time.monotonic() - self._synced >= self._sync_interval:
            self._check()
        self._file.write(data)
        self.size += len(data)

    def close(self) -> None:
        """Sync and close the file. Raises OSError."""
        try:
            self._sync.wait(SYNC_PATIENCE)
            self._file.sync()
        finally:
            self._file.close()
            self._closed()

    def _open_next(self) -> None:
        self._file.sync()
        full, self._file, self.size = self._file, self._open_file(), 0
        full.close()  # last: if the next file cannot be opened, close() follows, and must not close a descriptor twice

    def _check(self) -> None:
        self._synced = time.monotonic()
        self._sync.begin(self._file)
        self._check_disk()
        if self._file.is_removed():
            raise FileNotFoundError(errno.ENOENT, "the file was removed")
