"""The clock of signatures: forward with the computer's clock, never back, and through a boot in 1970."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from link.signing.clock import PLAUSIBLE, TICKS, SigningClock, to_stamp
from tests.link.signing.signed import DAY, NOON, NOW


def test_timestamps_are_10_us_since_2015() -> None:
    assert to_stamp(1_420_070_400.0) == 0
    assert to_stamp(1_420_070_401.5) == 150_000
    assert to_stamp(0.0) == 0
    assert (100_000, to_stamp(1_767_225_600.0)) == (TICKS, PLAUSIBLE)


def test_it_advances_with_time_and_not_with_frames() -> None:
    """QGroundControl and pymavlink counted up by one a frame, and were refused after a while."""
    clock = SigningClock(NOON, 100.0)
    assert clock.stamp(100.5) == NOW + 50_000
    assert clock.trusted


def test_a_clock_set_forward_is_followed_and_one_set_back_is_not() -> None:
    clock = SigningClock(NOON, 0.0)
    clock.update(NOON - 3600.0, 1.0)
    assert clock.stamp(1.0) == NOW + TICKS
    assert clock.ahead(1.0) == 3601.0
    clock.update(NOON + 3600.0, 2.0)
    assert clock.stamp(2.0) == NOW + 3600 * TICKS
    assert clock.ahead(2.0) == 0.0


def test_a_restart_with_a_right_clock_does_not_run_ahead_of_it() -> None:
    """Sixty seconds at each restart would lock ground stations out after ten of them."""
    for _ in range(3):
        clock = SigningClock(NOON, 0.0, stored=NOW)
        assert clock.stamp(0.0) == NOW


def test_a_clock_behind_the_stored_time_is_not_trusted() -> None:
    for wall in (0.0, NOON - 86_400.0):
        clock = SigningClock(wall, 0.0, stored=NOW)
        assert not clock.trusted
        assert clock.stamp(0.0) == NOW + 60 * TICKS


def test_the_right_time_is_known_when_the_system_says_so() -> None:
    assert not SigningClock(NOON, 0.0).synchronized
    assert SigningClock(NOON, 0.0, synchronized=True).synchronized
    assert not SigningClock(10.0, 0.0, synchronized=True).synchronized
    assert not SigningClock(NOON, 0.0, stored=NOW + DAY, synchronized=True).synchronized
    clock = SigningClock(10.0, 0.0, stored=NOW - DAY)
    for wall, synchronized, known in ((NOON + 1.0, False, False), (NOON + 2.0, True, True), (NOON - 3.0, True, False)):
        clock.update(wall, abs(wall - NOON), synchronized=synchronized)
        assert clock.synchronized is known


@given(st.lists(st.tuples(st.floats(0.0, 100.0), st.floats(-1e9, 3e9), st.booleans()), max_size=20))
def test_it_never_goes_back(steps: list[tuple[float, float, bool]]) -> None:
    clock, now, last = SigningClock(NOON, 0.0), 0.0, 0
    for pause, wall, synchronized in steps:
        now += pause
        assert clock.stamp(now) >= last
        clock.update(wall, now, synchronized=synchronized)
        assert clock.stamp(now) >= last
        last = clock.stamp(now)
