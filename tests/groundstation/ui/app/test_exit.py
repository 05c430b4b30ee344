"""How the screen's process ends: signals, a closed terminal, a stuck one; each with the real program."""

from __future__ import annotations

import os
import signal
import termios

import pytest

from tests.groundstation.ui.programs import LIMIT, Program


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_is_an_orderly_end(program: Program, number: signal.Signals) -> None:
    program.read_until(b"you drive")
    program.process.send_signal(number)
    assert program.end() == 128 + number
    assert b"\x1b[?1049l" in program.drawn
    assert program.report.read_text().endswith("SetKeyGate\nStop\n")


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
    assert program.report.read_text().endswith("SetKeyGate\nStop\n")


def test_a_terminal_that_takes_nothing_does_not_prevent_the_end(program: Program) -> None:
    """As behind an ssh whose network is gone: the screen's writer waits for ever, and so does who waits for it."""
    program.read_until(b"you drive")
    termios.tcflow(program.slave, termios.TCOOFF)
    os.write(program.master, b"ijl?")
    program.process.send_signal(signal.SIGTERM)
    assert program.process.wait(LIMIT) in (1, 128 + signal.SIGTERM)


def test_what_a_library_prints_is_not_on_the_screen(program: Program) -> None:
    program.read_until(b"you drive")
    assert b"a library prints this" in program.drawn[: program.drawn.index(b"\x1b[?1049h")]
