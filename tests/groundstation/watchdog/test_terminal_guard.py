"""The guard of a terminal whose screen is killed or ends in order, with real processes and a real terminal."""

from __future__ import annotations

import os
import pty
import select
import signal
import termios
import tty
from collections.abc import Callable, Iterator
from pathlib import Path
from threading import get_native_id

import pytest

from groundstation.watchdog.terminal_guard import guard_terminal
from groundstation.watchdog.terminal_reset import RESET
from tests.waits import wait_until


class Terminal:
    """A terminal in raw mode, and a process with a guard of it."""

    def __init__(self) -> None:
        self.master, self.slave = pty.openpty()
        self.cooked = termios.tcgetattr(self.slave)

    def run(self, end: Callable[[], None]) -> int:
        """Run `end` in another process under the guard, and return how that process ended."""
        child = os.fork()
        if not child:
            code = 1
            try:
                signal.signal(signal.SIGHUP, signal.SIG_DFL)  # else it is ignored under nohup
                with guard_terminal(os.ttyname(self.slave)):
                    tty.setraw(self.slave)
                    end()
                code = 0
            finally:
                os._exit(code)
        return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

    def read_reset(self) -> bytes:
        """Return what the guard writes."""
        found = b""
        while len(found) < len(RESET) and select.select([self.master], [], [], 20.0)[0]:
            found += os.read(self.master, 4096)
        return found

    def is_untouched(self) -> bool:
        return not select.select([self.master], [], [], 0.0)[0] and termios.tcgetattr(self.slave) != self.cooked


def children() -> list[int]:
    """Return the processes that this thread has forked and not waited for."""
    return [int(each) for each in Path(f"/proc/self/task/{get_native_id()}/children").read_text().split()]


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    terminal = Terminal()
    yield terminal
    os.close(terminal.master)
    os.close(terminal.slave)


def test_a_killed_screen_leaves_its_terminal_in_order(terminal: Terminal) -> None:
    assert terminal.run(lambda: os.kill(os.getpid(), signal.SIGKILL)) == -signal.SIGKILL
    assert terminal.read_reset() == RESET
    while termios.tcgetattr(terminal.slave) != terminal.cooked:
        select.select([], [], [], 0.01)  # the guard restores the line after it has written


def test_the_guard_outlives_the_hangup_of_its_session(terminal: Terminal) -> None:
    """A session that ends hangs up all of its processes, and the group of the terminal."""

    def hang_up() -> None:
        (guard,) = children()
        wait_until(lambda: os.getsid(guard) == guard and ignores_hangup(guard))
        os.kill(guard, signal.SIGHUP)
        os.kill(os.getpid(), signal.SIGKILL)

    terminal.run(hang_up)
    assert terminal.read_reset() == RESET


def ignores_hangup(process: int) -> bool:
    """Return whether a process ignores SIGHUP."""
    (line,) = (line for line in Path(f"/proc/{process}/status").read_text().splitlines() if line.startswith("SigIgn"))
    return bool(int(line.split()[1], 16) & 1 << (signal.SIGHUP - 1))


def test_a_screen_that_ends_in_order_is_not_reset(terminal: Terminal) -> None:
    assert terminal.run(lambda: None) == 0
    assert terminal.is_untouched()


def test_a_screen_that_fails_is_no_killed_one(terminal: Terminal) -> None:
    """Its own clean-up has restored the terminal."""

    def fail() -> None:
        raise SystemExit(3)

    assert terminal.run(fail) == 1
    assert terminal.is_untouched()


def test_a_guard_that_was_killed_ends_no_screen(terminal: Terminal) -> None:
    def kill() -> None:
        (guard,) = children()
        os.kill(guard, signal.SIGKILL)
        os.waitid(os.P_PID, guard, os.WEXITED | os.WNOWAIT)  # until its end of the pipe is closed

    assert terminal.run(kill) == 0
    assert terminal.is_untouched()


def test_a_guard_leaves_no_process_and_no_descriptor(terminal: Terminal) -> None:
    def guard_another() -> None:
        before = children(), os.listdir("/proc/self/fd")
        with guard_terminal(None):
            assert len(children()) == len(before[0]) + 1
        assert (children(), os.listdir("/proc/self/fd")) == before

    assert terminal.run(guard_another) == 0
