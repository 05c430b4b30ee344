"""Exact ends of the timers of keys and gamepad, each in a few events."""

from __future__ import annotations

import pytest

from dialects.axes import NEUTRAL, Axes
from groundstation.input.key_repeat import KeyTrace, RepeatWindows
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown, DrivePad, StepLimits
from tests.groundstation.input.test_sticks import COMMA, I, J, L, exact, repeat


def timed(style: Style = Style.HOLD) -> Sticks:
    """Sticks of a terminal without releases."""
    return Sticks(style, 1.0)


def press(sticks: Sticks, push: DriveKeyDown, *times: float) -> None:
    for at in times:
        assert sticks.press(push, at)


def learned(delay: float) -> Sticks:
    """Sticks that have learned the delay of a keyboard, at 2 s."""
    sticks = timed()
    press(sticks, J, 0.0, delay, *(delay + number * 0.04 for number in range(1, 7)))
    assert sticks.stop_bound == pytest.approx(min(max(1.15 * delay + 0.1, 0.35), 1.1))
    sticks.stop()
    return sticks


# ---- keys ----


def test_what_a_press_returns() -> None:
    sticks = timed()
    assert sticks.press(DriveKeyDown(key="k", throttle=0, steering=0), 0.0)
    assert sticks.axes(0.0) == NEUTRAL
    assert sticks.press(I, 0.0)
    sticks.reject(J, 0.1)
    assert not sticks.press(J, 0.2)


def test_a_first_event_counts_for_750_ms_and_a_repeat_for_200() -> None:
    sticks = timed()
    press(sticks, I, 0.0)
    assert sticks.axes(0.749) == Axes(1.0, 0.0)
    assert sticks.held_keys(0.75) == ()
    press(sticks, I, 2.0, 2.5, 2.54)
    assert sticks.axes(2.739) == Axes(1.0, 0.0)
    assert sticks.axes(2.741) == NEUTRAL


def test_the_next_change_is_that_of_the_first_timer() -> None:
    sticks = timed()
    assert sticks.changes_at(0.0) is None
    press(sticks, I, 0.0)
    assert sticks.changes_at(0.1) == 0.75
    press(sticks, I, 0.5)
    assert sticks.changes_at(0.5) == 0.7
    released = exact()
    press(released, I, 0.0)
    assert released.changes_at(0.1) is None


def test_a_window_that_was_just_learned_ends_every_key() -> None:
    sticks = timed()
    for push, at in ((I, 0.0), (I, 0.2), (J, 0.21), (I, 0.24)):
        press(sticks, push, at)
    assert sticks.held_keys(0.45) == ("j",)
    assert sticks.changes_at(0.45) == 0.24 + 0.35
    assert sticks.held_keys(0.24 + 0.35) == ()


def test_the_other_stick_is_held_as_long_as_its_own_timer() -> None:
    sticks = timed()
    for push, at in ((J, 0.0), (I, 0.1), (I, 0.6)):
        press(sticks, push, at)
    assert sticks.axes(0.7) == Axes(1.0, -1.0)
    assert sticks.axes(0.82) == Axes(0.0, -1.0)
    assert sticks.axes(0.86) == NEUTRAL


@pytest.mark.parametrize(
    ("first", "second", "held"),
    [(I, COMMA, ("comma",)), (J, L, ("l",)), (J, I, ("j", "i")), (I, J, ("i", "j"))],
)
def test_a_key_replaces_those_of_its_stick(first: DriveKeyDown, second: DriveKeyDown, held: tuple[str, ...]) -> None:
    sticks = timed()
    press(sticks, first, 0.0)
    press(sticks, second, 0.1)
    assert sticks.held_keys(0.2) == held
    assert sticks.axes(0.2) == Axes(float(second.throttle or first.throttle), float(second.steering or first.steering))


def test_a_held_key_that_repeats_is_prolonged_and_no_other() -> None:
    sticks = timed()
    assert not sticks.prolong(I, 0.0)
    press(sticks, I, 0.0)
    assert sticks.prolong(I, 0.5)
    assert sticks.axes(0.69) == Axes(1.0, 0.0)
    assert not sticks.prolong(I, 0.8), "its timer has ended"
    press(sticks, I, 1.0)
    assert not sticks.prolong(repeat(I), 1.1), "it proves that releases are reported"
    assert not sticks.prolong(DriveKeyDown(key="i", throttle=-1, steering=0), 1.1)
    sticks.reject(I, 1.1)
    assert not sticks.prolong(I, 1.2)
    released = exact()
    press(released, I, 0.0)
    assert released.prolong(repeat(I), 0.5)
    waiting = timed()
    press(waiting, I, 0.0)
    waiting.require_quiet()
    assert not waiting.prolong(I, 0.5)


