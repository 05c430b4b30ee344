"""When a terminal counts as silent."""

from __future__ import annotations

import pytest

from groundstation.ui.tty_ping import Ping


def test_pings_are_due_four_times_a_second() -> None:
    ping = Ping()
    assert [now for now in (0.0, 0.1, 0.2, 0.25, 0.3, 0.49, 0.5) if ping.due(now)] == [0.0, 0.25, 0.5]


def test_two_misses_are_silence() -> None:
    ping = Ping()
    ping.due(0.0)
    ping.answered(0.004)
    ping.due(0.25)
    assert not ping.silent(0.74)
    assert ping.silent(0.76)
    ping.answered(0.8)
    assert not ping.silent(0.8)


def test_one_that_never_answered_is_never_silent() -> None:
    ping = Ping()
    for quarter in range(100):
        ping.due(quarter / 4)
    assert not ping.silent(25.0)


def test_the_round_trip_is_of_the_ping_that_is_answered() -> None:
    ping = Ping()
    ping.due(0.0)
    ping.due(0.25)
    ping.answered(0.3)
    assert ping.round_trip == pytest.approx(0.3)
    ping.answered(0.55)
    assert ping.round_trip == pytest.approx(0.3)


def test_answers_after_a_silence_do_not_claim_a_long_round_trip_for_ever() -> None:
    ping = Ping()
    ping.due(0.0)
    ping.answered(0.01)
    for quarter in range(1, 9):
        ping.due(quarter / 4)
    for _ in range(8):
        ping.answered(2.1)
    ping.due(2.25)
    ping.answered(2.26)
    assert ping.round_trip == pytest.approx(0.01)
