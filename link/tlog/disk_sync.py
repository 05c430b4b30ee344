"""DiskSync: syncs a file that is being written to the disk, against a power cut, without delaying the writes."""

from __future__ import annotations

import contextlib
import threading

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
