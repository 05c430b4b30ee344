"""Files of recorded sessions: their names and rights, which are removed, and which never."""

from __future__ import annotations

import os
import stat
from pathlib import Path

import pytest

from groundstation.recording.log_folder import FREE_SPACE_MIN, LogFolder, LogLimits
from link.tlog.split_file import SplitFile

NOON = 1_795_262_400.0
"""2026-11-21, some time of the day."""
PLENTY = 10**12


class Clock:
    """A wall clock that stands until it is set."""

    def __init__(self) -> None:
        self.now = NOON

    def __call__(self) -> float:
        return self.now


def folder(path: Path, *, file: int = 1000, limit: int = 10_000, clock: Clock | None = None) -> LogFolder:
    return LogFolder(path, LogLimits(file, limit), clock=clock or Clock(), free=lambda path: PLENTY)


def write_sessions(path: Path, count: int, size: int) -> None:
    """Write `count` logs, a minute after each other."""
    clock = Clock()
    for number in range(count):
        clock.now = NOON + 60 * number
        log = folder(path, limit=10**9, clock=clock).open()
        log.write(b"x" * size)
        log.close()


def sizes(path: Path) -> list[int]:
    return [(path / name).stat().st_size for name in sorted(os.listdir(path))]


def test_a_file_is_named_by_its_time_and_for_its_user_only(tmp_path: Path) -> None:
    logs = folder(tmp_path / "state" / "logs")
    log = logs.open()
    assert logs.current is not None
    path = logs.current.path
    assert path.name.startswith("2026-11-2")
    assert len(path.name) == len("2026-11-21_12-00-00.tlog")
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
    log.write(b"data")
    assert logs.size == 4
    log.close()
    assert logs.current is None
    assert path.read_bytes() == b"data"


def test_two_sessions_in_one_second_get_two_files(tmp_path: Path) -> None:
    first, second = folder(tmp_path), folder(tmp_path)
    logs = [first.open(), second.open()]
    assert first.current is not None
    assert second.current is not None
    assert second.current.path.name == first.current.path.name.replace(".tlog", "-2.tlog")
    for log in logs:
        log.close()


def test_a_log_into_which_nothing_was_written_is_removed(tmp_path: Path) -> None:
    folder(tmp_path).open().close()
    assert os.listdir(tmp_path) == []


def test_the_oldest_are_removed_so_that_the_next_file_has_room(tmp_path: Path) -> None:
    write_sessions(tmp_path, 5, 100)
    before = sorted(os.listdir(tmp_path))
    clock = Clock()
    clock.now += 3600
    folder(tmp_path, file=100, limit=400, clock=clock).open()
    assert sorted(os.listdir(tmp_path))[:-1] == before[2:]


def test_a_second_file_of_a_second_is_the_younger_one(tmp_path: Path) -> None:
    for number in ("", "-2", "-10"):
        (tmp_path / f"2026-11-21_12-00-00{number}.tlog").write_bytes(b"x" * 100)
    folder(tmp_path, file=100, limit=200).open()
    assert (tmp_path / "2026-11-21_12-00-00-10.tlog").exists()
    assert not (tmp_path / "2026-11-21_12-00-00-2.tlog").exists()


def test_a_full_file_has_a_successor_and_the_folder_its_limit(tmp_path: Path) -> None:
    clock = Clock()
    logs = folder(tmp_path, file=100, limit=300, clock=clock)
    log = logs.open()
    for number in range(50):
        clock.now = NOON + number
        log.write(b"x" * 50)
        assert sum(sizes(tmp_path)) <= 300
    assert logs.current is not None
    assert sorted(os.listdir(tmp_path))[-1] == logs.current.path.name
    assert sizes(tmp_path)[:-1] == [100, 100]
    log.close()


def test_what_another_station_writes_now_is_never_removed(tmp_path: Path) -> None:
    other = folder(tmp_path)
    log = other.open()
    log.write(b"x" * 900)
    assert other.current is not None
    write_sessions(tmp_path, 2, 900)
    log_of_ours: SplitFile = folder(tmp_path, file=100, limit=100).open()
    assert other.current.path.exists()
    assert len(os.listdir(tmp_path)) == 2
    log.close()
    log_of_ours.close()


def test_other_files_of_the_folder_are_left_alone(tmp_path: Path) -> None:
    names = [
        "flight.tlog",
        "1-00012.bin",
        "2026-11-21_12-00-00.tlog.part",
        "notes.txt",
        "00000012_2026-11-21T14-05-09Z.tlog",
    ]
    for name in names:
        (tmp_path / name).write_bytes(b"x" * 5000)
    os.symlink(tmp_path / "notes.txt", tmp_path / "2026-11-20_12-00-00.tlog")
    folder(tmp_path, file=100, limit=200).open()
    assert set(os.listdir(tmp_path)) > {*names, "2026-11-20_12-00-00.tlog"}


def test_a_disk_that_is_nearly_full_takes_no_log(tmp_path: Path) -> None:
    logs = LogFolder(tmp_path, LogLimits(100, 100), free=lambda path: FREE_SPACE_MIN - 1)
    with pytest.raises(OSError, match="less than 32 MiB free"):
        logs.open()
    assert os.listdir(tmp_path) == []


def test_a_folder_that_is_a_file_is_an_error_of_the_log(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("")
    with pytest.raises(OSError, match="exists"):
        folder(tmp_path / "logs").open()


def test_pictures_go_with_their_log(tmp_path: Path) -> None:
    for number, name in enumerate(("2026-11-21_12-00-00", "2026-11-21_12-00-00-2")):
        for suffix in (".tlog", ".h264", ".2.h264"):
            (tmp_path / f"{name}{suffix}").write_bytes(b"x" * (100 + number))
    folder(tmp_path, file=100, limit=250).open()
    left = sorted(each.name for each in tmp_path.iterdir())[:3]
    assert left == [f"2026-11-21_12-00-00-2{suffix}" for suffix in (".2.h264", ".h264", ".tlog")]
