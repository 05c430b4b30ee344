"""Files of logs: numbered and named, the oldest removed first, and no file that a full or broken disk cannot take."""

from __future__ import annotations

import errno
import os
import re
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from vehicle.storage import tlog_files
from vehicle.storage.tlog_files import FREE_SPACE_MIN, FlightLogLimits, LogFiles, log_name, log_number, log_time

NOW = 1_795_269_909.5  # 2026-11-21 14:05:09 UTC
MANY = FlightLogLimits(500, 0)
PLENTY = 10**9


def files(folder: Path, *, now: float = NOW, free: int = PLENTY) -> LogFiles:
    return LogFiles(folder, clock=lambda: now, free=lambda path: free)


def names(folder: Path) -> list[str]:
    return sorted(os.listdir(folder))


def test_a_name_carries_number_and_time() -> None:
    name = log_name(12, NOW)
    assert name == "00000012_2026-11-21T14-05-09Z.tlog"
    assert (log_number(name), log_time(name)) == (12, int(NOW))


def test_without_a_clock_a_name_carries_its_number() -> None:
    name = log_name(7, 1234.5)
    assert name == "00000007.tlog"
    assert (log_number(name), log_time(name)) == (7, 0)


@pytest.mark.parametrize(
    "name", ["notes.txt", "1.tlog", "00000001.tlog.gz", "00000001_now.tlog", "../00000001.tlog", ""]
)
def test_other_names_are_none_of_ours(name: str) -> None:
    assert (log_number(name), log_time(name)) == (None, 0)


def test_digits_that_are_no_date_are_no_time() -> None:
    assert log_time("00000001_2026-13-41T99-05-09Z.tlog") == 0


def test_numbers_go_on_after_restart_and_after_a_removal_of_all(tmp_path: Path) -> None:
    folder = tmp_path / "state" / "logs"
    for _ in range(2):
        files(folder).open(MANY).close()
    assert [log_number(name) for name in names(folder)] == [1, 2]
    same = files(folder)
    same.open(MANY).close()
    for name in names(folder):
        (folder / name).unlink()
    same.open(MANY).close()
    assert [log_number(name) for name in names(folder)] == [4]


def test_logs_sort_by_number_also_where_the_clock_was_wrong(tmp_path: Path) -> None:
    for now in (NOW, 30.0, NOW - 1e7):
        files(tmp_path, now=now).open(MANY).close()
    assert [log_number(name) for name in names(tmp_path)] == [1, 2, 3]


def test_the_oldest_goes_where_there_are_too_many(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    for _ in range(5):
        files(tmp_path).open(FlightLogLimits(3, 0)).close()
    assert [log_number(name) for name in names(tmp_path)] == [3, 4, 5, None]


def test_the_oldest_go_until_enough_is_free(tmp_path: Path) -> None:
    for _ in range(5):
        files(tmp_path).open(MANY).close()
    free = iter([10, 20, 30, 40, PLENTY])
    LogFiles(tmp_path, clock=lambda: NOW, free=lambda path: next(free)).open(FlightLogLimits(500, 40)).close()
    assert [log_number(name) for name in names(tmp_path)] == [4, 5, 6]


def test_writes_are_there_at_once_under_the_final_name(tmp_path: Path) -> None:
    folder = files(tmp_path)
    log = folder.open(MANY)
    log.write(b"data")
    [name] = names(tmp_path)
    assert folder.current == name
    assert (tmp_path / name).read_bytes() == b"data"
    log.close()
    assert folder.current is None


def test_a_log_that_grows_long_goes_on_in_another_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tlog_files, "FILE_SIZE_MAX", 10)
    folder = files(tmp_path)
    log = folder.open(FlightLogLimits(2, 0))
    for data in (b"one", b"two", b"three", b"four", b"more than a file"):
        log.write(data)
        assert folder.current == names(tmp_path)[-1]
    log.close()
    assert [(tmp_path / name).read_bytes() for name in names(tmp_path)] == [b"threefour", b"more than a file"]


# ---- a disk that does not take it ----


def test_an_all_but_full_disk_gets_no_file(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No space"):
        files(tmp_path, free=FREE_SPACE_MIN - 1).open(MANY)
    assert names(tmp_path) == []


def test_a_disk_that_fills_up_ends_the_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tlog_files, "SYNC_INTERVAL", 0.0)
    free = iter([PLENTY, PLENTY, 5])
    log = LogFiles(tmp_path, clock=lambda: NOW, free=lambda path: next(free)).open(MANY)
    log.write(b"data")
    with pytest.raises(OSError, match="No space"):
        log.write(b"more")
    log.close()
    assert (tmp_path / names(tmp_path)[0]).read_bytes() == b"data"


def test_a_disk_without_room_for_the_next_file_ends_the_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tlog_files, "FILE_SIZE_MAX", 10)
    closed: list[int] = []
    close = os.close

    def noted(descriptor: int) -> None:
        closed.append(descriptor)
        close(descriptor)

    monkeypatch.setattr(os, "close", noted)
    free = iter([PLENTY, PLENTY, 5])
    log = LogFiles(tmp_path, clock=lambda: NOW, free=lambda path: next(free)).open(MANY)
    log.write(b"data")
    with pytest.raises(OSError, match="No space"):
        log.write(b"too much")
    log.close()
    assert len(closed) == len(set(closed)) == 2, "folder and file: a number closed twice may be another's by then"
    assert (tmp_path / names(tmp_path)[0]).read_bytes() == b"data"


def test_a_file_that_somebody_removed_ends_the_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tlog_files, "SYNC_INTERVAL", 0.0)
    log = files(tmp_path).open(MANY)
    (tmp_path / names(tmp_path)[0]).unlink()
    with pytest.raises(FileNotFoundError, match="removed"):
        log.write(b"data")
    log.close()


def test_a_file_in_place_of_the_folder_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("")
    with pytest.raises(OSError, match="exists"):
        files(tmp_path / "logs").require_writable()


def test_a_folder_that_may_not_be_written_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    files(tmp_path).require_writable()
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # as for a user who is not root
    with pytest.raises(PermissionError, match=re.escape(os.strerror(errno.EACCES))):
        files(tmp_path).require_writable()


@pytest.fixture
def card(tmp_path: Path) -> Iterator[Path]:
    """A file system of 9 MB of its own, where that is allowed."""
    place = tmp_path / "card"
    place.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=9m", "tmpfs", str(place)], capture_output=True, check=False
    )
    if mounted.returncode:
        pytest.skip("mounting is not allowed here")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def test_a_real_card_that_fills_up(card: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tlog_files, "SYNC_INTERVAL", 0.0)
    log = LogFiles(card, clock=time.time).open(MANY)

    def fill() -> None:
        for _ in range(20):
            log.write(bytes(100_000))

    with pytest.raises(OSError, match="No space"):
        fill()
    log.close()
    [name] = names(card)
    status = os.statvfs(card)
    assert (card / name).stat().st_size > 500_000
    assert status.f_bavail * status.f_frsize > FREE_SPACE_MIN - 200_000


def test_a_real_card_that_is_read_only(card: Path) -> None:
    subprocess.run(["mount", "-o", "remount,ro", str(card)], check=True)
    with pytest.raises(OSError, match=r"Read-only|denied"):
        LogFiles(card).open(MANY)
