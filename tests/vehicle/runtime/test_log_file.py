"""The log file has a bound, whatever strangers make the vehicle say."""

from __future__ import annotations

import logging
import os
from contextlib import suppress
from pathlib import Path

import pytest

from tests.waits import wait_until
from vehicle.runtime import log_file
from vehicle.runtime.log import DaemonLog
from vehicle.runtime.log_file import LogFile

SIZE = 1000


@pytest.fixture(autouse=True)
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(log_file, "SIZE_MAX", SIZE)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "vehicle.log"


def read(path: Path) -> bytes:
    """Return what is in the log file; nothing while a new one is begun."""
    with suppress(FileNotFoundError):
        return path.read_bytes()
    return b""


def lines(count: int, first: int = 0) -> list[bytes]:
    """Return lines of 50 bytes."""
    return [b"%049d\n" % number for number in range(first, first + count)]


def write(path: Path, *texts: bytes) -> None:
    file = LogFile(str(path))
    for text in texts:
        file.write(text)
    file.close()


def test_a_full_file_is_kept_once_and_a_new_one_begun(path: Path) -> None:
    write(path, *lines(20))
    assert [each.name for each in path.parent.iterdir()] == ["vehicle.log"]
    write(path, *lines(25, first=20))
    before = path.with_name("vehicle.log.1")
    assert sorted(each.name for each in path.parent.iterdir()) == ["vehicle.log", "vehicle.log.1"]
    assert before.read_bytes() == b"".join(lines(20, first=20))
    assert path.read_bytes() == b"".join(lines(5, first=40))


def test_the_program_never_writes_more_than_two_files(path: Path) -> None:
    """Through the whole log of the daemon: 20 times the size of a file."""
    log = DaemonLog(str(path))
    for number in range(200):
        logging.getLogger("vehicle.test").info("%d %s", number, "x" * 100)
    wait_until(lambda: b" 199 xxx" in read(path), "the last line")  # close() waits for a second only
    log.close()
    assert sum(each.stat().st_size for each in path.parent.iterdir()) <= 2 * SIZE
    assert b" 199 xxx" in path.read_bytes().splitlines()[-1].replace(b"vehicle.test:", b"")


def test_a_line_longer_than_a_file_is_written(path: Path) -> None:
    """A traceback is not cut."""
    write(path, b"x" * (SIZE * 2), b"next\n")
    assert path.read_bytes() == b"next\n"
    assert path.with_name("vehicle.log.1").stat().st_size == SIZE * 2


def test_a_file_that_was_emptied_by_somebody_else_goes_on(path: Path) -> None:
    """As logrotate does with copytruncate."""
    file = LogFile(str(path))
    for line in lines(19):
        file.write(line)
    os.truncate(path, 0)
    for line in lines(19):
        file.write(line)
    file.close()
    assert path.read_bytes() == b"".join(lines(19))
    assert not path.with_name("vehicle.log.1").exists()


def test_where_no_other_name_can_be_had_the_file_is_emptied(path: Path) -> None:
    path.with_name("vehicle.log.1").mkdir()
    write(path, *lines(25))
    assert path.read_bytes() == b"".join(lines(5, first=20))


def test_a_device_is_not_replaced(tmp_path: Path) -> None:
    link = tmp_path / "null"
    link.symlink_to("/dev/null")
    write(link, *lines(50))
    assert link.is_symlink()
    assert [each.name for each in tmp_path.iterdir()] == ["null"]


def test_a_relative_name_stays_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = LogFile("vehicle.log")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    for line in lines(25):
        file.write(line)
    file.close()
    assert (tmp_path / "vehicle.log.1").exists()
    assert list((tmp_path / "elsewhere").iterdir()) == []
