"""Autonomous modes stop before the fence, in a simulated field."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import DriveLimit, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, said
from tests.vehicle.field import Field
from tests.vehicle.missions import Item, finish, ready, start, upload, way
from tests.vehicle.navigation.test_fence import square
from vehicle.navigation.geo import Point

SHAPES: dict[str, list[Item]] = {
    "inclusion polygon": square(FenceItem.POLYGON_INCLUSION, -5, -5, 11),
    "exclusion polygon": square(FenceItem.POLYGON_EXCLUSION, 6, -3, 6),
    "inclusion circle": [(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (6,))],
    "exclusion circle": [(FenceItem.CIRCLE_EXCLUSION, Point(9, 0), (3,))],
}
"""Each has its edge 6 m north of home."""
EDGE = 6.0


def fenced(items: list[Item], **params: float) -> Field:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=4, **params)  # type: ignore[arg-type]
    assert upload(field, *items, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    return field


@pytest.mark.parametrize("items", SHAPES.values(), ids=SHAPES.keys())
def test_a_velocity_toward_the_fence_stops_before_it(items: list[Item]) -> None:
    field = fenced(items)
    field.begin(Mode.GUIDED)
    field.stream(3.0, 0.8)
    assert field.speed > 0.6
    field.stream(12.0, 0.8)
    assert field.truth.north == pytest.approx(EDGE - 1.0, abs=0.6)
    assert abs(field.speed) < 0.05
    assert field.mode is Mode.GUIDED
    field.wait(0.2)
    assert field.newest(m.RoverDriveStatus).limits & DriveLimit.FENCE
    field.stream(6.0, -0.5)  # and back it may go at once
    assert field.truth.north < EDGE - 2.5
    assert not field.newest(m.RoverDriveStatus).limits & DriveLimit.FENCE


def test_fence_avoidance_stops_backward_motion() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))])
    field.begin(Mode.GUIDED)
    field.stream(14.0, -0.8)
    assert field.truth.north == pytest.approx(-4.0, abs=0.6)


@pytest.mark.parametrize("params", [{"AVOID_ENABLE": 0}, {"FENCE_ACTION": 0}])
def test_fence_avoidance_can_be_disabled(params: dict[str, float]) -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], **params)
    field.begin(Mode.GUIDED)
    field.stream(12.0, 0.8)
    assert field.truth.north > 5.0
    assert said(field, "outside the fence")


@pytest.mark.parametrize(("margin", "north"), [(0, 5.0), (2, 3.0)])
def test_the_margin_is_a_parameter(margin: float, north: float) -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], FENCE_MARGIN=margin)
    field.begin(Mode.GUIDED)
    field.stream(12.0, 0.8)
    assert field.truth.north == pytest.approx(north, abs=0.6)


def test_manual_mode_is_not_limited_by_fence_avoidance() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))])
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(6.0, AHEAD)
    assert field.truth.north > 4.8
    assert said(field, "outside the fence: HOLD")


@pytest.mark.parametrize(
    ("place", "why"),
    [(Point(8, 0), "outside the fence"), (Point(5.5, 0), "closer to the fence than FENCE_MARGIN")],
)
def test_places_outside_the_fence_are_rejected(place: Point, why: str) -> None:
    field = fenced(SHAPES["inclusion circle"])
    field.begin(Mode.GUIDED)
    assert field.reposition(place) is Result.FAILED
    field.wait(1.0)
    assert said(field, "DO_REPOSITION refused: ")
    assert said(field, why)
    field.goto(*place)
    field.wait(1.0)
    assert any("Setpoint" in text and why in text for text in field.texts)
    assert field.stands_for(1.0)
    assert field.reposition(Point(4, 0)) is Result.ACCEPTED


def test_a_mission_ends_before_an_item_outside_the_fence() -> None:
    field = ready(way(3, 0), way(3, 3), way(20, 0), FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=8)
    start(field)
    finish(field, 60.0)
    assert said(field, "AUTO: item 2: outside the fence: HOLD")
    assert field.truth.distance(Point(3, 3)) < 1.0
    field.wait(1.1)
    told = field.newest(m.MissionCurrent)
    assert (told.seq, told.mission_state) == (2, m.MISSION_PAUSED)
    assert field.set_mode(Mode.AUTO) is Result.ACCEPTED
    field.beat(1.0)
    assert field.mode is Mode.HOLD


def test_a_leg_through_an_exclusion_area_stops_before_it() -> None:
    field = fenced(SHAPES["exclusion circle"])
    assert upload(field, way(20, 0)) == MissionResult.ACCEPTED
    field.arm()
    start(field)
    finish(field, 60.0)
    assert said(field, "AUTO: blocked by the fence: HOLD")
    assert field.truth.north == pytest.approx(EDGE - 1.0, abs=0.6)


def test_outside_the_fence_the_way_home_is_not_limited() -> None:
    field = fenced([(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))], FENCE_ACTION=1)
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(7.0, AHEAD)
    assert field.mode is Mode.RTL
    finish(field, 60.0)
    assert field.truth.distance(Point(0, 0)) < 0.8
