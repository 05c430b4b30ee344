"""The windows that a keyboard teaches."""

from __future__ import annotations

import pytest

from groundstation.repeat import FIRST, FIRST_SHORTEST, LATER, LATER_LONGEST, LATER_SHORTEST, RepeatWindows, Trace


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
        (1.00, 0.110, FIRST, LATER_LONGEST),
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
