"""The windows that a keyboard teaches."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.input.key_repeat import (
    FIRST,
    FIRST_LONGEST,
    FIRST_SHORTEST,
    LATER,
    LATER_LONGEST,
    LATER_SHORTEST,
    REPEAT_GAP,
    RepeatWindows,
    Trace,
)


def hold(windows: RepeatWindows, start: float, *, delay: float, gap: float, repeats: int = 30) -> Trace:
    trace = windows.press(None, start)
    now = start + delay
    for _ in range(repeats):
        windows.again(trace, now)
        now += gap
    return trace


def test_defaults_before_anything_is_known() -> None:
    assert (RepeatWindows().first, RepeatWindows().later) == (FIRST, LATER)


@pytest.mark.parametrize(
    ("delay", "gap", "first", "later"),
    [
        (0.25, 0.033, 0.3875, LATER_SHORTEST),
        (0.50, 0.040, 0.675, LATER_SHORTEST),
        (0.66, 0.040, FIRST, LATER_SHORTEST),
        (0.25, 0.092, 0.3875, 0.23),
        (0.75, 0.040, FIRST, LATER_SHORTEST),
        (0.80, 0.040, 1.02, LATER_SHORTEST),
        (1.00, 0.110, FIRST_LONGEST, LATER_LONGEST),
    ],
)
def test_windows_follow_the_keyboard(delay: float, gap: float, first: float, later: float) -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=delay, gap=gap)
    assert windows.first == pytest.approx(first)
    assert windows.later == pytest.approx(later, abs=1e-6)


def test_taps_teach_nothing() -> None:
    windows = RepeatWindows()
    trace = windows.press(None, 0.0)
    for step in range(1, 40):
        windows.again(trace, step * 0.3)
    assert (windows.first, windows.later) == (FIRST, LATER)


def test_a_long_delay_is_believed_only_after_five_repeats() -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=1.0, gap=0.04, repeats=5)  # the first event after the delay is none yet
    assert windows.first == FIRST
    hold(windows, 10.0, delay=1.0, gap=0.04, repeats=6)
    assert windows.first == FIRST_LONGEST


def test_a_tap_before_a_hold_is_no_long_delay() -> None:
    windows = RepeatWindows()
    tapped = windows.press(None, 0.0)
    trace = windows.press(tapped, 0.9)  # the tap was given up at 0.75: this may be its first repeat, or a press
    now = 0.9 + 0.25
    for _ in range(30):
        windows.again(trace, now)
        now += 0.033
    assert windows.first == pytest.approx(0.3875)


@given(st.lists(st.floats(REPEAT_GAP + 0.01, 3.0), max_size=60))
def test_taps_never_make_the_window_longer(pauses: list[float]) -> None:
    windows = RepeatWindows()
    now, until, trace = 0.0, 0.0, windows.press(None, 0.0)
    for pause in pauses:
        now += pause
        if now < until:
            until = now + windows.again(trace, now)
        else:
            trace = windows.press(trace, now)
            until = now + windows.first
        assert windows.first == FIRST


def test_two_quick_taps_are_no_repeat_delay() -> None:
    windows = RepeatWindows()
    for start in range(10):
        hold(windows, float(start), delay=0.1, gap=0.09, repeats=3)
    assert windows.first == FIRST


def test_another_keyboard_with_a_longer_delay_is_learned_again() -> None:
    windows = RepeatWindows()
    for start in range(5):
        hold(windows, float(start), delay=0.25, gap=0.033)
    assert windows.first < 0.4
    given_up = windows.press(None, 100.0)
    late = windows.press(given_up, 100.66)  # the first repeat came after the window: it looks like a press
    windows.again(late, 100.70)
    assert windows.first == FIRST


def test_the_learned_first_window_has_a_floor() -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=0.2, gap=0.03)
    assert windows.first == FIRST_SHORTEST
