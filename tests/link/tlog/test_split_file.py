"""A log in several files: where one ends, and what makes it fail."""

from __future__ import annotations

import errno
import os
import threading
from pathlib import Path

import pytest

from link.tlog.raw_file import RawFile
from link.tlog.recorder import PERIOD
from link.tlog.split_file import SYNC_INTERVAL, SplitFile


class Folder:
    """Opens numbered files, and counts how often its disk is checked."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.opened = self.checks = self.closed = 0

    def split(self, size_max: int, sync_interval: float = 100.0) -> SplitFile:
        return SplitFile(
            self.open_next, size_max=size_max, check=self.check, closed=self.close, sync_interval=sync_interval
        )

    def open_next(self) -> RawFile:
        self.opened += 1
        return RawFile(os.open(self.path / str(self.opened), os.O_WRONLY | os.O_CREAT | os.O_EXCL))

    def check(self) -> None:
        self.checks += 1

    def close(self) -> None:
        self.closed += 1

    def contents(self) -> list[bytes]:
        return [(self.path / str(number + 1)).read_bytes() for number in range(self.opened)]


def test_file_that_would_grow_too_large_is_followed_by_the_next(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    log = folder.split(10)
    for data in (b"12345678", b"ab", b"c", b"a batch that is longer than a file", b"d"):
        log.write(data)
    assert log.size == 1
    log.close()
    assert folder.contents() == [b"12345678ab", b"c", b"a batch that is longer than a file", b"d"]
    assert (folder.checks, folder.closed) == (0, 1)


def test_a_file_that_was_removed_is_noticed_with_the_next_sync(tmp_path: Path) -> None:
    folder = Folder(tmp_path)
    log = folder.split(10, sync_interval=0.0)
    log.write(b"1")
    assert folder.checks == 1
    (tmp_path / "1").unlink()
    with pytest.raises(FileNotFoundError, match="removed"):
        log.write(b"2")
    log.close()
    assert folder.closed == 1


class SlowFile(RawFile):
    """A file on a disk whose syncs end when they are let go, and fail then if told so."""

    def __init__(self, descriptor: int, gate: threading.Event, *, broken: bool = False) -> None:
        super().__init__(descriptor)
        self.gate, self.broken = gate, broken

    def duplicate(self) -> RawFile:
        return SlowFile(os.dup(self._descriptor), self.gate, broken=self.broken)

    def sync(self) -> None:
        assert self.gate.wait(10)
        if self.broken:
            raise OSError(errno.EIO, os.strerror(errno.EIO))


def slow_log(folder: Folder, gate: threading.Event, *, broken: bool = False) -> SplitFile:
    """Return a log that syncs with each write."""
    flags = os.O_WRONLY | os.O_CREAT

    def open_slow() -> RawFile:
        return SlowFile(os.open(folder.path / "1", flags), gate, broken=broken)

    return SplitFile(open_slow, size_max=100, check=folder.check, closed=folder.close, sync_interval=0.0)


def test_writes_do_not_wait_for_a_slow_sync(tmp_path: Path) -> None:
    gate = threading.Event()
    log = slow_log(Folder(tmp_path), gate)
    for _ in range(5):
        log.write(b"x")
    assert (tmp_path / "1").read_bytes() == b"xxxxx"
    gate.set()
    log.close()


def test_a_sync_that_fails_fails_a_later_write(tmp_path: Path) -> None:
    gate = threading.Event()
    log = slow_log(Folder(tmp_path), gate, broken=True)
    log.write(b"x")
    gate.set()
    log._sync.wait(10)
    with pytest.raises(OSError, match="Input/output error"):
        log.write(b"x")
    with pytest.raises(OSError, match="Input/output error"):
        log.close()


class NotedFile(RawFile):
    """A file that notes what is on the disk: all that a sync has found in it."""

    synced: list[int]

    def duplicate(self) -> RawFile:
        copy = NotedFile(os.dup(self._descriptor))
        copy.synced = self.synced
        return copy

    def sync(self) -> None:
        self.synced.append(os.fstat(self._descriptor).st_size)


def test_a_power_failure_loses_less_than_six_seconds(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A byte is a batch of PERIOD. Before each write, what no sync has found is what a power failure would cost."""
    now, synced = 100.0, [0]
    monkeypatch.setattr("link.tlog.split_file.time.monotonic", lambda: now)

    def open_noted() -> RawFile:
        file = NotedFile(os.open(tmp_path / "log", os.O_WRONLY | os.O_CREAT))
        file.synced = synced
        return file

    log = SplitFile(open_noted, size_max=1000, check=lambda: None, closed=lambda: None)
    lost = []
    for _ in range(200):
        now += PERIOD
        log.write(b"x")
        log._sync.wait(10)
        lost.append((log.size - synced[-1] + 1) * PERIOD)  # and the batch that is being collected
    log.close()
    assert SYNC_INTERVAL <= max(lost) <= 6.0, "the sync may find the batch that is written meanwhile, or not"
