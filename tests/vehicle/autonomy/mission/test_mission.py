"""AUTO in a simulated field with noisy sensors: the way along the lines, what items do, who may start and change it."""

from __future__ import annotations

import math
from itertools import groupby, pairwise

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, DRIVER, NEUTRAL, OTHER, said
from tests.vehicle.field import GROUND, Field
from vehicle.autonomy.mission.item_reached import SEND_COUNT
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import Leg

Item = tuple[int, Point | None, tuple[float, ...]]
NAN = math.nan
NAV_TAKEOFF = 22


def way(north: float, east: float, hold: float = 0.0) -> Item:
    return Command.NAV_WAYPOINT, Point(north, east), (hold,)


def do(command: int, *params: float) -> Item:
    return command, None, params


def upload(field: Field, *items: Item, kind: MissionType = MissionType.MISSION, system: int = DRIVER) -> int:
    """As a ground station does it; the verdict."""
    before = len(field.all(m.MissionAck))
    send(field, *items, kind=kind, system=system)
    return int(field.all(m.MissionAck)[before].type)


def send(field: Field, *items: Item, kind: MissionType = MissionType.MISSION, system: int = DRIVER) -> None:
    """Without an eye for the answer."""
    before = len(field.all(m.MissionAck))
    field.say(m.MissionCount(1, 1, len(items), kind), system)
    if len(field.all(m.MissionAck)) > before:  # refused, or an empty one
        return
    for number, (command, place, params) in enumerate(items):
        latitude, longitude = GROUND.to_global(place) if place else (0.0, 0.0)
        one, two, three, four = (*params, *(0.0,) * (4 - len(params)))
        x, y = round(latitude * 1e7), round(longitude * 1e7)
        frame = 6 if place else 2
        field.say(m.MissionItemInt(1, 1, number, frame, command, 0, 1, one, two, three, four, x, y, 0, kind), system)


def ready(*items: Item, **params: float) -> Field:
    field = Field(**params)  # type: ignore[arg-type]
    assert upload(field, *items) == MissionResult.ACCEPTED
    assert field.arm() is Result.ACCEPTED
    return field


def passed(field: Field) -> list[int]:
    """Items in the order in which they were reached; each is said several times."""
    return [index for index, _ in groupby(each.seq for each in field.all(m.MissionItemReached))]


def start(field: Field) -> None:
    assert field.command(Command.MISSION_START) is Result.ACCEPTED, field.texts


def finish(field: Field, within: float) -> None:
    end = field.now + within
    while field.mode is not Mode.HOLD:
        assert field.now < end, f"at {field.truth}; {field.texts}"
        field.heartbeat()
        field.wait(0.5)


def beside(field: Field, corners: list[Point], margin: float = 1.5) -> float:
    """m that the truth was beside the nearest line, at worst, away from the corners."""
    legs = [Leg(one, two) for one, two in pairwise(corners)]
    worst = 0.0
    for place in field.track:
        if min(corner.distance(place) for corner in corners) < margin:
            continue
        worst = max(worst, min(abs(leg.along_and_cross_track(place)[1]) for leg in legs if _along(leg, place)))
    return worst


def _along(leg: Leg, place: Point) -> bool:
    remaining, beside = leg.along_and_cross_track(place)
    return 0.0 <= remaining <= leg.start.distance(leg.end) and abs(beside) < 5.0


CORNERS = [Point(0, 0), Point(40, 0), Point(40, 25), Point(10, 30), Point(0, 0)]


@pytest.mark.parametrize("seed", range(8))
def test_ten_minutes_stay_within_half_a_metre_of_the_lines(seed: int) -> None:
    rounds = [way(place.north, place.east) for place in CORNERS[1:]]
    field = Field(seed)
    field.wait(30.0)  # as long as a driver takes to upload and arm: the receiver's first error is averaged
    assert upload(field, *rounds, do(Command.DO_JUMP, 0, 3)) == MissionResult.ACCEPTED
    field.arm()
    field.track.clear()
    began = field.now
    start(field)
    finish(field, 1200.0)
    assert field.now - began > 580.0
    assert said(field, "AUTO: mission complete: HOLD")
    assert beside(field, CORNERS) < 0.45
    assert passed(field) == [0, 1, 2, 3] * 4