# ---- what was held before ----


def test_a_key_that_was_blocked_counts_again_after_its_window() -> None:
    for times, until in (((0.0,), 0.85), ((0.0, 0.5, 0.54), 0.74)):
        for late, drives in ((-0.01, False), (0.0, True)):
            sticks = timed()
            press(sticks, I, *times)
            sticks.block(times[-1] + 0.1 if len(times) == 1 else 0.54)
            at = until + late + (1e-9 if drives else 0.0)
            assert sticks.press(I, at) is drives


def test_a_rejected_key_counts_again_at_the_end_of_its_window() -> None:
    for at, drives in ((1.74, False), (1.75, True)):
        sticks = timed()
        sticks.reject(I, 1.0)
        assert sticks.press(I, at) is drives


def test_with_releases_a_blocked_key_counts_with_its_next_press() -> None:
    sticks = exact()
    press(sticks, I, 0.0)
    sticks.block(0.1)
    assert not sticks.press(repeat(I), 0.15)
    assert sticks.press(I, 0.2)


def test_quiet_lasts_750_ms_or_longer_for_a_slow_keyboard() -> None:
    for sticks, until in ((timed(), 0.75), (learned(0.2), 0.75), (learned(1.0), 1.1)):
        sticks.reject(L, 64.0)
        sticks.require_quiet()
        assert sticks.held_over(64.0 + until - 0.01)
        assert not sticks.held_over(64.0 + until + 1e-9)
    exactly = timed()
    exactly.reject(L, 1.0)
    exactly.require_quiet()
    assert not exactly.held_over(1.75)


def test_before_any_key_nothing_repeats() -> None:
    sticks = timed()
    sticks.require_quiet()
    assert not sticks.held_over(0.0)


def test_another_keyboard_is_a_new_one() -> None:
    sticks = exact()
    press(sticks, I, 0.0)
    sticks.change_keyboard(10.0, reports_releases=True)
    assert sticks.axes(10.0) == NEUTRAL
    slow = learned(1.0)
    slow.reject(I, 20.0)
    slow.change_keyboard(20.0, reports_releases=False)
    assert slow.stop_bound == 0.75
    assert slow.press(I, 20.8), "neither blocked by the keyboard before, nor quiet for as long as that"
    fresh = timed()
    fresh.change_keyboard(10.0, reports_releases=False)
    assert not fresh.press(I, 10.5), "it may be held there"
    assert fresh.press(I, 11.3)


def test_another_keyboard_does_not_go_on_with_a_press() -> None:
    sticks = timed()
    press(sticks, I, 0.0)
    sticks.change_keyboard(0.1, reports_releases=False)
    press(sticks, I, 1.0, *(1.04 + number * 0.04 for number in range(8)))
    assert sticks.stop_bound == 0.75, "the second was not a repeat after 1 s"


# ---- styles and gamepad ----


def test_the_usual_limit_is_60_percent() -> None:
    assert (Sticks().throttle_limit, Sticks().steering_limit) == (0.6, 0.6)


def test_blocked_and_changed_styles_are_neutral() -> None:
    sticks = timed(Style.LATCH)
    press(sticks, I, 0.0)
    sticks.block(0.1)
    assert sticks.axes(0.1) == NEUTRAL
    press(sticks, J, 1.0)
    assert sticks.set_style("step")
    assert (sticks.style, sticks.axes(1.0)) == (Style.STEP, NEUTRAL)


def test_a_step_is_one_press_however_long_it_is_held() -> None:
    sticks = timed(Style.STEP)
    press(sticks, I, 0.0, 0.12)
    assert sticks.axes(0.2) == Axes(0.1, 0.0)
    press(sticks, I, 0.25)
    assert sticks.axes(0.3) == Axes(0.2, 0.0)
    released = exact(Style.STEP)
    press(released, I, 0.0)
    press(released, repeat(I), 0.5)
    assert released.axes(0.6) == Axes(0.1, 0.0)


