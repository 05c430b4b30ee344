"""Writes what passes into a telemetry log, in a thread of its own: a slow card must not hold up a frame."""

from __future__ import annotations

import datetime
import logging
import queue
import threading
from pathlib import Path
from typing import BinaryIO

from link.tlog import record

log = logging.getLogger(__name__)

PENDING = 200
"""Batches that may wait for the card: 10 s at one each 50 ms."""

Batch = list[tuple[int, list[bytes]]]


class RecorderError(Exception):
    """There is nowhere to record to; the message is one line."""


class Recorder:
    """One file a session in `folder`, named by its first moment. Raises RecorderError."""

    def __init__(self, folder: Path) -> None:
        self.problem: str | None = None
        """Why it does not record, in one line, or None."""
        self._batch: Batch = []
        self._queue: queue.Queue[Batch | None] = queue.Queue(PENDING)
        stamp = datetime.datetime.now().astimezone().strftime("%Y-%m-%dT%H-%M-%S")
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.path, self._file = _new_file(folder, stamp)
        except OSError as error:
            raise RecorderError(f"--tlog {folder}: {error.strerror}") from error
        self._thread = threading.Thread(target=self._write_all, name="recorder")
        self._thread.start()

    def add(self, microseconds: int, frames: list[bytes]) -> None:
        """Frames that have just arrived. Costs the hot path no more than a list."""
        self._batch.append((microseconds, frames))

    def hand_over(self) -> None:
        """Give the thread what has come together."""
        if not self._batch or self.problem:
            return
        try:
            self._queue.put_nowait(self._batch)
        except queue.Full:
            self.problem = f"{self.path}: the disk is too slow; recording has ended"
        self._batch = []

    def close(self) -> None:
        """Write the rest and end."""
        self.hand_over()
        self._queue.put(None)
        self._thread.join()

    def _write_all(self) -> None:
        with self._file:
            while (batch := self._queue.get()) is not None:
                if self.problem is None:
                    self._write(batch)

    def _write(self, batch: Batch) -> None:
        try:
            self._file.write(b"".join(record(at, raw) for at, frames in batch for raw in frames))
        except OSError as error:
            self.problem = f"{self.path}: {error.strerror}; recording has ended"
            log.error("%s", self.problem)


def _new_file(folder: Path, stamp: str) -> tuple[Path, BinaryIO]:
    """A file that was not there before: two sessions in one second are two files."""
    number = 1
    while True:
        path = folder / (f"{stamp}.tlog" if number == 1 else f"{stamp}-{number}.tlog")
        try:
            return path, path.open("xb", buffering=0)
        except FileExistsError:
            number += 1