class TestItems:
    def test_items_that_are_done_beside_the_drive_count_as_reached(self) -> None:
        """Else a client that counts by them goes back and forth between them and MISSION_CURRENT."""
        speed = do(Command.DO_CHANGE_SPEED, 1, 0.7)
        field = ready(way(3, 0), speed, way(6, 0), do(Command.CONDITION_DISTANCE, 1.0), speed, way(9, 0))
        start(field)
        finish(field, 60.0)
        assert passed(field) == [0, 1, 2, 3, 4, 5]

    def test_a_waypoint_with_a_hold_time_is_stood_at(self) -> None:
        field = ready(way(5, 0, 4.0), way(5, 5))
        start(field)
        field.until(Point(5, 0), 20.0, 0.5)
        field.beat(2.0)
        assert field.stands_for(2.0)
        finish(field, 40.0)
        assert field.truth.distance(Point(5, 5)) < 0.7

    def test_delay_then_condition_then_speed(self) -> None:
        field = ready(
            do(Command.NAV_DELAY, 3.0), do(Command.CONDITION_DISTANCE, 8.0), do(Command.DO_CHANGE_SPEED, 1, 0.3, -1),
            way(20, 0),
        )  # fmt: skip
        start(field)
        assert field.stands_for(2.0)
        field.beat(4.0)
        assert field.speed == pytest.approx(0.8, abs=0.1)
        field.until(Point(17, 0), 40.0, 1.0)
        assert field.speed == pytest.approx(0.3, abs=0.1)

    def test_a_condition_of_time_holds_up_what_stands_behind_it(self) -> None:
        field = ready(do(Command.CONDITION_DELAY, 6.0), do(Command.DO_CHANGE_SPEED, 1, 0.3, -1), way(20, 0))
        start(field)
        field.beat(5.0)
        assert field.speed > 0.6
        field.beat(3.0)
        assert field.speed == pytest.approx(0.3, abs=0.1)

    def test_turns_around_a_point(self) -> None:
        field = ready((Command.NAV_LOITER_TURNS, Point(6, 0), (1.5, 0, 2.0)))
        field.track.clear()
        start(field)
        finish(field, 120.0)
        near = [place.distance(Point(6, 0)) for place in field.track[len(field.track) // 2 :]]
        assert min(near) > 1.2
        assert max(near) < 2.8

    def test_yaw_and_reverse(self) -> None:
        field = ready(do(Command.CONDITION_YAW, 180.0), do(Command.DO_SET_REVERSE, 1), way(6, 0))
        start(field)
        finish(field, 60.0)
        assert abs(abs(math.remainder(field.yaw, math.tau)) - math.pi) < 0.3
        assert field.truth.distance(Point(6, 0)) < 0.7

    def test_home_is_an_item_and_the_last_one(self) -> None:
        field = ready(way(6, 3), do(Command.NAV_RETURN_TO_LAUNCH), way(50, 50))
        start(field)
        field.until(Point(6, 3), 40.0)
        finish(field, 60.0)
        assert field.truth.distance(Point(0, 0)) < 0.8

    def test_70_jumps_in_a_circle_end_the_mission(self) -> None:
        field = ready(do(Command.DO_JUMP, 1, -1), do(Command.DO_JUMP, 0, -1))
        start(field)
        field.wait(0.5)
        assert field.mode is Mode.HOLD
        assert said(field, "jumps go in a circle")

    def test_a_jump_is_made_as_often_as_it_says(self) -> None:
        field = ready(way(4, 0), way(4, 4), do(Command.DO_JUMP, 0, 2), way(0, 4))
        start(field)
        finish(field, 120.0)
        assert passed(field) == [0, 1, 0, 1, 0, 1, 3]

    def test_loiter_for_a_time_is_to_stand_there(self) -> None:
        field = ready((Command.NAV_LOITER_TIME, Point(4, 0), (5.0,)), way(8, 0))
        start(field)
        field.until(Point(4, 0), 30.0, 0.4)
        field.beat(1.5)
        assert field.stands_for(2.0)
        finish(field, 40.0)
        assert field.truth.distance(Point(8, 0)) < 0.7

    def test_what_moves_accessories_is_told_and_passed_over(self) -> None:
        field = ready(do(Command.DO_SET_SERVO, 5, 1500), do(Command.DO_SET_RELAY, 0, 1), way(5, 0))
        field.wait(0.2)
        words = (
            "Mission: no accessory for items 0, 1, will be skipped: there is no servo 5, there is no relay 0"
        )
        assert said(field, words)
        start(field)
        finish(field, 40.0)
        assert field.truth.distance(Point(5, 0)) < 0.7
        assert said(field, "Mission: skipped DO_SET_SERVO 5: there is no servo 5")
        assert said(field, "Mission: skipped DO_SET_RELAY 0: there is no relay 0")

    def test_the_usual_speed_comes_back(self) -> None:
        field = ready(
            do(Command.DO_CHANGE_SPEED, 1, 0.3, -1), way(4, 0), do(Command.DO_CHANGE_SPEED, 1, -2, -1), way(20, 0)
        )
        start(field)
        field.until(Point(2.5, 0), 40.0, 1.0)
        assert field.speed == pytest.approx(0.3, abs=0.1)
        field.until(Point(12, 0), 40.0, 1.0)
        assert field.speed == pytest.approx(0.8, abs=0.1)

    def test_a_mission_may_turn_the_fence_on(self) -> None:
        field = ready(do(Command.DO_FENCE_ENABLE, 1), way(5, 0), way(30, 0), FENCE_TYPE=2, FENCE_RADIUS=8)
        start(field)
        finish(field, 60.0)
        assert said(field, "beyond the fence: HOLD")
        assert field.truth.north < 10.0

    def test_it_ends_where_the_file_of_settings_has_no_fence(self) -> None:
        field = ready(way(2, 0), do(Command.DO_FENCE_ENABLE, 1), way(20, 0))
        field.rover._params.pinned = frozenset({"FENCE_ENABLE"})
        start(field)
        finish(field, 60.0)
        assert said(field, "AUTO: the file of settings has FENCE_ENABLE 0: HOLD")
        assert 1.0 < field.truth.north < 5.0
        assert field.rover._params["FENCE_ENABLE"] == 0

    def test_why_the_last_item_is_not_done_is_told(self) -> None:
        field = ready(way(2, 0), do(Command.DO_FENCE_ENABLE, 1))
        field.rover._params.pinned = frozenset({"FENCE_ENABLE"})
        start(field)
        finish(field, 60.0)
        assert said(field, "AUTO: the file of settings has FENCE_ENABLE 0: HOLD")

    def test_unlimited_means_until_somebody_ends_it(self) -> None:
        field = ready((Command.NAV_LOITER_UNLIM, Point(3, 0), ()), way(30, 0))
        start(field)
        field.beat(60.0)
        assert field.mode is Mode.AUTO
        assert field.truth.distance(Point(3, 0)) < 0.7


class TestProgress:
    def test_hold_and_auto_goes_on_where_it_was_and_a_complete_one_begins_anew(self) -> None:
        field = ready(way(6, 0), way(6, 6), way(12, 6))
        start(field)
        field.until(Point(6, 3), 60.0)
        field.set_mode(Mode.HOLD)
        field.beat(2.0)
        told = field.newest(m.MissionCurrent)
        assert (told.seq, told.total, told.mission_state) == (1, 3, m.MISSION_PAUSED)
        field.set_mode(Mode.AUTO)
        finish(field, 90.0)
        assert field.truth.distance(Point(12, 6)) < 0.7
        field.set_mode(Mode.AUTO)
        field.beat(2.0)
        assert field.newest(m.MissionCurrent).seq == 0
        assert field.turning

    def test_the_ids_of_all_plans_are_told_at_once_and_again_and_again(self) -> None:
        field = Field()
        field.wait(1.1)
        told = field.newest(m.MissionCurrent)
        assert (told.total, told.mission_id, told.fence_id, told.rally_points_id) == (65535, 0, 0, 0)
        upload(field, way(5, 0))
        assert field.newest(m.MissionAck).opaque_id
        mission = field.newest(m.MissionAck).opaque_id
        rally = (FenceItem.RALLY_POINT, Point(3, 3), ())
        upload(field, rally, kind=MissionType.RALLY)
        rally_id = field.newest(m.MissionAck).opaque_id
        field.wait(0.1)  # less than the stream's second
        told = field.newest(m.MissionCurrent)
        assert (told.total, told.mission_id, told.fence_id, told.rally_points_id) == (1, mission, 0, rally_id)
        before = len(field.all(m.MissionCurrent))
        field.wait(5.0)
        assert len(field.all(m.MissionCurrent)) - before == 5
        assert field.newest(m.MissionCurrent).mission_id == mission

    def test_the_item_that_is_chosen_by_command_is_told_to_all(self) -> None:
        field = ready(way(6, 0), way(6, 6))
        field.wait(1.1)
        for index, seq in ((1, 1), (1, 1), (-1, 1), (0, 0)):
            before = len(field.all(m.MissionCurrent))
            assert field.command(Command.DO_SET_MISSION_CURRENT, index) is Result.ACCEPTED
            field.wait(0.02)
            assert [each.seq for each in field.all(m.MissionCurrent)[before:]][-1:] == [seq]
        assert field.command(Command.DO_SET_MISSION_CURRENT, -2) is Result.DENIED
        assert field.command(Command.DO_SET_MISSION_CURRENT, 1, 2) is Result.DENIED

    @pytest.mark.parametrize(("anew", "again"), [(0, 0), (1, 1)])
    def test_jumps_made_are_forgotten_only_where_somebody_says_so(self, anew: float, again: int) -> None:
        field = ready(way(3, 0), do(Command.DO_JUMP, 0, 1), way(3, 3), way(40, 3))
        start(field)
        field.until(Point(3, 3), 60.0, 0.5)
        assert [each.seq for each in field.all(m.MissionItemReached)].count(0) > SEND_COUNT  # reached twice
        before = len(field.all(m.MissionItemReached))
        assert field.command(Command.DO_SET_MISSION_CURRENT, 0, anew) is Result.ACCEPTED
        field.until(Point(3, 0), 60.0, 0.4)
        field.until(Point(20, 3), 120.0, 1.0)
        reached = [each.seq for each in field.all(m.MissionItemReached)][before:]
        assert (reached.count(0) > SEND_COUNT) == bool(again)

    def test_an_item_can_be_chosen(self) -> None:
        field = ready(way(6, 0), way(0, 6))
        assert field.command(Command.DO_SET_MISSION_CURRENT, 1) is Result.ACCEPTED
        for wrong in (2, -2, 0.5, NAN):
            assert field.command(Command.DO_SET_MISSION_CURRENT, wrong) is Result.DENIED
        start(field)
        field.until(Point(0, 6), 40.0)
        field.say(m.MissionSetCurrent(1, 1, 0))
        field.until(Point(6, 0), 60.0)
        field.say(m.MissionSetCurrent(1, 1, 9))
        field.wait(0.5)
        assert said(field, "there is no item 9")

    def test_the_list_is_what_was_uploaded_and_can_be_cleared(self) -> None:
        field = ready(way(6, 0), way(0, 6))
        field.say(m.MissionRequestList(1, 1, MissionType.MISSION))
        assert field.newest(m.MissionCount).count == 2
        field.say(m.MissionClearAll(1, 1, MissionType.ALL))
        assert field.newest(m.MissionAck).type == MissionResult.ACCEPTED
        assert field.set_mode(Mode.AUTO) is Result.FAILED
        assert field.command(Command.MISSION_START) is Result.FAILED


class TestWhoMay:
    def test_start_needs_a_mission_arming_and_the_driver(self) -> None:
        field = Field()
        assert field.command(Command.MISSION_START) is Result.FAILED
        upload(field, way(6, 0))
        assert field.command(Command.MISSION_START) is Result.FAILED
        field.wait(0.5)
        assert said(field, "not armed")
        field.arm()
        assert field.command(Command.MISSION_START, system=OTHER) is Result.FAILED
        for wrong in (1, -1, NAN, 0.5):
            assert field.command(Command.MISSION_START, wrong) is Result.DENIED
        assert field.stands_for(1.0)

    def test_69_nobody_changes_the_mission_that_is_driven_nor_anothers(self) -> None:
        field = ready(way(30, 0))
        assert upload(field, way(1, 1), system=OTHER) == MissionResult.DENIED
        start(field)
        field.beat(2.0)
        assert upload(field, way(1, 1)) == MissionResult.DENIED
        field.say(m.MissionClearAll(1, 1, MissionType.MISSION))
        assert field.newest(m.MissionAck).type == MissionResult.DENIED
        field.beat(1.0)
        assert field.turning

    def test_69_an_upload_that_ends_when_auto_has_begun_changes_nothing(self) -> None:
        field = ready(way(30, 0))
        field.say(m.MissionCount(1, 1, 1, MissionType.MISSION))
        start(field)
        field.beat(2.0)
        latitude, longitude = GROUND.to_global(Point(1, 1))
        x, y = round(latitude * 1e7), round(longitude * 1e7)
        field.say(m.MissionItemInt(1, 1, 0, 6, Command.NAV_WAYPOINT, 0, 1, 0, 0, 0, 0, x, y, 0, MissionType.MISSION))
        assert field.newest(m.MissionAck).type == MissionResult.DENIED
        assert field.newest(m.MissionCurrent).total == 1
        field.beat(1.0)
        assert field.turning
        assert field.rover._navigator.goal(Mode.AUTO) == pytest.approx(Point(30, 0), abs=0.5)

    @pytest.mark.parametrize(
        ("item", "verdict"),
        [
            (do(NAV_TAKEOFF), MissionResult.UNSUPPORTED),
            (do(Command.DO_SET_SERVO, 1, 1500), MissionResult.INVALID_PARAM1),  # a motor
            (do(Command.DO_SET_SERVO, 5.5, 1500), MissionResult.INVALID_PARAM1),
            (do(Command.DO_SET_SERVO, 17, 1500), MissionResult.INVALID_PARAM1),
            (do(Command.DO_SET_SERVO, NAN, 1500), MissionResult.INVALID_PARAM1),
            (do(Command.DO_SET_SERVO, 5, 1e6), MissionResult.INVALID_PARAM2),
            (do(Command.DO_SET_RELAY, 0, 2), MissionResult.INVALID_PARAM2),
            (do(Command.DO_SET_RELAY, -1, 1), MissionResult.INVALID_PARAM1),
            (do(Command.DO_SET_RELAY, 0.5, 1), MissionResult.INVALID_PARAM1),
            (do(Command.DO_REPEAT_SERVO, 3, 1500, 2, 1), MissionResult.INVALID_PARAM1),  # a motor
            (do(Command.DO_REPEAT_SERVO, 9, 1500, 0, 1), MissionResult.INVALID_PARAM3),
            (do(Command.DO_REPEAT_SERVO, 9, 1500, 2, -1), MissionResult.INVALID_PARAM4),
            (do(Command.DO_REPEAT_RELAY, 16, 2, 1), MissionResult.INVALID_PARAM1),
            (do(Command.DO_REPEAT_RELAY, 0, NAN, 1), MissionResult.INVALID_PARAM2),
            (do(Command.DO_REPEAT_RELAY, 0, 2, NAN), MissionResult.INVALID_PARAM3),
            (do(Command.DO_JUMP, 7, 1), MissionResult.INVALID_PARAM1),
            (do(Command.NAV_DELAY, -1), MissionResult.INVALID_PARAM1),
            (do(Command.DO_CHANGE_SPEED, 1, NAN), MissionResult.INVALID_PARAM2),
            ((Command.NAV_WAYPOINT, None, ()), MissionResult.UNSUPPORTED_FRAME),
        ],
    )
    def test_what_it_cannot_do_is_refused_when_it_is_uploaded(self, item: Item, verdict: MissionResult) -> None:
        field = ready(way(5, 0))
        assert upload(field, way(1, 1), item) == verdict
        field.say(m.MissionRequestList(1, 1, MissionType.MISSION))
        assert field.newest(m.MissionCount).count == 1  # the old one stays

    @pytest.mark.parametrize(
        ("item", "why"),
        [
            (do(NAV_TAKEOFF), "item 1, command 22 not offered"),
            ((Command.NAV_WAYPOINT, None, ()), "item 1, frame 2 not offered"),
            (do(Command.NAV_DELAY, -1), "item 1, invalid param1"),
            (do(Command.DO_JUMP, 7, 1), "its items do not fit together"),
        ],
    )
    def test_the_driver_reads_which_item_was_refused(self, item: Item, why: str) -> None:
        field = Field()
        field.heartbeat()
        upload(field, way(1, 1), item)
        field.wait(0.1)
        assert said(field, f"Mission refused: {why}")

    @pytest.mark.parametrize(
        ("params", "result"), [((1, 1500), Result.DENIED), ((5, 1500), Result.DENIED), ((NAN, 1500), Result.DENIED)]
    )
    def test_a_motor_is_nobodys_servo(self, params: tuple[float, ...], result: Result) -> None:
        assert Field().command(Command.DO_SET_SERVO, *params) is result

    def test_arming_in_auto_moves_nothing_until_it_is_started(self) -> None:
        field = ready(way(30, 0))
        start(field)
        field.beat(2.0)
        assert field.turning
        field.command(Command.COMPONENT_ARM_DISARM, 0)
        field.arm()
        field.wait(0.1)
        assert field.mode is Mode.AUTO
        assert field.stands_for(3.0)
        start(field)
        field.beat(2.0)
        assert field.turning

    def test_the_drivers_stick_moves_nothing_in_auto(self) -> None:
        field = ready(way(30, 0))
        start(field)
        field.beat(3.0)
        field.command(Command.DO_PAUSE_CONTINUE, 0)
        field.wait(1.0, NEUTRAL)
        field.wait(1.0, AHEAD)
        assert not field.turning

    @pytest.mark.parametrize(("setting", "mode"), [(1, Mode.HOLD), (2, Mode.AUTO)])
    def test_without_its_ground_station_it_holds_or_goes_on_as_it_is_set(self, setting: int, mode: Mode) -> None:
        field = ready(way(60, 0), FS_GCS_ENABLE=setting)
        start(field)
        field.wait(8.0)
        assert field.mode is mode
        assert field.turning is (mode is Mode.AUTO)
