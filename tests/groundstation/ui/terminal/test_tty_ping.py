"""When a terminal counts as silent."""

from __future__ import annotations

import pytest

from groundstation.ui.terminal.tty_ping import TerminalPing


def test_pings_are_due_four_times_a_second() -> None:
    ping = TerminalPing()
    assert [now for now in (0.0, 0.1, 0.2, 0.25, 0.3, 0.49, 0.5) if ping.next_due(now)] == [0.0, 0.25, 0.5]


def test_two_misses_are_silence() -> None:
    ping = TerminalPing()
    ping.next_due(0.0)
    ping.handle_answer(0.004)
    ping.next_due(0.25)
    assert not ping.is_silent(0.74)
    assert ping.is_silent(0.76)
    ping.handle_answer(0.8)
    assert not ping.is_silent(0.8)


def test_one_that_never_answered_is_never_silent() -> None:
    ping = TerminalPing()
    for quarter in range(100):
        ping.next_due(quarter / 4)
    assert not ping.is_silent(25.0)


def test_the_round_trip_is_of_the_ping_that_is_answered() -> None:
    ping = TerminalPing()
    ping.next_due(0.0)
    ping.next_due(0.25)
    ping.handle_answer(0.3)
    assert ping.round_trip == pytest.approx(0.3)
    ping.handle_answer(0.55)
    assert ping.round_trip == pytest.approx(0.3)


def test_answers_after_a_silence_do_not_claim_a_long_round_trip() -> None:
    ping = TerminalPing()
    ping.next_due(0.0)
    ping.handle_answer(0.01)
    for quarter in range(1, 9):
        ping.next_due(quarter / 4)
    for _ in range(8):
        ping.handle_answer(2.1)
    ping.next_due(2.25)
    ping.handle_answer(2.26)
    assert ping.round_trip == pytest.approx(0.01)


def test_the_answer_behind_a_picture_tells_its_time() -> None:
    ping = TerminalPing()
    ping.next_due(0.0)
    ping.send_behind_frame(0.1)
    ping.next_due(0.25)
    ping.handle_answer(0.26)
    assert ping.pop_frame_time() is None
    ping.handle_answer(0.3)
    assert ping.pop_frame_time() == pytest.approx(0.2)
    assert ping.pop_frame_time() is None
    ping.handle_answer(0.31)
    assert ping.quickest == pytest.approx(0.06)
