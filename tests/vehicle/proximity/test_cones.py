"""What DISTANCE_SENSOR and OBSTACLE_DISTANCE say, and what of it is not used."""

from __future__ import annotations

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from vehicle.proximity.cones import angle_between, parse_distance_sensor, parse_obstacle_distance
from vehicle.readings import Cone


def single(**fields: Any) -> m.DistanceSensor:
    usual = {"time_boot_ms": 0, "min_distance": 5, "max_distance": 400, "current_distance": 120, "type": 0, "id": 3,
             "orientation": 2, "covariance": 255, "horizontal_fov": 0.4}  # fmt: skip
    return m.DistanceSensor(**(usual | fields))


def round_about(distances: list[int], **fields: Any) -> m.ObstacleDistance:
    usual = {"time_usec": 0, "sensor_type": 0, "increment": 90, "min_distance": 10, "max_distance": 500, "frame": 12}
    return m.ObstacleDistance(distances=(distances + [m.UINT16_MAX] * 72)[:72], **(usual | fields))


@pytest.mark.parametrize(
    ("fields", "distance"),
    [({}, 1.2), ({"current_distance": 400}, 4.0), ({"current_distance": 65535}, 4.0), ({"current_distance": 2}, 0.0),
     ({"signal_quality": 1}, None)],
)  # fmt: skip
def test_a_distance_and_its_limits(fields: dict[str, Any], distance: float | None) -> None:
    assert parse_distance_sensor(single(**fields)) == (Cone(math.pi / 2, 0.2, distance, 4.0),)


@pytest.mark.parametrize("fov", [math.nan, -1.0, 0.0, 7.0, math.inf])
def test_an_angle_that_is_none_is_a_usual_one(fov: float) -> None:
    scan = parse_distance_sensor(single(horizontal_fov=fov))
    assert isinstance(scan, tuple)
    assert 0.1 < scan[0].half_width < 0.4


@pytest.mark.parametrize(
    ("fields", "reason"),
    [({"orientation": 25}, "side"), ({"orientation": 100}, "side"), ({"min_distance": 400}, "min_distance")],
)
def test_a_sensor_that_looks_elsewhere_is_not_used(fields: dict[str, Any], reason: str) -> None:
    assert reason in str(parse_distance_sensor(single(**fields)))


def test_distances_all_around() -> None:
    scan = parse_obstacle_distance(round_about([100, 501, m.UINT16_MAX, 3]), None)
    assert isinstance(scan, tuple)
    assert [cone.distance for cone in scan] == [1.0, 5.0, None, 0.0]
    assert [round(math.degrees(cone.bearing)) for cone in scan] == [0, 90, 180, 270]
    assert scan[1].is_clear
    assert not scan[0].is_clear


def test_distances_may_count_to_the_left_and_from_north() -> None:
    scan = parse_obstacle_distance(round_about([100, 100], increment_f=-45.0, angle_offset=10.0, frame=0), math.pi / 2)
    assert isinstance(scan, tuple)
    assert [round(math.degrees(cone.bearing)) for cone in scan[:2]] == [280, 235]


@pytest.mark.parametrize(
    ("fields", "reason"),
    [({"increment": 0}, "angles"), ({"increment_f": math.nan}, "angles"), ({"angle_offset": math.inf}, "angles"),
     ({"frame": 0}, "heading"), ({"frame": 9}, "frame 9"), ({"max_distance": 10}, "min_distance")],
)  # fmt: skip
def test_distances_without_a_direction_are_not_used(fields: dict[str, Any], reason: str) -> None:
    assert reason in str(parse_obstacle_distance(round_about([100], **fields), None))


@given(
    st.builds(single, current_distance=st.integers(0, 65535), min_distance=st.integers(0, 65535),
              max_distance=st.integers(0, 65535), orientation=st.integers(0, 255), horizontal_fov=st.floats(),
              signal_quality=st.integers(0, 255))
)  # fmt: skip
def test_no_distance_is_negative_or_not_a_number(message: m.DistanceSensor) -> None:
    scan = parse_distance_sensor(message)
    if isinstance(scan, tuple):
        (cone,) = scan
        assert cone.distance is None or 0.0 <= cone.distance <= cone.far
        assert 0.0 < cone.half_width <= math.pi / 2


@given(st.lists(st.integers(0, 65535), max_size=72), st.integers(0, 255), st.floats(width=32), st.floats(width=32))
def test_no_direction_is_not_a_number(distances: list[int], step: int, width: float, offset: float) -> None:
    scan = parse_obstacle_distance(round_about(distances, increment=step, increment_f=width, angle_offset=offset), 0.5)
    if isinstance(scan, tuple):
        assert len(scan) <= 72
        assert all(0.0 <= cone.bearing < math.tau + 1e-9 and 0.0 < cone.half_width <= math.pi / 2 for cone in scan)


def test_the_angle_between_two_bearings() -> None:
    assert angle_between(0.1, math.tau - 0.1) == pytest.approx(0.2)
    assert angle_between(0.0, math.pi) == pytest.approx(math.pi)
