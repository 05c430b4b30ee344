"""The mouse never drives: neither its wheel as arrow keys nor its reports, however they arrive."""

from __future__ import annotations

import os
import signal
from itertools import pairwise
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.input.keymap import KeyEvent
from groundstation.intents.driving import DriveKeyDown, StepLimits, Stop
from groundstation.ui.terminal.console_driver import ConsoleDriver
from groundstation.ui.terminal.escape_sequences import MAX_LENGTH, OPEN_TIME, Piece, SequenceAssembler
from groundstation.ui.terminal.key_parser import KeyEventParser
from groundstation.ui.terminal.mouse import CAPTURE_MOUSE, RELEASE_MOUSE
from tests.groundstation.ui.programs import Program
from tests.groundstation.ui.ptys import app_on_a_pty
from tests.groundstation.ui.sinks import Clock, Sink
from tests.groundstation.ui.wheel import DOWN, UP, modes, notch
from tests.waits import until

REPORTS = {
    "wheel up": "\x1b[<64;11;12M",
    "wheel down": "\x1b[<65;2;1M",
    "release": "\x1b[<0;111;2m",
    "wheel in X10 encoding": "\x1b[M`ir",
    "button in X10 encoding": "\x1b[M !y",
}
"""Reports that hold the keys of MANUAL, HOLD, arming, its answer, driving, stop and emergency stop."""

ALLOWED = {"escape"}
"""What the first byte of any sequence is, when the second comes much later."""


def keys_of(reads: list[str], gap: float) -> list[str]:
    """Return the keys that the parser reports for reads `gap` s apart."""
    sink, clock = Sink(), Clock()
    parser = KeyEventParser(sink, clock=clock)
    for read in reads:
        parser.feed(read)
        for _ in range(4):
            clock.now += gap / 4
            parser.tick()
    return [press.key for batch in sink.batches for press in batch]


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_a_report_is_no_key(report: str) -> None:
    assert keys_of([report], 0.0) == []
    assert keys_of([f"i{report}k"], 0.0) == ["i", "k"]


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
@pytest.mark.parametrize("gap", [0.0, 0.05, 0.12, 0.24])
def test_a_report_split_at_every_byte_is_no_key(report: str, gap: float) -> None:
    """On a slow line the stock parser gives up after 0.1 s and reports the rest as keys: 1 is MANUAL, m drives."""
    found = keys_of([*report, "x"], gap)
    assert found[-1] == "x"
    assert set(found[:-1]) <= ALLOWED


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_a_report_in_two_reads_is_no_key(report: str) -> None:
    for cut in range(1, len(report)):
        for gap in (0.0, 0.15, 0.5):
            assert set(keys_of([report[:cut], report[cut:]], gap)) <= ALLOWED, (cut, gap)


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_many_reports_in_any_pieces_are_no_keys(report: str) -> None:
    data = report * 30
    for size in range(1, 40):
        assert keys_of([data[start : start + size] for start in range(0, len(data), size)], 0.0) == []


@given(st.lists(st.integers(1, 60), max_size=6))
def test_reports_between_keys_leave_the_keys_as_they_are(cuts: list[int]) -> None:
    data = "i\x1b[<64;11;12Mj\x1b[A\x1b[<65;1;2Ml\x1b[M`!!k"
    places = sorted({0, len(data), *(cut for cut in cuts if cut < len(data))})
    assert keys_of([data[start:end] for start, end in pairwise(places)], 0.0) == ["i", "j", "up", "l", "k"]


@pytest.mark.parametrize(("key", "name"), [("!", "exclamation_mark"), (" ", "space"), ("\x0b", "ctrl+k")])
@pytest.mark.parametrize("cut", ["\x1b[<", "\x1b[<64", "\x1b[<64;11;1"])
def test_a_stop_key_behind_an_unfinished_report_counts_at_once(cut: str, key: str, name: str) -> None:
    assert keys_of([cut + key], 0.0) == [name]
    assert keys_of([cut, key], 0.0) == [name]


@pytest.mark.parametrize("cut", ["\x1b[<64;1", "\x1b[M", "\x1b[M`"])
def test_an_endless_report_does_not_keep_the_keys_for_ever(cut: str) -> None:
    assert keys_of([cut, "1"], OPEN_TIME + 0.1) == ["1"]


def test_a_lone_escape_is_a_key_after_the_usual_delay() -> None:
    sink, clock = Sink(), Clock()
    parser = KeyEventParser(sink, clock=clock)
    parser.feed("\x1b")
    clock.now += 0.09
    parser.tick()
    assert sink.batches == []
    clock.now += 0.02
    parser.tick()
    assert sink.batches == [[KeyEvent("escape")]]


