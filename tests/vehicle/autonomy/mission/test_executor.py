"""AUTO in a simulated field with noisy sensors: following lines, DO items, progress, who may start and change it."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, NEUTRAL, OTHER, said
from tests.vehicle.field import GROUND, Field
from tests.vehicle.missions import do, finish, passed, ready, start, upload, way
from vehicle.autonomy.mission.item_reached import SEND_COUNT
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import Leg

NAN = math.nan
NAV_TAKEOFF = 22


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


@pytest.mark.slow
def test_ten_minutes_stay_within_half_a_metre_of_the_lines() -> None:
    rounds = [way(place.north, place.east) for place in CORNERS[1:]]
    field = Field(seed=1)
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
    def test_do_items_count_as_reached(self) -> None:
        """Else a client that counts by them goes back and forth between them and MISSION_CURRENT."""
        speed = do(Command.DO_CHANGE_SPEED, 1, 0.7)
        field = ready(way(3, 0), speed, way(6, 0), do(Command.CONDITION_DISTANCE, 1.0), speed, way(9, 0))
        start(field)
        finish(field, 60.0)
        assert passed(field) == [0, 1, 2, 3, 4, 5]

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

    def test_condition_delay_delays_the_items_behind_it(self) -> None:
        field = ready(do(Command.CONDITION_DELAY, 6.0), do(Command.DO_CHANGE_SPEED, 1, 0.3, -1), way(20, 0))
        start(field)
        field.beat(5.0)
        assert field.speed > 0.6
        field.beat(3.0)
        assert field.speed == pytest.approx(0.3, abs=0.1)

    def test_return_to_launch_is_the_last_item(self) -> None:
        field = ready(way(6, 3), do(Command.NAV_RETURN_TO_LAUNCH), way(50, 50))
        start(field)
        field.until(Point(6, 3), 40.0)
        finish(field, 60.0)
        assert field.truth.distance(Point(0, 0)) < 0.8

    def test_70_an_endless_loop_of_do_jump_ends_the_mission(self) -> None:
        field = ready(do(Command.DO_JUMP, 1, -1), do(Command.DO_JUMP, 0, -1))
        start(field)
        field.wait(0.5)
        assert field.mode is Mode.HOLD
        assert said(field, "endless loop of DO_JUMP")

    def test_do_jump_repeats_as_often_as_its_parameter(self) -> None:
        field = ready(way(4, 0), way(4, 4), do(Command.DO_JUMP, 0, 2), way(0, 4))
        start(field)
        finish(field, 120.0)
        assert passed(field) == [0, 1, 0, 1, 0, 1, 3]

    def test_items_for_missing_accessories_are_reported_and_skipped(self) -> None:
        field = ready(do(Command.DO_SET_SERVO, 5, 1500), do(Command.DO_SET_RELAY, 0, 1), way(5, 0))
        field.wait(0.2)
        words = "Mission: no accessory for items 0, 1, will be skipped: there is no servo 5, there is no relay 0"
        assert said(field, words)
        start(field)
        finish(field, 40.0)
        assert field.truth.distance(Point(5, 0)) < 0.7
        assert said(field, "Mission: skipped DO_SET_SERVO 5: there is no servo 5")
        assert said(field, "Mission: skipped DO_SET_RELAY 0: there is no relay 0")

    def test_a_mission_can_restore_the_default_speed(self) -> None:
        field = ready(
            do(Command.DO_CHANGE_SPEED, 1, 0.3, -1), way(4, 0), do(Command.DO_CHANGE_SPEED, 1, -2, -1), way(20, 0)
        )
        start(field)
        field.until(Point(2.5, 0), 40.0, 1.0)
        assert field.speed == pytest.approx(0.3, abs=0.1)
        field.until(Point(12, 0), 40.0, 1.0)
        assert field.speed == pytest.approx(0.8, abs=0.1)

    def test_a_mission_can_enable_the_fence(self) -> None:
        field = ready(do(Command.DO_FENCE_ENABLE, 1), way(5, 0), way(30, 0), FENCE_TYPE=2, FENCE_RADIUS=8)
        start(field)
        finish(field, 60.0)
        assert said(field, "outside the fence: HOLD")
        assert field.truth.north < 10.0

    def test_a_mission_ends_if_the_settings_file_disables_the_fence(self) -> None:
        field = ready(way(2, 0), do(Command.DO_FENCE_ENABLE, 1), way(20, 0))
        field.rover._params.pinned = frozenset({"FENCE_ENABLE"})
        start(field)
        finish(field, 60.0)
        assert said(field, "AUTO: the configuration file sets FENCE_ENABLE 0: HOLD")
        assert 1.0 < field.truth.north < 5.0
        assert field.rover._params["FENCE_ENABLE"] == 0

    def test_the_reason_for_the_end_at_the_last_item_is_reported(self) -> None:
        field = ready(way(2, 0), do(Command.DO_FENCE_ENABLE, 1))
        field.rover._params.pinned = frozenset({"FENCE_ENABLE"})
        start(field)
        finish(field, 60.0)
        assert said(field, "AUTO: the configuration file sets FENCE_ENABLE 0: HOLD")


class TestProgress:
    def test_auto_resumes_after_hold_and_a_finished_mission_restarts(self) -> None:
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

    def test_the_plan_ids_are_sent_at_once_and_periodically(self) -> None:
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

    def test_an_item_chosen_by_command_is_reported_to_all(self) -> None:
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
    def test_jump_counters_are_reset_only_on_request(self, anew: float, again: int) -> None:
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

    def test_69_a_running_or_foreign_mission_cannot_be_changed(self) -> None:
        field = ready(way(30, 0))
        assert upload(field, way(1, 1), system=OTHER) == MissionResult.DENIED
        start(field)
        field.beat(2.0)
        assert upload(field, way(1, 1)) == MissionResult.DENIED
        field.say(m.MissionClearAll(1, 1, MissionType.MISSION))
        assert field.newest(m.MissionAck).type == MissionResult.DENIED
        field.beat(1.0)
        assert field.turning

    def test_69_an_upload_completed_after_auto_has_begun_is_rejected(self) -> None:
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

    def test_manual_control_moves_nothing_in_auto(self) -> None:
        field = ready(way(30, 0))
        start(field)
        field.beat(3.0)
        field.command(Command.DO_PAUSE_CONTINUE, 0)
        field.wait(1.0, NEUTRAL)
        field.wait(1.0, AHEAD)
        assert not field.turning

    @pytest.mark.parametrize(("setting", "mode"), [(1, Mode.HOLD), (2, Mode.AUTO)])
    def test_auto_holds_or_continues_without_a_ground_station(self, setting: int, mode: Mode) -> None:
        field = ready(way(60, 0), FS_GCS_ENABLE=setting)
        start(field)
        field.wait(8.0)
        assert field.mode is mode
        assert field.turning is (mode is Mode.AUTO)
