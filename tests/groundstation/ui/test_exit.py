"""How the screen's process ends: signals, a closed terminal, a stuck one; each with the real program."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

PROGRAM = """
from tests.groundstation.ui.examples import Recorder, snapshot
from tests.groundstation.ui.ptys import STANDARD
from groundstation.ui.app import run
import sys
station = Recorder()
station.offer(snapshot())
print("a library prints this")
code = run(station, keymap=STANDARD)
print("ENDED", code, *(type(intent).__name__ for intent in station.intents[-4:]), file=open(sys.argv[1], "w"))
sys.exit(code)
"""

LIMIT = 60.0
"""s for what takes half a second."""


class Program:
    """The screen on a pseudo-terminal of its own."""

    def __init__(self, report: Path) -> None:
        self.master, self.slave = pty.openpty()
        self.report = report
        self.drawn = b""
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, str(report)],
            stdin=self.slave, stdout=self.slave, stderr=self.slave,
            cwd=Path(__file__).parents[3], start_new_session=True,
        )  # fmt: skip

    def read_until(self, wanted: bytes) -> None:
        """Read what is drawn until it holds the bytes."""
        deadline = time.monotonic() + LIMIT
        while wanted not in self.drawn:
            assert time.monotonic() < deadline, self.drawn[-2000:]
            if select.select([self.master], [], [], 0.1)[0]:
                self.drawn += os.read(self.master, 1 << 16)

    def end(self) -> int:
        """Read to the end and give the exit code."""
        os.close(self.slave)
        with contextlib.suppress(OSError):  # EIO: the other end is closed
            while data := os.read(self.master, 1 << 16):
                self.drawn += data
        return self.process.wait(LIMIT)


@pytest.fixture
def program(tmp_path: Path) -> Iterator[Program]:
    made = Program(tmp_path / "report")
    yield made
    made.process.kill()
    made.process.wait()
    for descriptor in (made.master, made.slave):
        with contextlib.suppress(OSError):
            os.close(descriptor)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_is_an_orderly_end(program: Program, number: signal.Signals) -> None:
    program.read_until(b"you drive")
    program.process.send_signal(number)
    assert program.end() == 128 + number
    assert b"\x1b[?1049l" in program.drawn
    assert "Gate Stop" in program.report.read_text()


def test_quit_is_zero_and_leaves_the_terminal_as_it_was(program: Program) -> None:
    program.read_until(b"you drive")
    os.write(program.master, b"\x11")  # ctrl+q
    assert program.end() == 0
    assert b"\x1b[<u" in program.drawn
    assert b"\x1b[?1049l" in program.drawn


def test_a_closed_terminal_is_the_end(program: Program) -> None:
    program.read_until(b"you drive")
    os.close(program.slave)
    os.close(program.master)
    assert program.process.wait(LIMIT) == 128 + signal.SIGHUP
    assert "Gate Stop" in program.report.read_text()


def test_a_terminal_that_takes_nothing_does_not_keep_it_from_ending(program: Program) -> None:
    """As behind an ssh whose network is gone: the screen's writer waits for ever, and so does who waits for it."""
    program.read_until(b"you drive")
    termios.tcflow(program.slave, termios.TCOOFF)
    os.write(program.master, b"ijl?")
    program.process.send_signal(signal.SIGTERM)
    assert program.process.wait(LIMIT) in (1, 128 + signal.SIGTERM)


def test_what_a_library_prints_is_not_on_the_screen(program: Program) -> None:
    program.read_until(b"you drive")
    assert b"a library prints this" in program.drawn[: program.drawn.index(b"\x1b[?1049h")]
