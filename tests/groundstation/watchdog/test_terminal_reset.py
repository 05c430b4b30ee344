"""The reset of a terminal that nobody reads at that moment."""

from __future__ import annotations

import contextlib
import os
import pty
import select
import termios
import threading
import time
import tty
from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.watchdog.terminal_reset import RESET, TerminalReset

CLOCK_STEP = 0.02
"""s: twice the step of the times of files, by which a terminal is told from the next one of its number."""


def test_a_terminal_full_of_output_is_reset_once_it_has_room() -> None:
    master, slave = pty.openpty()
    tty.setraw(slave)
    os.set_blocking(slave, False)
    os.set_blocking(master, False)
    _fill(slave)
    while (reset := TerminalReset(os.ttyname(slave))).run():
        _fill(slave)  # the kernel passes output on in the background, which makes room
    drawn = b""
    while not reset.run():
        drawn += _read(master)
    drawn += _read(master)
    assert drawn.endswith(RESET)
    os.close(master)
    os.close(slave)


def test_a_terminal_that_is_gone_is_done() -> None:
    master, slave = pty.openpty()
    reset = TerminalReset(os.ttyname(slave))
    threading.Event().wait(CLOCK_STEP)  # a test beside this one may get the number at once, and is not written to
    os.close(slave)
    os.close(master)
    assert reset.run()


def test_the_next_terminal_of_its_number_is_left_alone() -> None:
    for _ in range(100):  # another process may take the number
        master, slave = pty.openpty()
        path, reset = os.ttyname(slave), TerminalReset(os.ttyname(slave))
        threading.Event().wait(CLOCK_STEP)  # whoever gets the number at once is told apart
        os.close(slave)
        os.close(master)
        master, slave = pty.openpty()
        same = os.ttyname(slave) == path
        assert reset.run()
        drawn = bool(select.select([master], [], [], 0.0)[0])
        os.close(slave)
        os.close(master)
        assert not (same and drawn)
        if same:
            return
    raise AssertionError("no terminal ever got the number of the one before")


def _fill(slave: int) -> None:
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(slave, bytes(4096))


def _read(master: int) -> bytes:
    found = b""
    with contextlib.suppress(BlockingIOError):
        while data := os.read(master, 65536):
            found += data
    return found


class Raw:
    """A terminal whose line a screen has changed, and the reset that was made before."""

    def __init__(self) -> None:
        self.master, self.slave = pty.openpty()
        self.path = os.ttyname(self.slave)
        self.before = termios.tcgetattr(self.slave)
        self.reset = TerminalReset(self.path)
        tty.setraw(self.slave)
        self.raw = termios.tcgetattr(self.slave)

    def close(self) -> None:
        os.close(self.master)
        os.close(self.slave)


@pytest.fixture
def terminal() -> Iterator[Raw]:
    terminal = Raw()
    yield terminal
    terminal.close()


def descriptors() -> int:
    return len(os.listdir("/proc/self/fd"))


def test_the_line_is_as_it_was_before_the_screen(terminal: Raw) -> None:
    open_before = descriptors()
    assert terminal.reset.run()
    assert os.read(terminal.master, 4096) == RESET
    assert termios.tcgetattr(terminal.slave) == terminal.before
    TerminalReset(terminal.path)
    assert descriptors() == open_before


def test_the_line_that_a_shell_has_taken_stays(terminal: Raw) -> None:
    """A shell that edits lines has echo off, but keeps the signals of Ctrl-C."""
    edited = [*terminal.raw]
    edited[3] |= termios.ISIG
    termios.tcsetattr(terminal.slave, termios.TCSANOW, edited)
    edited = termios.tcgetattr(terminal.slave)
    assert terminal.reset.run()
    assert termios.tcgetattr(terminal.slave) == edited
    assert os.read(terminal.master, 4096) == RESET


def test_a_line_that_was_not_read_before_stays(terminal: Raw, tmp_path: Path) -> None:
    path = tmp_path / "tty"
    reset = TerminalReset(str(path))
    path.symlink_to(terminal.path)
    assert reset.run()
    assert os.read(terminal.master, 4096) == RESET
    assert termios.tcgetattr(terminal.slave) == terminal.raw


def test_a_file_that_is_no_terminal_raises_nothing(tmp_path: Path) -> None:
    path = tmp_path / "file"
    path.write_bytes(b"")
    assert TerminalReset(str(path)).run()
    assert path.read_bytes() == RESET


def test_no_terminal_is_done() -> None:
    assert TerminalReset(None).run()


def test_a_reset_that_insists_waits_for_room(terminal: Raw) -> None:
    termios.tcflow(terminal.slave, termios.TCOOFF)
    assert not terminal.reset.run()
    runs = threading.Thread(target=terminal.reset.insist, args=(60.0,))
    runs.start()
    assert not select.select([terminal.master], [], [], 0.05)[0]
    termios.tcflow(terminal.slave, termios.TCOON)
    runs.join(20.0)
    assert not runs.is_alive()
    assert os.read(terminal.master, 4096) == RESET
    assert termios.tcgetattr(terminal.slave) == terminal.before


def test_a_terminal_that_stays_full_is_given_up(terminal: Raw) -> None:
    termios.tcflow(terminal.slave, termios.TCOOFF)
    began = time.monotonic()
    terminal.reset.insist(0.05)
    assert time.monotonic() - began >= 0.05
    termios.tcflow(terminal.slave, termios.TCOON)
    assert terminal.reset.run()
    assert os.read(terminal.master, 4096) == RESET


def test_a_terminal_is_reset_once(terminal: Raw) -> None:
    assert terminal.reset.run()
    assert os.read(terminal.master, 4096) == RESET
    tty.setraw(terminal.slave)  # another screen starts
    assert terminal.reset.run()
    terminal.reset.insist(60.0)
    assert termios.tcgetattr(terminal.slave) == terminal.raw
    assert not select.select([terminal.master], [], [], 0.0)[0]
