"""Bad input 47: setpoints that are old on arrival by the clock of their sender."""

from __future__ import annotations

import pytest

from dialects.enums import Result
from dialects.modes import Mode
from tests.vehicle.bench import said
from tests.vehicle.field import Field
from vehicle.autonomy.setpoints import SenderClock

WRAP = 2**32


def heard(*stamps: tuple[int, float]) -> list[float | None]:
    """Ages of setpoints with these (time_boot_ms, arrival)."""
    clock = SenderClock()
    return [clock.age(boot_ms, now) for boot_ms, now in stamps]


def test_setpoints_in_time_have_no_age_at_any_clock_offset() -> None:
    assert heard((5000, 100.0), (5100, 100.1), (5200, 100.2)) == pytest.approx([0, 0, 0], abs=1e-3)


def test_a_delayed_setpoint_is_as_old_as_its_delay() -> None:
    assert heard((5000, 100.0), (5100, 101.6), (6600, 101.61)) == pytest.approx([0, 1.5, 0.01], abs=2e-3)


def test_age_is_relative_to_the_fastest_setpoint() -> None:
    assert heard((5000, 102.0), (6000, 101.5), (7000, 103.0)) == pytest.approx([0, 0, 0.5], abs=2e-3)


def test_overtaken_setpoints_and_a_restarted_sender() -> None:
    assert heard((5000, 100.0), (4990, 100.01), (10, 100.9), (10, 101.1)) == pytest.approx([0, None, None, 0])


def test_47_setpoints_of_a_stopped_clock_expire() -> None:
    ages = heard((7677, 99.9), *((7777, 100.0 + step / 10) for step in range(20)))
    assert ages[-1] == pytest.approx(1.9, abs=0.01)


def test_a_clock_that_never_ran_has_no_age() -> None:
    ages = heard(*((10, 100.0 + step / 10) for step in range(50)), (5000, 200.0), (5100, 200.5))
    assert ages == pytest.approx([0.0] * 51 + [0.4], abs=0.02), "from then on it is a clock"


def test_ardupilots_example_script_drives() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    for _ in range(60):
        field.twist(0.8, boot_ms=10)
        field.wait(0.05)
        field.heartbeat()
    assert field.speed > 0.7


def test_a_sender_without_a_clock_has_no_age() -> None:
    assert heard(*((0, 100.0 + step) for step in range(20))) == [0.0] * 20


def test_time_boot_ms_wraps_after_49_days() -> None:
    assert heard((WRAP - 50, 100.0), (50, 100.1), (150, 100.2)) == pytest.approx([0, 0, 0], abs=1e-3)


def test_a_slow_clock_is_followed_for_days() -> None:
    clock = SenderClock()
    ages = [clock.age(1 + int(step * 100 * (1 - 1e-4)), step * 0.1) for step in range(0, 2_000_000, 997)]
    assert max(age for age in ages if age is not None) < 0.1


def test_47_setpoints_delayed_by_2_s_do_not_move_the_rover() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    for step in range(20):
        field.twist(0.8, boot_ms=1000 + 50 * step)
        field.wait(0.05)
    assert field.turning
    field.wait(2.5)  # the link is dead; the setpoint is lost
    assert not field.turning
    for step in range(20, 40):  # and gives back what it held
        field.twist(0.8, boot_ms=1000 + 50 * step)
        field.wait(0.01)
        assert not field.turning
    assert said(field, "too old by the clock of its sender")
    for step in range(70, 90):
        field.twist(0.8, boot_ms=1000 + 50 * step)
        field.wait(0.05)
    assert field.turning


def test_choosing_guided_again_resets_the_sender_clock() -> None:
    field = Field()
    field.begin(Mode.GUIDED)
    field.twist(0.8, boot_ms=1000)
    field.wait(0.3)
    assert field.turning
    field.wait(2.0)
    field.twist(0.8, boot_ms=1050)  # the clock of the sender was suspended
    field.wait(0.3)
    assert not field.turning
    assert field.set_mode(Mode.GUIDED) is Result.ACCEPTED
    field.twist(0.8, boot_ms=1400)
    field.wait(0.3)
    assert field.turning
