"""The file that leads to the terminal."""

from __future__ import annotations

import os
import pty
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from groundstation.ui.terminal.tty_output import TerminalFile, redirect_output

LIMIT = 60.0


@contextmanager
def opened(*, blocks: bool = False) -> Iterator[tuple[int, TerminalFile]]:
    """The other end of a pseudo-terminal, and the file that leads to it."""
    master, slave = pty.openpty()
    os.set_blocking(slave, blocks)
    try:
        yield master, TerminalFile(slave, slave)
    finally:
        os.close(master)
        os.close(slave)


def test_a_terminal_that_takes_nothing_is_stuck_until_given_up() -> None:
    with opened() as (_, file):
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


def test_a_terminal_that_has_gone_swallows_the_rest() -> None:
    master, slave = pty.openpty()
    os.close(master)
    file = TerminalFile(slave, slave)
    file.write("x")
    file.flush()
    assert file.gone
    assert not file.is_stuck(time.monotonic() + 9.0)
    os.close(slave)


def test_a_terminal_that_accepts_a_frame_gets_it_at_once() -> None:
    with opened() as (master, file):
        assert file.write_at_once("frame") is None
        assert os.read(master, 100) == b"frame"


def test_one_that_accepts_a_part_gets_the_rest_in_order() -> None:
    receiving, sending = os.pipe()
    os.set_blocking(sending, False)
    file = TerminalFile(sending, sending)
    frames = ["a" * 100_000, "b" * 1000, "c"]
    left = [file.write_at_once(frame) for frame in frames]
    assert left == ["", *frames[1:]], "the thread has not written the first one yet"

    def write() -> None:
        for each in left:
            file.write(each or "")
        file.flush()

    writer = Thread(target=write, daemon=True)
    writer.start()
    received = b""
    while len(received) < 101_001:
        received += os.read(receiving, 4096)
    assert received.decode() == "".join(frames)
    writer.join(LIMIT)
    assert file.write_at_once("d") is None, "the thread has caught up"
    assert os.read(receiving, 10) == b"d"
    os.close(receiving)
    os.close(sending)


def test_one_that_blocks_is_left_to_the_thread() -> None:
    with opened(blocks=True) as (master, file):
        assert file.write_at_once("frame") == "frame"
        file.write("frame")
        file.flush()
        assert os.read(master, 100) == b"frame"


def test_what_is_put_before_all_else_stays_there() -> None:
    with opened() as (master, file):
        file.prepend("first ")
        assert file.write_at_once("then") == "then"
        file.write("then")
        file.flush()
        assert os.read(master, 100) == b"first then"


def test_what_is_printed_meanwhile_goes_to_the_log(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with redirect_output(log):
        os.write(1, b"out ")
        os.write(2, b"err")
    assert log.read_bytes() == b"out err"
