from __future__ import annotations

import fcntl
import logging
import os
import select
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from link.runtime import journald
from tests.waits import Waits
from vehicle.runtime import log as vehicle_log
from vehicle.runtime.log import QUEUE_LINES, DaemonLog

log = logging.getLogger("vehicle.test")


@pytest.fixture
def stderr(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """The reading end of a pipe that stands for stderr, which a shell inherited whose own went to the journal."""
    reader, writer = os.pipe()
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    monkeypatch.setattr(journald, "STDERR", writer)
    monkeypatch.setenv("JOURNAL_STREAM", "8:1")
    yield reader
    os.close(writer)
    os.close(reader)


def fail() -> None:
    raise ZeroDivisionError("bug")


def test_the_journal_gets_the_severity_in_front(stderr: int, monkeypatch: pytest.MonkeyPatch) -> None:
    stream = os.fstat(stderr)  # both ends of a pipe have one inode
    monkeypatch.setenv("JOURNAL_STREAM", f"{stream.st_dev}:{stream.st_ino}")
    lines = DaemonLog()
    log.info("ready")
    log.error("no board")
    lines.close()
    assert os.read(stderr, 4096) == b"<6>vehicle: ready\n<3>vehicle: no board\n"


def test_a_terminal_gets_nothing_that_it_would_obey(stderr: int) -> None:
    lines = DaemonLog()
    log.info("No parameter %s", "\x1b[2J\r\n\x07X")
    lines.close()
    assert os.read(stderr, 4096) == b"vehicle: No parameter \\x1b[2J \\x07X\n"


def test_a_person_gets_one_line_and_the_file_the_traceback(stderr: int, tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.write_text("earlier\n")
    lines = DaemonLog(str(path))
    try:
        fail()
    except ZeroDivisionError:
        log.critical("a\n  fault", exc_info=True)
    lines.close()
    assert os.read(stderr, 4096) == b"vehicle: a fault\n"
    written = path.read_text()
    assert written.startswith("earlier\n")
    assert "CRITICAL vehicle.test: a\n" in written
    assert "ZeroDivisionError: bug" in written


@pytest.mark.parametrize(("verbose", "says"), [(False, b"vehicle: more\n"), (True, b"vehicle: much\nvehicle: more\n")])
def test_verbose_says_more(stderr: int, verbose: bool, says: bytes) -> None:
    lines = DaemonLog(verbose=verbose)
    log.debug("much")
    log.info("more")
    lines.close()
    assert os.read(stderr, 4096) == says


def test_nothing_is_logged_after_close(stderr: int) -> None:
    lines = DaemonLog()
    log.info("before")
    lines.close()
    log.info("after")
    assert os.read(stderr, 4096) == b"vehicle: before\n"


def test_who_logs_never_waits_for_who_reads(stderr: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(vehicle_log, "DRAIN", 0.05)
    lines = DaemonLog()
    start, waits = time.monotonic(), Waits()
    for number in range(QUEUE_LINES * 2):
        log.info("%d %s", number, "." * 100)
    lines.close()
    assert time.monotonic() - start < 5.0 + waits.total()
    written = b""
    while select.select([stderr], [], [], 0.3)[0]:  # to the end, so that the thread leaves this pipe alone
        written += os.read(stderr, 4096)
    assert written.startswith(b"vehicle: 0 ")
    assert QUEUE_LINES <= written.count(b"\n") < QUEUE_LINES * 2


def test_a_full_disk_is_nobodys_fault(stderr: int) -> None:
    lines = DaemonLog("/dev/full")
    log.info("hello")
    log.info("again")
    lines.close()
    assert os.read(stderr, 4096) == b"vehicle: hello\nvehicle: again\n"


def test_a_pipe_that_nobody_reads_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "log")
    with pytest.raises(OSError, match="No such device"):
        DaemonLog(str(tmp_path / "log"))
