"""Writes frames into telemetry logs, in a thread of its own: a slow card must not hold up a frame.

Frames come together for a moment and then go to the thread in one piece: what a killed program had not handed over is
at most PERIOD old, and the file is whole up to there. Where the disk does not follow, frames are left out and counted.
"""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable, Sequence
from typing import Protocol

from link.runtime.worker import Worker
from link.tlog.tlog import encode_record

log = logging.getLogger(__name__)

PERIOD = 0.5
"""s between two hand-overs: two wake-ups a second cost nothing, and half a second is what a crash may take."""
MAX_BATCH = 256 * 1024
"""Bytes of frames that may come together."""
PENDING = 32
"""Batches that may wait for the disk: 16 s, and at most 8 MB."""
CLOSE_TIMEOUT = 2.0
"""s that the end of the program waits for the last write."""
SLOW = "the disk is too slow, frames are missing"


Batch = list[tuple[float, Sequence[bytes]]]


class LogFile(Protocol):
    """A file that is open. It is used in the recorder's thread only."""

    def write(self, data: bytes) -> None:
        """Write whole records, all of them. Raises OSError."""

    def close(self) -> None:
        """The end. Raises OSError."""


def unix_offset() -> int:
    """Us from the monotonic clock to Unix time."""
    return time.time_ns() // 1000 - time.monotonic_ns() // 1000


class RawFile:
    """A file as the system has it: what was written is in it, also when the program is killed."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def write(self, data: bytes) -> None:
        """Raises OSError; on a disk that became full a part is written."""
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self._descriptor, rest) :]

    def sync(self) -> None:
        """Bring it to the disk, for a power cut. Raises OSError."""
        os.fdatasync(self._descriptor)

    def is_removed(self) -> bool:
        """Has somebody taken it out of its folder?"""
        return os.fstat(self._descriptor).st_nlink == 0

    def close(self) -> None:
        """Raises OSError."""
        os.close(self._descriptor)


class Recorder:
    """Takes frames with their times (monotonic, s); each file's times are Unix time as known when it was begun, and go
    on evenly from there, whatever somebody does to the clock.
    """

    def __init__(self, *, offset: Callable[[], int] = unix_offset) -> None:
        self.lost = 0
        """Frames that the disk had no time for, since the last begin()."""
        self.recording = False
        """Is there a file, or will there be one?"""
        self._failure: str | None = None
        self._offset = offset
        self._since = 0
        self._batch: Batch = []
        self._size = 0
        self._handed_over = float("-inf")
        self._worker = Worker("recorder", PENDING)
        self._file: LogFile | None = None

    @property
    def problem(self) -> str | None:
        """Why it does not record, or not all, in one line."""
        return self._failure or (SLOW if self.lost else None)

    def start(self, open_file: Callable[[], LogFile]) -> None:
        """A new file, opened in the thread; the frames of the last moment are its first. What went wrong is over."""
        self.lost, self._failure, self.recording = 0, None, True
        if not self._worker.submit(lambda: self._open(open_file)):
            self._failure = SLOW

    def stop(self) -> None:
        """Write the rest and close the file."""
        if self.recording:
            self._hand_over()
            self._worker.submit(
                self._close
            )  # where it finds no room, the next begin() or the end of the program closes
            self.recording = False

    def add(self, now: float, frames: Sequence[bytes]) -> None:
        """Frames of this moment. Costs the hot path no more than a list."""
        self._batch.append((now, frames))
        self._size += sum(map(len, frames))
        if self._size >= MAX_BATCH:
            self._hand_over()

    def tick(self, now: float) -> None:
        """Call it often: hands over what has come together, each PERIOD s."""
        if now - self._handed_over >= PERIOD:
            self._handed_over = now
            self._hand_over()

    def check_writable(self, probe: Callable[[], None]) -> None:
        """Have the thread see whether it could record: `probe` raises OSError where not."""
        self._worker.submit(lambda: self._try(probe))

    def close(self) -> None:
        """Write the rest and end."""
        self.stop()
        self._worker.close(CLOSE_TIMEOUT)

    def _hand_over(self) -> None:
        batch, self._batch, self._size = self._batch, [], 0
        if batch and self.recording and not self._failure and not self._worker.submit(lambda: self._write(batch)):
            self.lost += sum(len(frames) for _, frames in batch)

    # ---- in the thread ----

    def _open(self, open_file: Callable[[], LogFile]) -> None:
        self._close()
        self._failure, self._since = None, self._offset()  # what the file before it met is over

        def opening() -> None:
            self._file = open_file()

        self._try(opening)

    def _write(self, batch: Batch) -> None:
        file = self._file
        if file is not None:
            stamped = ((int(now * 1e6) + self._since, frames) for now, frames in batch)
            data = b"".join(encode_record(at, raw) for at, frames in stamped for raw in frames)
            self._try(lambda: file.write(data))

    def _close(self) -> None:
        file, self._file = self._file, None
        if file is not None:
            self._try(file.close)

    def _try(self, step: Callable[[], None]) -> None:
        """A disk that fails ends the file and nothing else."""
        try:
            step()
        except OSError as error:
            if self._failure is None:
                self._failure = error.strerror or str(error)
                log.warning("recording has ended: %s", error)
            self._close()