def test_steps_have_two_digits_and_end_at_the_limit() -> None:
    sticks = Sticks(Style.STEP, 0.655)
    for number in range(20):
        press(sticks, COMMA, float(number))
    assert sticks.axes(20.0) == Axes(-0.655, 0.0)
    press(sticks, I, 30.0)
    assert sticks.axes(30.0).throttle in (-0.55, -0.56)
    press(sticks, I, 31.0)
    assert sticks.axes(31.0).throttle in (-0.45, -0.46)


def test_the_gamepad_drives_until_its_reading_is_old() -> None:
    sticks = timed()
    press(sticks, I, 9.9)
    assert sticks.push_pad(DrivePad(0.5, 0.0, 10.0), 10.0)
    assert sticks.changes_at(10.1) == 10.25
    assert sticks.axes(10.1) == Axes(0.5, 0.0)
    assert sticks.held_keys(10.1) == ("gamepad",)
    assert not sticks.push_pad(DrivePad(0.5, 0.0, 10.0, repeat=True), 10.3)
    assert sticks.axes(10.3) == NEUTRAL


# ---- what is learned of a keyboard ----


def test_one_repeat_shows_that_a_key_is_held() -> None:
    assert not KeyTrace(0.0, 0.0).repeating
    assert KeyTrace(0.0, 0.0, repeats=1).repeating


def test_the_longest_of_20_gaps_decides() -> None:
    windows, trace, now = RepeatWindows(), KeyTrace(0.0, 0.0, delay=0.5), 0.0
    for gap in (*(0.04,) * 10, 0.08, *(0.04,) * 8):
        now += gap
        assert windows.record_repeat(trace, now) == 0.2
    assert windows.record_repeat(trace, now + 0.04) == pytest.approx(0.2)
    trace = KeyTrace(0.0, 0.0, delay=0.5)
    for number in range(1, 21):
        windows.record_repeat(trace, number * 0.04)
    assert windows.repeat_window == 0.12
    for _ in range(5):
        assert windows.record_repeat(trace, trace.seen + 0.06) == pytest.approx(0.15)


def test_a_press_goes_on_with_one_less_than_1100_ms_before() -> None:
    for now, delay in ((1.09, 1.09), (1.1, None), (3.0, None)):
        assert RepeatWindows.start_press(KeyTrace(0.0, 0.0), now).delay == delay
    assert RepeatWindows.start_press(KeyTrace(0.0, 0.5, delay=0.5), 1.0).delay is None
    assert RepeatWindows.start_press(None, 1.0) == KeyTrace(1.0, 1.0)


def test_a_gap_of_120_ms_is_the_longest_first_repeat() -> None:
    for gap, repeats in ((0.12, 1), (0.125, 0)):
        trace = KeyTrace(0.0, 0.0, delay=0.5)
        RepeatWindows().record_repeat(trace, gap)
        assert trace.repeats == repeats
    late = KeyTrace(0.0, 0.0, delay=0.5, repeats=3)
    RepeatWindows().record_repeat(late, 0.2)
    assert late.repeats == 4


@pytest.mark.parametrize(
    ("delay", "repeats", "window"),
    [
        (0.75, 1, 0.75), (0.76, 1, 0.445), (0.76, 4, 0.445), (0.76, 5, 0.974), (1.1, 5, 1.1), (1.11, 9, 0.445),
        (0.2, 1, 0.445), (0.19, 9, 0.445),
    ],
)  # fmt: skip
def test_which_delays_of_a_keyboard_are_learned(delay: float, repeats: int, window: float) -> None:
    """One that is longer than usual needs five repeats; of the newest five the longest decides."""
    windows = RepeatWindows()
    windows.record_repeat(KeyTrace(0.0, 0.0, delay=0.3), 0.04)
    trace = KeyTrace(0.0, 0.0, delay=delay)
    for number in range(1, repeats + 1):
        windows.record_repeat(trace, number * 0.04)
    assert windows.press_window == pytest.approx(window)


def test_the_newest_five_delays_count() -> None:
    windows = RepeatWindows()
    for delay in (0.5, *(0.3,) * 4):
        windows.record_repeat(KeyTrace(0.0, 0.0, delay=delay), 0.04)
    assert windows.press_window == pytest.approx(0.675)
    windows.record_repeat(KeyTrace(0.0, 0.0, delay=0.3), 0.04)
    assert windows.press_window == pytest.approx(0.445)


def test_limits_have_two_digits() -> None:
    sticks = Sticks(Style.HOLD, 0.5)
    sticks.step_limits(StepLimits(throttle=0.05, steering=0.004))
    assert (sticks.throttle_limit, sticks.steering_limit) == (0.55, 0.5)
