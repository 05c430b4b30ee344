"""Keys and time to axes: no drive outlives its key by more than the bound that the screen shows."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from dialects.axes import NEUTRAL, Axes
from groundstation.input.key_repeat import PRESS_WINDOW
from groundstation.input.sticks import Sticks
from groundstation.input.style import Style
from groundstation.intents.driving import DriveKeyDown, StepLimits

I = DriveKeyDown(key="i", throttle=1, steering=0)  # noqa: E741
COMMA = DriveKeyDown(key="comma", throttle=-1, steering=0)
J = DriveKeyDown(key="j", throttle=0, steering=-1)
L = DriveKeyDown(key="l", throttle=0, steering=1)
U = DriveKeyDown(key="u", throttle=1, steering=-1)


def repeat(push: DriveKeyDown) -> DriveKeyDown:
    return DriveKeyDown(key=push.key, throttle=push.throttle, steering=push.steering, repeat=True)


def hold(
    sticks: Sticks, push: DriveKeyDown, start: float, until: float, *, delay: float = 0.5, gap: float = 0.04
) -> float:
    """What a terminal without releases sends for a held key; returns the time of the last event."""
    sticks.press(push, start)
    now = start + delay
    last = start
    while now < until:
        sticks.press(push, now)
        last, now = now, now + gap
    return last


def exact(style: Style = Style.HOLD, limit: float = 1.0) -> Sticks:
    sticks = Sticks(style, limit)
    sticks.set_reports_releases()
    return sticks


# ---- after the key gate was closed ----


def test_a_drive_key_delays_others_for_the_longest_repeat_delay() -> None:
    sticks = Sticks(limit=1.0)
    sticks.reject(I, 1.0)
    sticks.require_quiet()
    sticks.press(J, 1.7)
    assert sticks.axes(1.71) == NEUTRAL
    assert sticks.held_over(1.71)
    sticks.press(J, 2.44)
    assert sticks.axes(2.45) == NEUTRAL
    assert not sticks.held_over(3.20)
    sticks.press(J, 3.20)
    assert sticks.axes(3.21) == Axes(0.0, -1.0)
    sticks.press(L, 3.22)
    assert sticks.axes(3.23) == Axes(0.0, 1.0)


def test_a_key_long_after_the_last_one_drives_at_once() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 1.0)
    sticks.require_quiet()
    sticks.stop()
    sticks.press(I, 1.76)
    assert sticks.axes(1.77) == Axes(1.0, 0.0)


def test_with_releases_new_press_drives_at_once_and_a_repeat_not() -> None:
    sticks = exact()
    sticks.press(I, 1.0)
    sticks.block(1.1)
    sticks.require_quiet()
    sticks.press(repeat(I), 1.2)
    assert sticks.axes(1.21) == NEUTRAL
    sticks.press(J, 1.22)
    assert sticks.axes(1.23) == Axes(0.0, -1.0)


# ---- hold, by timers ----


def test_neutral_without_keys() -> None:
    assert Sticks().axes(5.0) == NEUTRAL


def test_a_tap_drives_for_the_first_window_only() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 1.0)
    assert sticks.axes(1.74) == Axes(1.0, 0.0)
    assert sticks.axes(1.75) == NEUTRAL


def test_a_repeating_key_stops_soon_after_its_last_event() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 1.0)
    sticks.press(I, 1.66)
    sticks.press(I, 1.70)
    assert sticks.axes(1.89) == Axes(1.0, 0.0)
    assert sticks.axes(1.90) == NEUTRAL


@pytest.mark.parametrize(("delay", "gap"), [(0.66, 0.04), (0.40, 0.025), (0.50, 0.033), (0.25, 0.092)])
def test_no_false_stop_on_the_keyboards_that_exist(delay: float, gap: float) -> None:
    sticks = Sticks(limit=1.0)
    start = 0.0
    for _ in range(5):
        sticks.press(I, start)
        due = start + delay
        moments = [start + 0.01 * step for step in range(1, 200)]
        for now in moments:
            if now >= due:
                sticks.press(I, now)
                due += gap
            assert sticks.axes(now) == Axes(1.0, 0.0), f"stuttered at {now - start:.2f} s"
        assert sticks.axes(moments[-1] + 0.26) == NEUTRAL
        start += 4.0


def false_stops(sticks: Sticks, start: float, delay: float, gap: float) -> int:
    """How often the drive breaks off while a key is held for 3 s."""
    sticks.press(I, start)
    due, drove, stops = start + delay, True, 0
    for step in range(1, 300):
        now = start + 0.01 * step
        if now >= due:
            sticks.press(I, now)
            due += gap
        drives = not sticks.axes(now).neutral
        stops += drove and not drives
        drove = drives
    return stops


def test_the_longest_repeat_delay_stops_the_first_hold_only() -> None:
    sticks = Sticks(limit=1.0)
    assert [false_stops(sticks, 5.0 * number, 1.0, 0.033) for number in range(4)] == [1, 0, 0, 0]
    assert sticks.stop_bound == pytest.approx(1.1)
    sticks.press(I, 100.0)
    assert sticks.axes(101.09) == Axes(1.0, 0.0)
    assert sticks.axes(101.1) == NEUTRAL, "a tap drives as long as the screen says, and no longer"
    assert false_stops(sticks, 110.0, 0.25, 0.033) == 0


def test_a_second_stick_is_a_chord_and_keeps_the_first_alive() -> None:
    sticks = Sticks(limit=1.0)
    hold(sticks, I, 0.0, 1.0)
    last = hold(sticks, J, 1.0, 3.0)  # `i` is still down but only the newest key repeats
    assert sticks.axes(last) == Axes(1.0, -1.0)
    assert sticks.axes(last + 0.26) == NEUTRAL


def test_a_new_key_on_the_same_stick_replaces_the_old_one() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 0.0)
    sticks.press(COMMA, 0.1)
    assert sticks.axes(0.2) == Axes(-1.0, 0.0)
    assert sticks.held_keys(0.2) == ("comma",)


def test_sliding_from_the_diagonal_to_straight_drops_the_turn() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(U, 0.0)
    assert sticks.axes(0.1) == Axes(1.0, -1.0)
    sticks.press(I, 0.2)
    assert sticks.axes(0.3) == Axes(1.0, 0.0)


def test_stop_is_neutral_and_the_next_press_drives() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 0.0)
    sticks.stop()
    assert sticks.axes(0.01) == NEUTRAL
    sticks.press(I, 0.02)
    assert sticks.axes(0.03) == Axes(1.0, 0.0)


def test_a_blocked_key_that_goes_on_repeating_does_not_drive() -> None:
    sticks = Sticks(limit=1.0)
    last = hold(sticks, I, 0.0, 1.0)
    sticks.block(1.0)
    for step in range(1, 50):
        sticks.press(I, last + 0.04 * step)
        assert sticks.axes(last + 0.04 * step) == NEUTRAL
    sticks.press(I, last + 2.0 + 0.5)  # let go and pressed anew
    assert sticks.axes(last + 2.51) == Axes(1.0, 0.0)


def test_a_key_pressed_while_driving_was_barred_must_be_let_go() -> None:
    sticks = Sticks(limit=1.0)
    sticks.reject(I, 0.0)
    sticks.press(I, 0.66)
    sticks.press(I, 0.70)
    assert sticks.axes(0.71) == NEUTRAL
    sticks.press(I, 1.5)
    assert sticks.axes(1.51) == Axes(1.0, 0.0)


# ---- hold, exact ----


def test_exact_key_drives_until_its_release_without_any_timer() -> None:
    sticks = exact()
    sticks.press(I, 0.0)
    assert sticks.axes(60.0) == Axes(1.0, 0.0)
    sticks.release("i")
    assert sticks.axes(60.0) == NEUTRAL


def test_exact_chords_and_releases_in_any_order() -> None:
    sticks = exact()
    sticks.press(I, 0.0)
    sticks.press(J, 1.0)
    assert sticks.axes(2.0) == Axes(1.0, -1.0)
    sticks.release("i")
    assert sticks.axes(3.0) == Axes(0.0, -1.0)
    sticks.press(L, 4.0)
    assert sticks.axes(4.0) == Axes(0.0, 1.0), "of keys that disagree the newest wins"
    sticks.release("l")
    assert sticks.axes(5.0) == Axes(0.0, -1.0)


def test_a_release_proves_exactness_and_so_does_a_repeat() -> None:
    released, repeated = Sticks(limit=1.0), Sticks(limit=1.0)
    for sticks in (released, repeated):
        sticks.press(I, 0.0)
        assert not sticks.reports_releases
    released.release("i")
    repeated.press(repeat(I), 0.1)
    assert released.reports_releases
    assert repeated.reports_releases


def test_a_key_pressed_before_exactness_was_proved_ends_by_timer() -> None:
    sticks = Sticks(limit=1.0)
    sticks.press(I, 0.0)
    sticks.set_reports_releases()
    sticks.press(J, 0.1)
    assert sticks.axes(0.5) == Axes(1.0, -1.0)
    assert sticks.axes(0.8) == Axes(0.0, -1.0), "its release may have been before the proof"


def test_a_repeat_of_a_key_that_is_not_down_is_ignored() -> None:
    sticks = exact()
    sticks.press(repeat(I), 0.0)
    assert sticks.axes(0.01) == NEUTRAL


def test_a_blocked_exact_key_needs_a_release() -> None:
    sticks = exact()
    sticks.press(I, 0.0)
    sticks.block(1.0)
    sticks.press(repeat(I), 1.1)
    assert sticks.axes(1.2) == NEUTRAL
    sticks.release("i")
    sticks.press(I, 1.3)
    assert sticks.axes(1.4) == Axes(1.0, 0.0)


# ---- latch and step ----


def test_latch_drives_until_the_next_key() -> None:
    sticks = Sticks(Style.LATCH, 0.5)
    sticks.press(U, 0.0)
    assert sticks.axes(100.0) == Axes(0.5, -0.5)
    sticks.press(I, 100.0)
    assert sticks.axes(200.0) == Axes(0.5, 0.0)
    sticks.release("i")
    assert sticks.axes(200.0) == Axes(0.5, 0.0)
    sticks.stop()
    assert sticks.axes(200.0) == NEUTRAL


def test_step_adds_10_percent_press_and_a_held_key_is_one_press() -> None:
    sticks = Sticks(Style.STEP, 1.0)
    hold(sticks, I, 0.0, 2.0, delay=0.1, gap=0.04)
    assert sticks.axes(3.0) == Axes(0.1, 0.0)
    for step in range(3):
        sticks.press(I, 3.0 + step)
    assert sticks.axes(7.0).throttle == pytest.approx(0.4)
    sticks.press(COMMA, 8.0)
    assert sticks.axes(9.0).throttle == pytest.approx(0.3)


def test_step_stays_within_the_limit() -> None:
    sticks = Sticks(Style.STEP, 0.5)
    for step in range(20):
        sticks.press(I, float(step))
    assert sticks.axes(30.0) == Axes(0.5, 0.0)
    sticks.press(COMMA, 31.0)
    assert sticks.axes(32.0) == Axes(0.4, 0.0), "the limit is not a rubber band"


# ---- limits and styles ----


def test_speed_never_moves_and_stays_in_its_range() -> None:
    sticks = Sticks(limit=0.6)
    for _ in range(50):
        sticks.step_limits(StepLimits(throttle=0.1, steering=-0.1))
        assert sticks.axes(0.0) == NEUTRAL
    assert (sticks.throttle_limit, sticks.steering_limit) == (1.0, 0.1)


@pytest.mark.parametrize("factor", [0.0, math.nan, math.inf, -math.inf])
def test_senseless_changes_change_nothing(factor: float) -> None:
    sticks = Sticks(limit=0.6)
    sticks.step_limits(StepLimits(throttle=factor, steering=factor))
    assert (sticks.throttle_limit, sticks.steering_limit) == (0.6, 0.6)


def test_speed_keys_that_undo_each_other_leave_no_trace() -> None:
    sticks = Sticks(limit=0.6)
    for change in (0.1, 0.1, 0.1, -0.1, -0.1, -0.1):
        sticks.step_limits(StepLimits(throttle=change))
        assert round(sticks.throttle_limit * 100) % 10 == 0
    assert (sticks.throttle_limit, sticks.steering_limit) == (0.6, 0.6)


def test_changing_the_style_stops() -> None:
    sticks = Sticks(Style.LATCH, 1.0)
    sticks.press(I, 0.0)
    assert sticks.axes(1.0) != NEUTRAL
    assert sticks.set_style("hold")
    assert sticks.axes(1.0) == NEUTRAL


def test_next_style_wraps_and_an_unknown_style_only_stops() -> None:
    sticks = Sticks()
    seen = []
    for _ in range(3):
        sticks.set_style("next")
        seen.append(sticks.style)
    assert seen == [Style.LATCH, Style.STEP, Style.HOLD]
    assert not sticks.set_style("fly")
    assert sticks.style is Style.HOLD


def test_stop_bound_is_what_the_screen_promises() -> None:
    assert Sticks().stop_bound == 0.75
    assert exact().stop_bound == 0.0
    assert Sticks(Style.LATCH).stop_bound == math.inf


# ---- whatever is typed ----

_KEYS = st.sampled_from([I, COMMA, J, L, U])
_EVENTS = st.lists(st.tuples(_KEYS, st.floats(0.0, 1.5)), max_size=60)


@given(_EVENTS)
@example(
    [(I, 0.0), (I, 0.5), (J, 0.0), (I, 0.0)]
)  # the last one teaches a shorter window while `j` is held by the longer
@settings(max_examples=300)
def test_timer_drive_ends_within_the_bound_of_its_last_event(
    events: list[tuple[DriveKeyDown, float]],
) -> None:
    sticks, now = Sticks(limit=1.0), 0.0
    for push, pause in events:
        bound = sticks.stop_bound
        assert bound <= 0.75
        now += pause
        if pause >= bound:
            assert sticks.axes(now) == NEUTRAL
        sticks.press(push, now)
    assert sticks.axes(now + sticks.stop_bound + 1e-9) == NEUTRAL


@given(st.lists(st.tuples(_KEYS, st.booleans(), st.floats(0.0, 1.0)), max_size=60), st.sampled_from(list(Style)))
@settings(max_examples=300)
def test_whatever_came_before_stop_is_neutral_and_limits_hold(
    events: list[tuple[DriveKeyDown, bool, float]], style: Style
) -> None:
    sticks, now = Sticks(style, 0.5), 0.0
    for push, release, pause in events:
        now += pause
        if release:
            sticks.release(push.key)
        else:
            sticks.press(push, now)
        axes = sticks.axes(now)
        assert abs(axes.throttle) <= 0.5
        assert abs(axes.steering) <= 0.5
    sticks.stop()
    assert sticks.axes(now) == NEUTRAL
    assert sticks.axes(now + 10.0) == NEUTRAL


@given(st.lists(st.tuples(_KEYS, st.booleans(), st.floats(0.0, 1.0)), max_size=40))
def test_exact_keys_are_neutral_when_all_are_released(events: list[tuple[DriveKeyDown, bool, float]]) -> None:
    sticks, now = exact(), 0.0
    for push, release, pause in events:
        now += pause
        if release:
            sticks.release(push.key)
        else:
            sticks.press(push, now)
    for push in (I, COMMA, J, L, U):
        sticks.release(push.key)
    assert sticks.axes(now) == NEUTRAL


def test_a_key_that_comes_without_releases_ends_by_timer() -> None:
    """An arrow has proved releases, and a letter of the same terminal comes as plain text."""
    sticks = exact()
    sticks.set_reports_releases(False)
    sticks.press(I, 0.0)
    assert sticks.axes(0.1) != NEUTRAL
    assert sticks.axes(sticks.stop_bound) == NEUTRAL
    sticks.press(I, 10.0)
    sticks.set_reports_releases()
    assert sticks.changes_at(10.0) == pytest.approx(10.0 + PRESS_WINDOW)
    assert sticks.axes(10.0 + PRESS_WINDOW) == NEUTRAL, "an arrow that follows does not make it endless"
