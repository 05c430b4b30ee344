"""`mavhelm turn`: a turn by an angle. With our vehicle: test_every_verb.py and tests/e2e/test_rover_programs.py."""

from __future__ import annotations

import argparse

import pytest

from dialects.axes import NEUTRAL
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.control.turn import LEAST, Turn, angle, rate
from tests.fakes.services import ARDUPILOT, foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_demanding


@pytest.mark.parametrize(
    ("degrees", "headings", "turned"),
    [
        (90, (10, 50, 100), 90),
        (-90, (350, 300, 260), -90),
        (90, (350, 10, 80), 90),  # over north
        (-30, (10, 350, 340), -30),
        (360, (0, 120, 240, 359, 0.5), 360.5),
    ],
)
def test_it_ends_when_the_heading_has_changed_by_the_angle(
    degrees: float, headings: tuple[float, ...], turned: float
) -> None:
    turn = Turn(degrees, 0.4, headings[0])
    for each in headings[1:]:
        assert turn.left > 0
        assert turn.axes.steering * degrees > 0
        assert turn.axes.throttle == 0
        turn.update(each)
    assert turn.left <= 0
    assert turn.axes == NEUTRAL
    assert turn.turned == pytest.approx(turned)


def test_the_demand_shrinks_towards_the_end() -> None:
    turn = Turn(90, 0.4, 0)
    assert turn.axes.steering == pytest.approx(0.4)
    turn.update(70)
    assert turn.axes.steering == pytest.approx(0.2)
    turn.update(89.9)
    assert turn.axes.steering == pytest.approx(0.4 * LEAST)


def test_turning_the_wrong_way_first_is_made_up_for() -> None:
    turn = Turn(20, 0.4, 0)
    turn.update(350)
    assert turn.left == pytest.approx(30)
    assert turn.axes.steering > 0


@pytest.mark.parametrize("text", ["0", "361", "-361", "nan", "inf", "right"])
def test_an_angle_that_cannot_be(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=text):
        angle(text)


@pytest.mark.parametrize("text", ["0", "-1", "101", "nan"])
def test_a_demand_that_cannot_be(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=text):
        rate(text)
    assert rate("40%") == 40


def test_a_vehicle_that_does_not_turn_or_has_no_heading() -> None:
    with foreign_vehicle(ARDUPILOT) as vehicle:
        disarmed = run_demanding("turn", "90", "-e", vehicle.endpoint, "-v", "1")
        assert (disarmed.code, "is disarmed" in disarmed.err) == (ExitCode.REFUSED, True), disarmed.err
        vehicle.armed = True
        blind = run_demanding("turn", "90", "-e", vehicle.endpoint, "-v", "1")
        assert (blind.code, "reports no heading" in blind.err) == (ExitCode.REFUSED, True), blind.err
        assert [each for each in vehicle.of("MANUAL_CONTROL") if (each.y, each.z, each.r) != (0, 0, 0)] == []