def test_sequences_of_keys_may_still_come_in_pieces() -> None:
    assert keys_of(["\x1b", "[", "A"], 0.0) == ["up"]
    assert keys_of(["\x1b[", "20~"], 0.05) == ["f9"]


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_a_report_cancels_the_hold_of_a_key(report: str) -> None:
    sink = Sink()
    parser = KeyEventParser(sink, clock=Clock())
    parser.feed("r\x1b[0n")
    assert sink.cancelled == 0
    for part in (report[:2], report[2:]):
        parser.feed(part)
    assert sink.cancelled == 1


def test_a_flood_without_an_end_does_not_grow() -> None:
    sequences = SequenceAssembler()
    assert sequences.feed("\x1b[<", 0.0) == []
    assert all(sequences.feed("1" * 100, 0.0) == [] for _ in range(100))
    assert len(sequences._held) <= MAX_LENGTH
    assert sequences.feed("M!", 0.0) == [Piece("!")]


# ---- with real pseudo-terminals ----


@pytest.mark.parametrize("button", [UP, DOWN])
async def test_the_wheel_drove_and_does_no_longer(button: int, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as before:
        before.setattr(ConsoleDriver, "_enable_mouse_support", lambda self: None)
        async with app_on_a_pty() as (_, station, terminal):
            terminal.type(notch(bytes(terminal.drawn), button))
            await until(lambda: station.of(DriveKeyDown))
    async with app_on_a_pty() as (_, station, terminal):
        await until(lambda: CAPTURE_MOUSE.encode() in terminal.drawn)
        for _ in range(20):
            terminal.type(notch(bytes(terminal.drawn), button))
        terminal.type("-")  # a key that drives nothing and stops nothing: it comes after the wheel
        await until(lambda: station.wishes)
        assert not station.of(DriveKeyDown)
        assert not station.of(Stop)


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
async def test_reports_that_arrive_byte_by_byte_send_nothing(report: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("groundstation.ui.app.app.PING", "")  # no answer to a ping comes in the middle of a report
    async with app_on_a_pty() as (_, station, terminal):
        await until(lambda: CAPTURE_MOUSE.encode() in terminal.drawn)
        await terminal.type_each(report * 8, 0.003)
        terminal.type("-")
        await until(lambda: station.of(StepLimits))
        # Bytes that a busy machine delays are a split key, which stops.
        assert [each for each in station.wishes if not isinstance(each, Stop)] == station.of(StepLimits)[:1]


@pytest.mark.parametrize("default", [True, False])
def test_quitting_leaves_the_modes_of_the_mouse_as_they_were(program: Program, default: bool) -> None:
    program.read_until(b"MANUAL")
    program.read_until(CAPTURE_MOUSE.encode())
    assert modes(program.drawn, default) | {1000: True, 1006: True, 1007: False} == modes(program.drawn, default)
    os.write(program.master, b"\x11")  # ctrl+q
    assert program.end() == 0
    after = modes(program.drawn, default)
    assert (after[1000], after[1006], after[1007]) == (False, False, default)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_a_signal_releases_the_mouse(program: Program, number: signal.Signals) -> None:
    program.read_until(b"MANUAL")
    program.read_until(CAPTURE_MOUSE.encode())
    program.process.send_signal(number)
    program.end()
    assert program.drawn.rfind(RELEASE_MOUSE.encode()) > program.drawn.rfind(CAPTURE_MOUSE.encode())


def test_a_crash_releases_the_mouse(tmp_path: Path) -> None:
    with Program.running(tmp_path / "report", crash=True) as program:
        program.read_until(CAPTURE_MOUSE.encode())
        assert program.end() == 1
        assert program.drawn.rfind(RELEASE_MOUSE.encode()) > program.drawn.rfind(CAPTURE_MOUSE.encode())


def test_suspended_program_releases_the_mouse_and_recaptures_it(program: Program) -> None:
    program.read_until(b"MANUAL")
    program.read_until(CAPTURE_MOUSE.encode())
    os.write(program.master, b"\x1a")  # ctrl+z
    program.read_until(RELEASE_MOUSE.encode())
    assert program.is_stopped()
    assert modes(program.drawn)[1007]
    suspended = len(program.drawn)
    program.process.send_signal(signal.SIGCONT)
    program.read_until(CAPTURE_MOUSE.encode(), suspended)
    assert not modes(program.drawn)[1007]
    assert program.quit() == 0
    assert modes(program.drawn)[1007]
