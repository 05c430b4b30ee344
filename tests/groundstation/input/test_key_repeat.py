"""The windows that a keyboard teaches."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.input.key_repeat import (
    PRESS_WINDOW,
    PRESS_WINDOW_MAX,
    PRESS_WINDOW_MIN,
    REPEAT_GAP,
    REPEAT_WINDOW,
    REPEAT_WINDOW_MAX,
    REPEAT_WINDOW_MIN,
    KeyTrace,
    RepeatWindows,
)


def hold(windows: RepeatWindows, start: float, *, delay: float, gap: float, repeats: int = 30) -> KeyTrace:
    trace = windows.start_press(None, start)
    now = start + delay
    for _ in range(repeats):
        windows.record_repeat(trace, now)
        now += gap
    return trace


def test_defaults_before_anything_is_known() -> None:
    assert (RepeatWindows().press_window, RepeatWindows().repeat_window) == (PRESS_WINDOW, REPEAT_WINDOW)


@pytest.mark.parametrize(
    ("delay", "gap", "first", "later"),
    [
        (0.25, 0.033, 0.3875, REPEAT_WINDOW_MIN),
        (0.50, 0.040, 0.675, REPEAT_WINDOW_MIN),
        (0.66, 0.040, PRESS_WINDOW, REPEAT_WINDOW_MIN),
        (0.25, 0.092, 0.3875, 0.23),
        (0.75, 0.040, PRESS_WINDOW, REPEAT_WINDOW_MIN),
        (0.80, 0.040, 1.02, REPEAT_WINDOW_MIN),
        (1.00, 0.110, PRESS_WINDOW_MAX, REPEAT_WINDOW_MAX),
    ],
)
def test_windows_follow_the_keyboard(delay: float, gap: float, first: float, later: float) -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=delay, gap=gap)
    assert windows.press_window == pytest.approx(first)
    assert windows.repeat_window == pytest.approx(later, abs=1e-6)


def test_taps_teach_nothing() -> None:
    windows = RepeatWindows()
    trace = windows.start_press(None, 0.0)
    for step in range(1, 40):
        windows.record_repeat(trace, step * 0.3)
    assert (windows.press_window, windows.repeat_window) == (PRESS_WINDOW, REPEAT_WINDOW)


def test_a_long_delay_is_believed_only_after_five_repeats() -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=1.0, gap=0.04, repeats=5)  # the first event after the delay is none yet
    assert windows.press_window == PRESS_WINDOW
    hold(windows, 10.0, delay=1.0, gap=0.04, repeats=6)
    assert windows.press_window == PRESS_WINDOW_MAX


def test_a_tap_before_a_hold_is_no_long_delay() -> None:
    windows = RepeatWindows()
    tapped = windows.start_press(None, 0.0)
    trace = windows.start_press(tapped, 0.9)  # the tap was given up at 0.75: this may be its first repeat, or a press
    now = 0.9 + 0.25
    for _ in range(30):
        windows.record_repeat(trace, now)
        now += 0.033
    assert windows.press_window == pytest.approx(0.3875)


@given(st.lists(st.floats(REPEAT_GAP + 0.01, 3.0), max_size=60))
def test_taps_never_make_the_window_longer(pauses: list[float]) -> None:
    windows = RepeatWindows()
    now, until, trace = 0.0, 0.0, windows.start_press(None, 0.0)
    for pause in pauses:
        now += pause
        if now < until:
            until = now + windows.record_repeat(trace, now)
        else:
            trace = windows.start_press(trace, now)
            until = now + windows.press_window
        assert windows.press_window == PRESS_WINDOW


def test_two_quick_taps_are_no_repeat_delay() -> None:
    windows = RepeatWindows()
    for start in range(10):
        hold(windows, float(start), delay=0.1, gap=0.09, repeats=3)
    assert windows.press_window == PRESS_WINDOW


def test_another_keyboard_with_a_longer_delay_is_learned_again() -> None:
    windows = RepeatWindows()
    for start in range(5):
        hold(windows, float(start), delay=0.25, gap=0.033)
    assert windows.press_window < 0.4
    given_up = windows.start_press(None, 100.0)
    late = windows.start_press(given_up, 100.66)  # the first repeat came after the window: it looks like a press
    windows.record_repeat(late, 100.70)
    assert windows.press_window == PRESS_WINDOW


def test_the_learned_first_window_has_a_floor() -> None:
    windows = RepeatWindows()
    hold(windows, 0.0, delay=0.2, gap=0.03)
    assert windows.press_window == PRESS_WINDOW_MIN
