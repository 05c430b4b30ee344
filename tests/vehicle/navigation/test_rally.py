"""RTL to the nearest of home and the rally points, in a simulated field."""

from __future__ import annotations

import pytest

from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, said
from tests.vehicle.field import Field
from tests.vehicle.missions import Item, do, finish, start, upload, way
from vehicle.navigation.geo import Point

HOME = Point(0, 0)
NEAR, FAR = Point(10, 6), Point(30, 6)


def rally(*points: Point) -> list[Item]:
    return [(FenceItem.RALLY_POINT, point, ()) for point in points]


def away(*points: Point, **params: float) -> Field:
    """Armed, at about 8 m north of home, with rally points."""
    field = Field(**params)  # type: ignore[arg-type]
    assert upload(field, *rally(*points), kind=MissionType.RALLY) == MissionResult.ACCEPTED
    assert field.arm() is Result.ACCEPTED
    assert field.reposition(Point(8, 0)) is Result.ACCEPTED
    field.until(Point(8, 0), 60.0, 0.4)
    return field


def returned(field: Field) -> Point:
    assert field.set_mode(Mode.RTL) is Result.ACCEPTED
    finish(field, 120.0)
    return field.truth


def test_rtl_drives_to_the_nearest_rally_point() -> None:
    field = away(FAR, NEAR)
    assert returned(field).distance(NEAR) < 0.7
    assert said(field, "RTL: rally point 1 is reached: HOLD")


@pytest.mark.parametrize(
    ("points", "params", "goal"),
    [
        ([], {}, HOME),
        ([FAR], {}, HOME),
        ([FAR], {"RALLY_INCL_HOME": 0}, FAR),
        ([NEAR], {"RALLY_LIMIT_KM": 0.005}, HOME),
        ([NEAR], {"RALLY_LIMIT_KM": 0.005, "RALLY_INCL_HOME": 0}, HOME),
        ([NEAR], {"RALLY_LIMIT_KM": 0}, NEAR),
        ([NEAR], {"FENCE_ENABLE": 1, "FENCE_TYPE": 2, "FENCE_RADIUS": 10}, HOME),
        ([NEAR], {"FENCE_ENABLE": 0, "FENCE_TYPE": 2, "FENCE_RADIUS": 10}, NEAR),
    ],
)
def test_the_return_point_follows_the_rally_parameters(
    points: list[Point], params: dict[str, float], goal: Point
) -> None:
    field = away(*points, **params)
    field.set_mode(Mode.RTL)
    field.wait(0.1)
    going = field.rover._navigator.goal(Mode.RTL)
    assert going is not None
    assert going.distance(goal) < 1.0


def test_a_rally_point_outside_the_fence_is_ignored() -> None:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=4)
    circle = (FenceItem.CIRCLE_EXCLUSION, NEAR, (2,))
    assert upload(field, circle, kind=MissionType.FENCE) == MissionResult.ACCEPTED
    assert upload(field, *rally(NEAR, Point(14, 0)), kind=MissionType.RALLY) == MissionResult.ACCEPTED
    field.arm()
    assert field.reposition(Point(9, 0)) is Result.ACCEPTED
    field.until(Point(9, 0), 60.0, 0.4)
    assert returned(field).distance(Point(14, 0)) < 0.7


def test_return_to_launch_in_a_mission_uses_rally_points() -> None:
    field = Field()
    upload(field, *rally(NEAR), kind=MissionType.RALLY)
    upload(field, way(8, 0), do(Command.NAV_RETURN_TO_LAUNCH), way(50, 50))
    field.arm()
    start(field)
    finish(field, 90.0)
    assert field.truth.distance(NEAR) < 0.7
    assert said(field, "AUTO: rally point 0 is reached: HOLD")


def test_outside_the_fence_rtl_uses_a_rally_point_inside() -> None:
    field = Field(FENCE_ENABLE=1, FENCE_TYPE=2, FENCE_RADIUS=6, FENCE_ACTION=1)
    upload(field, *rally(Point(4, 1), Point(9, 0)), kind=MissionType.RALLY)
    field.arm()
    field.wait(0.2, NEUTRAL)
    field.wait(7.0, AHEAD)
    assert field.mode is Mode.RTL
    finish(field, 60.0)
    assert field.truth.distance(Point(4, 1)) < 0.8


def test_cleared_rally_points_are_not_used() -> None:
    field = away(NEAR)
    assert upload(field, kind=MissionType.RALLY) == MissionResult.ACCEPTED
    assert returned(field).distance(HOME) < 0.8
    assert said(field, "RTL: home is reached")
