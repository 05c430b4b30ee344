"""The reset of a terminal that nobody reads at that moment."""

from __future__ import annotations

import contextlib
import os
import pty
import tty

from groundstation.watchdog.terminal_reset import RESET, TerminalReset


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
    os.close(slave)
    os.close(master)
    assert reset.run()


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
