"""Another origin: local positions count from elsewhere, and nothing moves on the globe."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionType, Result
from dialects.modes import Mode
from link.core import Peer
from tests.vehicle.bench import DRIVER, OTHER, Bench, said
from tests.vehicle.field import GROUND, Field
from tests.vehicle.missions import finish, start, upload, way
from tests.vehicle.navigation.test_fence import square
from vehicle.navigation.geo import Point

SET = Command.DO_SET_GLOBAL_ORIGIN
ELSEWHERE = Point(400, -300)
"""Of the new origin, from the old one."""


def degrees(place: Point) -> tuple[int, int]:
    latitude, longitude = GROUND.to_global(place)
    return round(latitude * 1e7), round(longitude * 1e7)


def away() -> Field:
    """Disarmed, 8 m north of home and with a heading."""
    field = Field()
    field.begin(Mode.GUIDED)
    assert field.reposition(Point(8, 0)) is Result.ACCEPTED
    field.until(Point(8, 0), 60.0, 0.4)
    assert field.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED
    field.beat(2.0)
    return field


def move(field: Field, place: Point = ELSEWHERE, system: int = DRIVER) -> Result:
    x, y = degrees(place)
    return field.command_int(SET, x=x, y=y, system=system)


def globe(field: Field) -> tuple[float, float]:
    place = field.newest(m.GlobalPositionInt)
    return place.lat, place.lon


def to_home(field: Field) -> float:
    home, place = field.newest(m.HomePosition), field.newest(m.LocalPositionNed)
    return Point(home.x, home.y).distance(Point(place.x, place.y))


@pytest.mark.parametrize("place", [ELSEWHERE, Point(0.5, 0.5), Point(-3000, 2000)])
def test_the_place_on_the_globe_and_the_way_home_stay_the_same(place: Point) -> None:
    field = away()
    before = field.newest(m.HomePosition), globe(field), to_home(field), field.newest(m.LocalPositionNed)
    assert move(field, place) is Result.ACCEPTED
    origin = field.newest(m.GpsGlobalOrigin)
    assert (origin.latitude, origin.longitude) == pytest.approx(degrees(place), abs=1)
    field.wait(2.5)  # home is told every 2 s
    home, local = field.newest(m.HomePosition), field.newest(m.LocalPositionNed)
    assert (home.latitude, home.longitude) == (before[0].latitude, before[0].longitude)
    assert globe(field) == pytest.approx(before[1], abs=10)  # 0.1 m: the filter goes on meanwhile
    assert to_home(field) == pytest.approx(before[2], abs=0.1)
    assert (home.x, home.y) == pytest.approx((-place.north, -place.east), abs=3)  # the first fix was home
    moved = local.x - before[3].x, local.y - before[3].y
    assert moved == pytest.approx((-place.north, -place.east), abs=3)  # flat ground, 0.05 % of 3 km


def test_rover_drives_mission_home_and_fence_the_same_after_it() -> None:
    field = away()
    fence = square(FenceItem.POLYGON_INCLUSION, -10, -10, 30)
    assert upload(field, *fence, kind=MissionType.FENCE) == 0
    assert move(field) is Result.ACCEPTED
    assert field.command(Command.DO_FENCE_ENABLE, 1) is Result.ACCEPTED
    assert upload(field, way(12, 4)) == 0
    assert field.arm() is Result.ACCEPTED, field.texts
    start(field)
    finish(field, 60.0)
    assert field.truth.distance(Point(12, 4)) < 0.7
    assert field.reposition(Point(25, 4)) is Result.FAILED  # beyond the fence, as before
    assert field.set_mode(Mode.RTL) is Result.ACCEPTED
    finish(field, 60.0)
    assert field.truth.distance(Point(0, 0)) < 0.7


def test_a_mode_that_was_chosen_before_stays_where_the_rover_is() -> None:
    field = away()
    assert field.set_mode(Mode.LOITER) is Result.ACCEPTED
    assert move(field) is Result.ACCEPTED
    field.wait(1.5)
    goal, place = field.newest(m.PositionTargetLocalNed), field.newest(m.LocalPositionNed)
    assert Point(goal.x, goal.y).distance(Point(place.x, place.y)) < 0.5
    assert field.arm() is Result.ACCEPTED
    before = field.truth
    field.beat(4.0)
    assert field.truth.distance(before) < 0.5


def test_the_same_origin_again_is_told_again_to_who_asked() -> None:
    field = away()
    for _ in range(2):
        count = len(field.sent)
        assert move(field) is Result.ACCEPTED
        told = [peer for message, peer in zip(field.sent[count:], field.peers[count:], strict=True)
                if isinstance(message, m.GpsGlobalOrigin)]  # fmt: skip
        assert Peer(0, f"gcs {DRIVER}") in told


def test_odometry_says_that_it_has_jumped() -> None:
    field = away()
    assert field.command(Command.REQUEST_MESSAGE, m.Odometry.id) is Result.ACCEPTED
    assert field.newest(m.Odometry).reset_counter == 0
    for number in (1, 2):
        assert move(field, Point(number, 0)) is Result.ACCEPTED
        field.wait(0.1)
        assert field.command(Command.REQUEST_MESSAGE, m.Odometry.id) is Result.ACCEPTED
        assert field.newest(m.Odometry).reset_counter == number


def heights(field: Field) -> tuple[float, float, float, float]:
    """Of the origin, m above the sea; of home and of the rover below it; of the rover above home."""
    field.command(Command.REQUEST_MESSAGE, m.Altitude.id)
    field.wait(2.5)
    return (
        field.newest(m.GpsGlobalOrigin).altitude / 1000,
        field.newest(m.HomePosition).z,
        field.newest(m.LocalPositionNed).z,
        field.newest(m.GlobalPositionInt).relative_alt / 1000,
    )


@pytest.mark.parametrize(
    ("frame", "altitude", "origin"), [(0, 60.0, 60.0), (6, -40.0, 60.0), (3, 0.0, 100.0), (0, math.nan, 100.0)]
)
def test_local_heights_count_from_the_origins(frame: int, altitude: float, origin: float) -> None:
    field = away()
    assert heights(field) == pytest.approx((100, 0, 0, 0))
    x, y = degrees(ELSEWHERE)
    assert field.command_int(SET, x=x, y=y, z=altitude, frame=frame) is Result.ACCEPTED
    assert heights(field) == pytest.approx((origin, origin - 100, origin - 100, 0))


@pytest.mark.parametrize("altitude", [math.inf, 1e6])
def test_a_height_that_is_none_is_denied(altitude: float) -> None:
    field = away()
    before = field.estimate.origin
    x, y = degrees(ELSEWHERE)
    assert field.command_int(SET, x=x, y=y, z=altitude) is Result.DENIED
    assert field.estimate.origin == before


def test_far_away_is_refused_and_nothing_changes() -> None:
    field = away()
    before = field.estimate.origin
    assert move(field, Point(20e3, 0)) is Result.FAILED
    assert said(field, "20 km away, limit is 10 km")
    assert field.estimate.origin == before


class TestTheOlderMessage:
    def say(
        self, field: Field, x: int, y: int, system: int = DRIVER, target: int = 1, *, introduced: bool = True
    ) -> int:
        """How often the origin was told for it."""
        count = len(field.all(m.GpsGlobalOrigin))
        field.say(m.SetGpsGlobalOrigin(target, x, y, 0), system, introduced=introduced)
        return len(field.all(m.GpsGlobalOrigin)) - count

    def test_moves_the_origin(self) -> None:
        field = away()
        assert self.say(field, *degrees(ELSEWHERE)) >= 1
        assert field.estimate.place.distance(Point(-392, 300)) < 3
        origin = field.newest(m.GpsGlobalOrigin)
        assert (origin.latitude, origin.longitude) == pytest.approx(degrees(ELSEWHERE), abs=1)

    def test_its_height_is_told_as_it_was_said(self) -> None:
        """MAVSDK takes anything else for silence."""
        field = away()
        field.say(m.SetGpsGlobalOrigin(1, *degrees(ELSEWHERE), 60_000))
        assert field.newest(m.GpsGlobalOrigin).altitude == 60_000

    @pytest.mark.parametrize(("x", "y"), [(0, 0), (2**31 - 1, 2**31 - 1), (910_000_000, 0), (-(2**31), 0)])
    def test_what_is_no_place_is_refused_in_words(self, x: int, y: int) -> None:
        field = away()
        before = field.estimate.origin
        assert self.say(field, x, y) == 1  # where it is, all the same
        assert field.estimate.origin == before
        assert said(field, "SET_GPS_GLOBAL_ORIGIN refused: invalid position")

    def test_of_others_while_armed_and_for_others_it_moves_nothing(self) -> None:
        field = away()
        field.heartbeat(OTHER)
        before, place = field.estimate.origin, degrees(ELSEWHERE)
        assert self.say(field, *place, system=OTHER) == 1
        assert said(field, f"GCS {DRIVER} is in control")
        assert self.say(field, *place, target=9) == 0
        assert self.say(field, *place, introduced=False) == 0
        assert field.arm() is Result.ACCEPTED
        self.say(field, *place)
        assert said(field, "SET_GPS_GLOBAL_ORIGIN refused: armed")
        assert field.estimate.origin == before

    def test_before_the_first_fix_there_is_nothing_to_move_or_tell(self) -> None:
        bench = Bench()
        bench.say(m.SetGpsGlobalOrigin(1, *degrees(ELSEWHERE), 0))
        assert not bench.all(m.GpsGlobalOrigin)
        assert said(bench, "the position is not known")
