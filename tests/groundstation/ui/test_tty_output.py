"""The file that leads to the terminal."""

from __future__ import annotations

import os
import pty
import time
from pathlib import Path
from threading import Thread

from groundstation.ui.terminal.tty_output import TerminalFile, redirect_output

LIMIT = 60.0


def test_a_terminal_that_takes_nothing_is_stuck_until_it_is_given_up() -> None:
    master, slave = pty.openpty()
    os.set_blocking(slave, False)
    file = TerminalFile(slave, slave)
    file.write("x" * 1_000_000)
    writer = Thread(target=file.flush, daemon=True)
    writer.start()
    writer.join(0.2)
    assert writer.is_alive()
    assert not file.is_stuck(time.monotonic())
    assert file.is_stuck(time.monotonic() + 1.0)
    file.abandon()
    writer.join(LIMIT)
    assert not writer.is_alive()
    os.close(master)
    os.close(slave)


def test_a_terminal_that_has_gone_swallows_the_rest() -> None:
    master, slave = pty.openpty()
    os.close(master)
    file = TerminalFile(slave, slave)
    file.write("x")
    file.flush()
    assert file.gone
    assert not file.is_stuck(time.monotonic() + 9.0)
    os.close(slave)


def test_what_is_printed_meanwhile_goes_to_the_log(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with redirect_output(log):
        os.write(1, b"out ")
        os.write(2, b"err")
    assert log.read_bytes() == b"out err"
