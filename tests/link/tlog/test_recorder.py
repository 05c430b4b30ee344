"""The recorder: all that it is handed is in the file in order, and a disk that fails or sleeps holds nobody up."""

from __future__ import annotations

import errno
import os
import threading
from pathlib import Path

import pytest

from link.tlog.raw_file import RawFile
from link.tlog.recorder import MAX_BATCH, PENDING, PERIOD, SLOW, Recorder
from link.tlog.tlog import Record, read_records
from tests.link.frames import demand, heartbeat
from tests.waits import PATIENCE


class MemoryFile:
    """A file whose disk may sleep or fail."""

    def __init__(self) -> None:
        self.data = b""
        self.closed = False
        self.awake = threading.Event()
        self.awake.set()
        self.writing = threading.Event()
        self.error: OSError | None = None

    def write(self, data: bytes) -> None:
        self.writing.set()
        assert self.awake.wait(PATIENCE)
        if self.error:
            raise self.error
        self.data += data

    def close(self) -> None:
        self.closed = True

    @property
    def frames(self) -> list[bytes]:
        return [each.raw for each in read_records(self.data)]


def seen(recorder: Recorder) -> None:
    """Wait until the thread has done all that it was given."""
    done = threading.Event()
    recorder.check_writable(done.set)
    assert done.wait(PATIENCE)


def test_log_has_what_came_just_before_it_and_nothing_after_it() -> None:
    recorder, file = Recorder(), MemoryFile()
    recorder.add(1.0, [heartbeat(0)])
    recorder.tick(1.0)  # long before: gone
    recorder.add(1.1, [demand(1)])
    recorder.start(lambda: file)
    recorder.add(1.2, [demand(2), demand(3)])
    recorder.tick(1.3)
    recorder.add(1.4, [demand(4)])
    recorder.stop()
    recorder.add(1.5, [demand(5)])
    recorder.tick(9.0)
    recorder.close()
    assert file.frames == [demand(number) for number in (1, 2, 3, 4)]
    assert file.closed


def test_file_that_ends_with_the_next_one_keeps_its_last_frames() -> None:
    """Shorter than PERIOD, it got none at all: they went to the next file, which begins with them as well."""
    recorder, first, second = Recorder(), MemoryFile(), MemoryFile()
    recorder.tick(1.0)
    recorder.start(lambda: first)
    recorder.add(1.1, [demand(1)])
    recorder.add(1.2, [demand(2)])
    recorder.start(lambda: second)
    recorder.add(1.3, [demand(3)])
    recorder.tick(1.0 + PERIOD)
    recorder.close()
    assert first.frames == [demand(1), demand(2)]
    assert second.frames == [demand(1), demand(2), demand(3)]
    assert first.closed
    assert second.closed
    assert recorder.problem is None


def test_frames_are_in_the_file_soon_also_without_an_end() -> None:
    recorder, file = Recorder(), MemoryFile()
    recorder.start(lambda: file)
    recorder.tick(1.0)
    recorder.add(1.1, [demand(1)])
    recorder.tick(1.0 + PERIOD)
    seen(recorder)
    assert file.frames == [demand(1)]
    recorder.close()


def test_times_are_unix_time_in_order_whatever_the_clock_does() -> None:
    offsets = iter([1_700_000_000_000_000, 1_600_000_000_000_000])
    recorder, first, second = Recorder(offset=lambda: next(offsets)), MemoryFile(), MemoryFile()
    recorder.start(lambda: first)
    recorder.add(1.5, [demand(1)])
    recorder.add(2.0, [demand(2)])
    recorder.stop()
    recorder.start(lambda: second)  # somebody has set the clock back
    recorder.add(3.0, [demand(3)])
    recorder.close()
    assert list(read_records(first.data)) == [
        Record(1_700_000_001_500_000, demand(1)),
        Record(1_700_000_002_000_000, demand(2)),
    ]
    assert list(read_records(second.data)) == [Record(1_600_000_003_000_000, demand(3))]


def test_a_new_log_closes_the_one_before() -> None:
    recorder, first, second = Recorder(), MemoryFile(), MemoryFile()
    recorder.start(lambda: first)
    recorder.add(1.0, [demand(1)])
    recorder.tick(1.0)
    recorder.start(lambda: second)
    recorder.add(2.0, [demand(2)])
    recorder.close()
    assert first.closed
    assert (first.frames, second.frames) == ([demand(1)], [demand(2)])


def test_a_sleeping_disk_costs_counted_frames_and_no_time() -> None:
    recorder, file = Recorder(), MemoryFile()
    file.awake.clear()
    recorder.start(lambda: file)
    recorder.add(0.0, [demand(0)])
    recorder.tick(0.0)
    assert file.writing.wait(PATIENCE)
    for number in range(1, PENDING + 11):
        recorder.add(number, [demand(number % 256)])
        recorder.tick(number)
    assert recorder.lost == 10
    assert recorder.problem == SLOW
    file.awake.set()
    seen_when_there_is_room(recorder)
    assert len(file.frames) == PENDING + 1
    recorder.start(MemoryFile)
    assert recorder.problem is None
    recorder.close()


def seen_when_there_is_room(recorder: Recorder) -> None:
    """As `seen`, behind a full queue."""
    done = threading.Event()
    for _ in range(1000):
        recorder.check_writable(done.set)
        if done.wait(0.01):
            return
    raise AssertionError("the thread hangs")


def test_a_flood_does_not_wait_for_the_time() -> None:
    recorder, file = Recorder(), MemoryFile()
    recorder.start(lambda: file)
    recorder.tick(0.0)
    frames = [demand(number) for number in range(256)]
    while sum(map(len, frames)) < MAX_BATCH:
        frames *= 2
    recorder.add(0.1, frames)
    seen(recorder)
    assert len(file.frames) == len(frames)
    recorder.close()


@pytest.mark.parametrize("where", ["open", "write"])
def test_a_disk_that_fails_ends_this_log_and_not_the_next(where: str) -> None:
    recorder, file, good = Recorder(), MemoryFile(), MemoryFile()
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def opened() -> MemoryFile:
        if where == "open":
            raise full
        file.error = full
        return file

    recorder.start(opened)
    recorder.add(1.0, [demand(1)])
    recorder.tick(1.0)
    seen(recorder)
    assert recorder.problem == "No space left on device"
    recorder.add(2.0, [demand(2)])
    recorder.tick(2.0)
    recorder.start(lambda: good)
    recorder.add(3.0, [demand(3)])
    recorder.close()
    assert recorder.problem is None
    assert good.frames == [demand(3)]


def test_a_full_disk_is_an_error_of_the_file(tmp_path: Path) -> None:
    file = RawFile(os.open("/dev/full", os.O_WRONLY))
    with pytest.raises(OSError, match="No space"):
        file.write(b"data")
    file.close()


def test_a_file_that_somebody_removed_says_so(tmp_path: Path) -> None:
    path = tmp_path / "file"
    file = RawFile(os.open(path, os.O_WRONLY | os.O_CREAT))
    file.write(b"data")
    file.sync()
    assert path.read_bytes() == b"data"
    assert not file.is_removed()
    path.unlink()
    assert file.is_removed()
    file.close()
