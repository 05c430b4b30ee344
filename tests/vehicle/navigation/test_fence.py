"""The fence in a simulated field with noisy sensors: areas, breaches, rejected targets, return point."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result, Sensor
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, said
from tests.vehicle.field import GROUND, Field
from tests.vehicle.missions import Item, finish, upload
from vehicle.navigation.geo import Point

NAN = math.nan


def square(kind: int, north: float, east: float, size: float) -> list[Item]:
    corners = [(north, east), (north + size, east), (north + size, east + size), (north, east + size)]
    return [(kind, Point(*corner), (4,)) for corner in corners]


class TestFence:
    def fenced(self, items: list[Item], **params: float) -> Field:
        field = Field(FENCE_ENABLE=1, **params)  # type: ignore[arg-type]
        assert upload(field, *items, kind=MissionType.FENCE) == MissionResult.ACCEPTED
        field.arm()
        return field

    @pytest.mark.parametrize(
        "items",
        [
            square(FenceItem.POLYGON_INCLUSION, -5, -5, 10),
            square(FenceItem.POLYGON_EXCLUSION, 5, -3, 6),
            [(FenceItem.CIRCLE_INCLUSION, Point(0, 0), (5,))],
            [(FenceItem.CIRCLE_EXCLUSION, Point(8, 0), (3,))],
        ],
    )
    def test_a_breach_holds_once_and_manual_allows_driving_back(self, items: list[Item]) -> None:
        field = self.fenced(items)
        field.wait(0.2, NEUTRAL)
        while field.truth.north < 4.0:
            field.wait(0.5, AHEAD)
            assert field.turning
        field.wait(3.0, AHEAD)
        assert field.mode is Mode.HOLD
        assert 4.4 < field.truth.north < 7.5
        assert said(field, "outside the fence: HOLD")
        assert field.set_mode(Mode.LOITER) is Result.FAILED
        assert field.set_mode(Mode.MANUAL) is Result.ACCEPTED
        field.wait(0.2, NEUTRAL)
        field.wait(0.5, AHEAD)
        assert field.turning

    def test_a_breach_starts_rtl_if_selected(self) -> None:
        field = self.fenced([], FENCE_TYPE=2, FENCE_RADIUS=6, FENCE_ACTION=1)
        field.wait(0.2, NEUTRAL)
        field.wait(7.0, AHEAD)
        assert field.mode is Mode.RTL
        finish(field, 60.0)
        assert field.truth.distance(Point(0, 0)) < 0.8

    def test_targets_outside_the_fence_are_rejected(self) -> None:
        field = self.fenced([], FENCE_TYPE=2, FENCE_RADIUS=6)
        assert field.reposition(Point(10, 0)) is Result.FAILED
        field.set_mode(Mode.GUIDED)
        field.goto(10.0, 0.0)
        field.wait(0.5)
        assert said(field, "outside the fence")
        assert field.stands_for(1.0)

    def test_the_fence_cannot_be_changed_or_disabled_while_armed(self) -> None:
        field = self.fenced([])
        assert field.command(Command.DO_FENCE_ENABLE, 0) is Result.FAILED
        assert field.command(Command.DO_FENCE_ENABLE, 2) is Result.UNSUPPORTED
        assert field.command(Command.DO_FENCE_ENABLE, NAN) is Result.DENIED
        assert upload(field, kind=MissionType.FENCE) == MissionResult.DENIED
        field.command(Command.COMPONENT_ARM_DISARM, 0)
        assert field.command(Command.DO_FENCE_ENABLE, 0) is Result.ACCEPTED
        assert upload(field, kind=MissionType.FENCE) == MissionResult.ACCEPTED

    def test_areas_of_a_disabled_fence_are_reported_as_present(self) -> None:
        """MAVProxy reports "fence removed" if that changes."""

        def told(field: Field) -> tuple[bool, bool, bool]:
            field.beat(1.2)
            status = field.newest(m.SysStatus)
            present, enabled = status.onboard_control_sensors_present, status.onboard_control_sensors_enabled
            bits = present, enabled, status.onboard_control_sensors_health
            return tuple(bool(each & Sensor.GEOFENCE) for each in bits)  # type: ignore[return-value]

        field = Field()
        assert told(field) == (False, False, True)
        upload(field, *square(FenceItem.POLYGON_INCLUSION, -5, -5, 10), kind=MissionType.FENCE)
        assert told(field) == (True, False, True)
        field.command(Command.DO_FENCE_ENABLE, 1)
        assert told(field) == (True, True, True)
        field.command(Command.DO_FENCE_ENABLE, 0)
        assert told(field) == (True, False, True)
        upload(field, kind=MissionType.FENCE)
        assert told(field) == (False, False, True)

    def test_an_incomplete_polygon_is_rejected(self) -> None:
        field = Field()
        half = square(FenceItem.POLYGON_INCLUSION, 0, 0, 5)[:3]
        assert upload(field, *half, kind=MissionType.FENCE) == MissionResult.INVALID_PARAM1


class TestReturnPoint:
    POINT: Item = (FenceItem.RETURN_POINT, Point(1.0, 1.0), ())
    WORDS = "return point stored but not used"

    def test_return_point_is_stored_and_reported_and_a_breach_holds(self) -> None:
        field = Field(FENCE_ENABLE=1, FENCE_TYPE=4)
        plan = [self.POINT, *square(FenceItem.POLYGON_INCLUSION, -5, -5, 10)]
        assert upload(field, *plan, kind=MissionType.FENCE) == MissionResult.ACCEPTED
        field.wait(0.1)
        assert said(field, self.WORDS)
        field.say(m.MissionRequestList(1, 1, MissionType.FENCE))
        assert field.newest(m.MissionCount).count == len(plan)
        field.say(m.MissionRequestInt(1, 1, 0, MissionType.FENCE))
        back, (latitude, longitude) = field.newest(m.MissionItemInt), GROUND.to_global(Point(1.0, 1.0))
        assert (back.command, back.x, back.y) == (5000, round(latitude * 1e7), round(longitude * 1e7))
        field.arm()
        field.wait(0.2, NEUTRAL)
        field.wait(2.0, AHEAD)
        assert field.turning
        field.wait(7.0, AHEAD)
        assert field.mode is Mode.HOLD
        assert 4.4 < field.truth.north < 7.5

    def test_a_fence_without_a_return_point_sends_no_notice(self) -> None:
        field = Field()
        upload(field, *square(FenceItem.POLYGON_INCLUSION, -5, -5, 10), kind=MissionType.FENCE)
        field.wait(0.1)
        assert not said(field, self.WORDS)

    def test_a_return_point_alone_is_not_a_fence(self) -> None:
        field = Field()
        assert upload(field, self.POINT, kind=MissionType.FENCE) == MissionResult.ACCEPTED
        field.beat(1.2)
        assert not field.newest(m.SysStatus).onboard_control_sensors_present & Sensor.GEOFENCE

    @pytest.mark.parametrize(
        ("plan", "verdict"),
        [
            ([POINT, POINT], MissionResult.INVALID),
            ([(FenceItem.RETURN_POINT, None, ())], MissionResult.UNSUPPORTED_FRAME),
            ([*square(FenceItem.POLYGON_INCLUSION, 0, 0, 5)[:2], POINT], MissionResult.INVALID_PARAM1),
        ],
    )
    def test_invalid_return_points_are_rejected(self, plan: list[Item], verdict: int) -> None:
        assert upload(Field(), *plan, kind=MissionType.FENCE) == verdict
