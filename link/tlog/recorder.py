"""Writes frames into telemetry logs in a thread, because a slow card must not delay a frame.

Frames are collected for a period and then passed to the thread in one batch: a killed program loses no more than that,
and the file is complete up to there. When the disk is too slow, frames are left out and counted.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from link.runtime.worker import Worker
from link.tlog.tlog import encode_record

log = logging.getLogger(__name__)

PERIOD = 0.5
"""s between two batches: two wake-ups a second cost nothing, and a crash may lose half a second."""
MAX_BATCH = 256 * 1024
"""Bytes of frames in one batch of PERIOD."""
PENDING = 32
"""Batches of PERIOD that may wait for the disk: 16 s, and at most 8 MB. Shorter ones are smaller, and more may wait."""
CLOSE_TIMEOUT = 2.0
"""s that the end of the program waits for the last write."""
SLOW = "the disk is too slow, frames are missing"


Batch = list[tuple[float, Sequence[bytes]]]


class TlogFile(Protocol):
    """An open file, used only in the recorder's thread."""

    def write(self, data: bytes) -> None:
        """Write whole records completely. Raises OSError."""

    def close(self) -> None:
        """Close the file. Raises OSError."""


def unix_offset() -> int:
    """Return the us to add to the monotonic clock for Unix time."""
    return time.time_ns() // 1000 - time.monotonic_ns() // 1000


class Recorder:
    """Takes frames with their times (monotonic, s), and writes them every `period` s.

    A file's times are Unix time as known when it was started, and continue evenly from there, even if the clock is set.
    """

    def __init__(self, *, period: float = PERIOD, offset: Callable[[], int] = unix_offset) -> None:
        self.lost = 0
        """Frames left out because the disk was too slow, since the last start()."""
        self.recording = False
        """A file is open, or will be."""
        self._failure: str | None = None
        self._offset = offset
        self._since = self._newest = 0
        self._period = period
        self._max_batch = int(MAX_BATCH * period / PERIOD)
        self._batch: Batch = []
        self._size = 0
        self._handed_over = float("-inf")
        self._worker = Worker("recorder", round(PENDING * PERIOD / period))
        self._file: TlogFile | None = None

    @property
    def since(self) -> int:
        """The us to add to the monotonic clock for the times in the file."""
        return self._since

    @property
    def failure(self) -> str | None:
        """Why nothing is recorded, in one line."""
        return self._failure

    @property
    def problem(self) -> str | None:
        """Why frames are not recorded, or not all, in one line."""
        return self._failure or (SLOW if self.lost else None)

    def start(self, open_file: Callable[[], TlogFile]) -> None:
        """Start a new file, opened in the thread; it begins with the current batch. Clears errors.

        The file before ends with the same batch: without it, a drive shorter than a period would leave an empty file.
        """
        batch, size = self._batch, self._size
        self._hand_over()
        self._batch, self._size = batch.copy(), size
        self.lost, self._failure, self.recording = 0, None, True
        if not self._worker.submit(lambda: self._open(open_file)):
            self._failure = SLOW

    def stop(self) -> None:
        """Write the rest and close the file."""
        if self.recording:
            self._hand_over()
            self._worker.submit(
                self._close
            )  # if the queue is full, the next start() or the end of the program closes the file
            self.recording = False

    def add(self, now: float, frames: Sequence[bytes]) -> None:
        """Add frames of this moment; costs the hot path no more than a list."""
        self._batch.append((now, frames))
        self._size += sum(map(len, frames))
        if self._size >= self._max_batch:
            self._hand_over()

    def tick(self, now: float) -> None:
        """Pass what was collected to the thread, once in a period. Call it often."""
        if now - self._handed_over >= self._period:
            self._handed_over = now
            self._hand_over()

    def check_writable(self, probe: Callable[[], None]) -> None:
        """Let the thread test whether it could record: `probe` raises OSError if not."""
        self._worker.submit(lambda: self._try(probe))

    def close(self) -> None:
        """Write the rest and end the thread."""
        self.stop()
        self._worker.close(CLOSE_TIMEOUT)

    def _hand_over(self) -> None:
        batch, self._batch, self._size = self._batch, [], 0
        if batch and self.recording and not self._failure and not self._worker.submit(lambda: self._write(batch)):
            self.lost += sum(len(frames) for _, frames in batch)

    # ---- in the thread ----

    def _open(self, open_file: Callable[[], TlogFile]) -> None:
        self._close()
        self._failure, self._since, self._newest = None, self._offset(), 0  # errors of the file before are over

        def opening() -> None:
            self._file = open_file()

        self._try(opening)

    def _write(self, batch: Batch) -> None:
        file = self._file
        if file is not None:
            data = b"".join(encode_record(self._stamp(now), raw) for now, frames in batch for raw in frames)
            self._try(lambda: file.write(data))

    def _stamp(self, now: float) -> int:
        """Return the time of a record: never before the one before it, as readers expect."""
        self._newest = max(self._newest, int(now * 1e6) + self._since)
        return self._newest

    def _close(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            self._try(file.close)

    def _try(self, step: Callable[[], None]) -> None:
        """Run `step`; an OSError ends the recording and nothing else."""
        try:
            step()
        except OSError as error:
            if self._failure is None:
                self._failure = error.strerror or str(error)
                log.warning("recording has ended: %s", error)
            self._close()
