"""Limits before obstacles, and range sensors that fail: with the rover, a wall before it, and the simulator's truth."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import DriveLimit, DriveType
from dialects.modes import Mode
from link.core import Peer, Received
from link.signing.role import SigningRole
from tests.vehicle.bench import AHEAD, BEAT, NEUTRAL, said
from tests.vehicle.drive.test_operator_session import Station
from tests.vehicle.field import Field
from tests.vehicle.proximity.drives import drive
from vehicle.params import Params
from vehicle.proximity.obstacles import SOURCES_MAX, Obstacles
from vehicle.proximity.override import LONGEST
from vehicle.readings import Cone, RangeReading

WALL = 3.0
"""m north of the start."""
NOSE = 0.2


class Walled(Field):
    """A rover that drives north to a wall, with a companion whose sensor looks ahead."""

    def __init__(self, **params: float) -> None:
        settings = {"PRX1_TYPE": 2.0, "FS_CRASH_CHECK": 0.0} | params
        super().__init__(1, None, None, **settings)
        self.measure: Callable[[], float | None] = lambda: WALL - self.truth.north - NOSE
        """m that the sensor reports; None: it is silent."""
        self.sensor_due = self.now
        self.companion_far = 6.0
        self.station_ = Station(self)
        self.companion(BEAT)

    def companion(self, message: m.Message, component: int = 196, system: int = 1,
                  role: SigningRole = SigningRole.SET_UP) -> None:  # fmt: skip
        self._receive(Received(message, system, component, 0, Peer(0, "companion"), introduced=True, role=role))

    def cycle(self) -> None:
        if self.body is not None and hasattr(self, "measure") and self.now >= self.sensor_due:
            self.sensor_due = self.now + 0.1
            distance = self.measure()
            if distance is not None:
                self.companion(ahead(distance, far=self.companion_far))
        super().cycle()

    def ready(self) -> None:
        self.station_.send(None)
        self.arm()
        self.station_.hold(0.3, NEUTRAL)

    def hold(self, seconds: float, axes: Axes, flags: int = 16) -> None:
        for _ in range(round(seconds / 0.05)):
            self.say(self.station_.build(axes, flags=flags))
            self.wait(0.05)

    @property
    def obstacles(self) -> Obstacles:
        return self.rover._obstacles

    @property
    def limits(self) -> DriveLimit:
        return DriveLimit(self.newest(m.RoverDriveStatus).limits)


def ahead(
    distance: float, number: int = 0, orientation: int = 0, quality: int = 0, far: float = 6.0
) -> m.DistanceSensor:
    furthest = round(100 * far)
    centimetres = max(0, min(furthest, round(100 * distance)))
    return m.DistanceSensor(0, 2, furthest, centimetres, 0, number, orientation, 255, 0.4, 0, signal_quality=quality)


def test_the_rover_stops_before_a_wall_and_drives_away() -> None:
    field = Walled()
    field.ready()
    field.hold(4.0, AHEAD)
    assert field.limits & DriveLimit.OBSTACLE
    assert abs(field.speed) < 0.05
    assert 0.25 <= WALL - field.truth.north - NOSE <= 0.4
    stopped = field.truth.north
    field.hold(1.0, Axes(-1.0))
    assert field.speed < -1.0
    assert field.truth.north < stopped - 0.5
    assert not field.limits & DriveLimit.OBSTACLE


def test_without_avoidance_it_drives_through_the_wall() -> None:
    field = Walled(AVOID_ENABLE=1)
    field.ready()
    field.hold(4.0, AHEAD)
    assert field.truth.north > WALL


def test_autonomous_modes_stop_before_the_wall_too() -> None:
    field = Walled()
    field.begin(Mode.GUIDED)
    field.stream(9.0, 1.2)
    assert field.truth.north > 2.0
    assert WALL - field.truth.north - NOSE >= 0.25


def test_a_setting_that_is_0_ignores_companions() -> None:
    field = Walled(PRX1_TYPE=0)
    field.ready()
    field.hold(4.0, AHEAD)
    assert not field.obstacles.sources
    assert field.truth.north > WALL


def test_only_components_with_a_key_that_drives_count() -> None:
    field = Walled()
    field.measure = lambda: None
    field.wait(0.5)
    field.companion(ahead(0.1), system=255)
    field.companion(ahead(0.1), component=1)
    field.companion(ahead(0.1), role=SigningRole.WATCH)
    assert not field.obstacles.sources
    field.companion(ahead(0.1))
    assert len(field.obstacles.sources) == 1


def test_a_hundred_sensors_and_1_khz() -> None:
    field = Walled()
    field.ready()
    for number in range(100):
        field.companion(ahead(5.0, number))
    assert len(field.obstacles.sources) == SOURCES_MAX
    field.wait(0.1)
    assert said(field, "ignored: too many")
    source = next(iter(field.obstacles.sources.values()))
    before = source.scan
    for step in range(1000):
        field.companion(ahead(1.0 + step / 1000))
    assert source.scan == before or source.scan[0].distance == 1.0, "more than one scan in a cycle"


@pytest.mark.parametrize(
    ("sensor", "fault"),
    [
        (lambda field: None, "no data"),
        (lambda field: 2.5, "frozen"),
        (lambda field: "blind", "blind"),
        (lambda field: "down", "does not look to a side"),
    ],
)
def test_a_sensor_that_fails_is_named_and_bounds_the_speed(
    sensor: Callable[[Walled], float | str | None], fault: str
) -> None:
    field = Walled()
    field.measure = lambda: 5.9 + 0.01 * (round(field.now * 10) % 3)
    field.ready()
    field.hold(1.0, AHEAD)
    assert field.speed > 1.0, field.obstacles.faults
    value = sensor(field)
    broken = {"blind": ahead(1.0, quality=1), "down": ahead(1.0, orientation=25)}
    if isinstance(value, str):
        field.measure = lambda: field.companion(broken[str(value)])
    else:
        field.measure = lambda: value
    field.hold(1.5, AHEAD)
    assert field.obstacles.faults == {"196/0": fault}
    assert said(field, f"Range sensor 196/0 ({fault})")
    assert 0.1 < field.speed <= 0.25
    assert field.limits & DriveLimit.RANGE_SENSOR
    field.hold(1.5, Axes(-1.0))
    assert field.speed < -1.0, "away from where it looks is free"


def test_sensors_that_contradict_are_named() -> None:
    field = Walled()
    field.measure = lambda: 5.0
    field.ready()
    for _ in range(30):
        field.companion(ahead(1.0, 7))
        field.hold(0.1, NEUTRAL)
    assert set(field.obstacles.faults.values()) == {"contradicts another"}


def test_a_sensor_that_never_came_is_named_and_bounds_the_speed() -> None:
    field = Walled()
    field.measure = lambda: None
    field.wait(11.0)
    assert field.obstacles.faults == {"PRX1": "no data"}
    field.ready()
    field.hold(1.5, AHEAD)
    assert 0.1 < field.speed <= 0.25


def test_a_wall_at_0_cm_for_ever_is_overridden_by_a_held_key() -> None:
    field = Walled()
    field.measure = lambda: 0.0
    field.ready()
    field.hold(1.0, AHEAD)
    assert abs(field.speed) < 0.02
    field.hold(1.0, AHEAD, flags=16 | 32)
    assert 0.1 < field.speed <= 0.25
    assert said(field, "obstacles overridden, 0.2 m/s")
    field.hold(0.5, AHEAD)
    assert abs(field.speed) < 0.02, "the key is let go"
    assert said(field, "obstacles count again")
    field.hold(LONGEST + 1.0, AHEAD, flags=16 | 32)
    assert abs(field.speed) < 0.02, "a key that is never let go"


def test_the_override_moves_nothing_without_a_drive_key() -> None:
    field = Walled()
    field.ready()
    field.hold(1.0, NEUTRAL, flags=16 | 32)
    assert field.truth.north == 0.0
    assert not field.turning


def test_other_ground_stations_see_the_obstacle() -> None:
    field = Walled()
    field.ready()
    field.wait(1.5)
    around, nearest = field.newest(m.ObstacleDistance), field.newest(m.DistanceSensor)
    assert around.frame == 12
    assert around.distances[:1] != around.distances[20:21]
    assert around.distances[0] == pytest.approx(100 * (WALL - NOSE), abs=6)
    assert around.distances[36] == around.max_distance + 1
    assert (nearest.orientation, nearest.current_distance) == (0, around.distances[0])
    before = [len(field.all(kind)) for kind in (m.ObstacleDistance, m.DistanceSensor)]
    field.wait(3.0)
    scans, distances = (len(field.all(kind)) for kind in (m.ObstacleDistance, m.DistanceSensor))
    assert 2 <= scans - before[0] <= 4
    assert 11 <= distances - before[1] <= 14


@pytest.mark.parametrize("kind", [1, 2, 4])
def test_a_limit_never_creates_motion(kind: int) -> None:
    field = Walled(DRIVE_TYPE=kind)
    field.measure = lambda: 0.0
    field.ready()
    for axes in (AHEAD, Axes(-1.0), Axes(0.0, 1.0), Axes(0.5, -1.0), NEUTRAL):
        field.hold(0.8, axes)
        for wheel in field.rover._drive.driven_wheels:
            assert abs(wheel) <= 1.0
        if axes == AHEAD:
            assert not any(field.rover._drive.driven_wheels), "never backwards by itself"


def reading(distance: float, number: int, far: float = 4.0) -> RangeReading:
    return RangeReading(f"RNGFND{number}", (Cone(0.0, 0.2, distance, far),), 1.0, number)


def share_of(params: dict[str, float], *ranges: RangeReading, speed: float = 0.0) -> tuple[float, float]:
    """The shares of full speed ahead and backwards."""
    obstacles = Obstacles(Params(params), DriveType.SKID)
    obstacles.sense(ranges)
    obstacles.move((0.0, 0.0), speed, 0.0, 1.0, 0.0, armed=True)
    return obstacles.share((1.0, 1.0), (0.0, 0.0))[0], obstacles.share((-1.0, -1.0), (0.0, 0.0))[0]


def test_parameters_say_where_a_rangefinder_looks_and_how_far() -> None:
    behind = {"RNGFND2_ORIENT": 4.0}
    assert share_of(behind, reading(0.2, 2)) == (1.0, 0.0)
    assert share_of(behind, reading(0.2, 1)) == (0.0, 1.0)
    assert share_of({"RNGFND1_MIN": 0.5, "AVOID_MARGIN": 0.05}, reading(0.4, 1))[0] == 0.0, "nearer than it measures"
    assert 0.0 < share_of({"RNGFND1_MAX": 0.4}, reading(0.45, 1))[0] < 0.5, "nothing in range, and a short range"


def test_the_rover_is_no_faster_than_its_sensor_sees_far() -> None:
    near, far = (share_of({"SPEED_MAX": 3.0}, reading(reach, 1, reach), speed=1.0) for reach in (1.2, 12.0))
    assert 0.1 < near[0] < 0.6
    assert near[1] == 1.0, "backwards no sensor looks"
    assert far == (1.0, 1.0)


def test_a_short_sighted_rover_at_full_speed_stops_before_a_wall() -> None:
    field = Walled(SPEED_MAX=2.0)
    field.measure = lambda: min(1.2, WALL - field.truth.north - NOSE)
    field.companion_far = 1.2
    field.ready()
    field.hold(6.0, AHEAD)
    assert 0.15 < WALL - NOSE - field.truth.north < 0.6
    assert abs(field.speed) < 0.02


@pytest.mark.slow
def test_random_drives_touch_no_wall() -> None:
    # tests/vehicle/proximity/drives.py runs 10,000 of them: docs/obstacles.md has the result.
    assert any(drive(seed, avoid=False).clearance == 0.0 for seed in range(8)), "there is something to touch"
    outcomes = [drive(seed) for seed in range(20)]
    assert sum(each.driven for each in outcomes) > 20.0
    assert min(each.clearance for each in outcomes) > 0.15
    assert math.isfinite(max(each.clearance for each in outcomes))
