"""PREFLIGHT_STORAGE: parameters reset, plans erased, and either saved again."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionType, Result
from tests.vehicle.bench import OTHER, Bench, said
from tests.vehicle.field import Field
from tests.vehicle.missions import send, way
from tests.vehicle.storage.test_plan_store import SlowDisk, field_with
from vehicle.config.merge import merge_params
from vehicle.navigation.geo import Point
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore

STORAGE = Command.PREFLIGHT_STORAGE
NAN = math.nan


class MemoryStore(ParamStore):
    is_volatile = False
    problem: str | None = None
    idle = True

    def __init__(self) -> None:
        super().__init__()
        self.saved = 0

    def set(self, name: str, value: float) -> None:
        self.values[name] = value

    def save(self) -> None:
        self.saved += 1


PLANS = {
    MissionType.MISSION: (way(5, 0),),
    MissionType.FENCE: ((FenceItem.CIRCLE_INCLUSION, Point(0, 0), (50.0,)),),
    MissionType.RALLY: ((FenceItem.RALLY_POINT, Point(1, 1), ()),),
}


def stocked(disk: SlowDisk | None = None) -> Field:
    """With a plan of each kind, and a parameter that was set."""
    field = field_with(disk, MAN_DEADBAND=10) if disk else Field(MAN_DEADBAND=10)
    for kind, items in PLANS.items():
        send(field, *items, kind=kind)
        if disk:
            disk.end()
            field.wait(0.1)
    assert lengths(field) == [1, 1, 1]
    return field


def lengths(field: Field) -> list[int]:
    """Of mission, fence and rally points."""
    for kind in PLANS:
        field.say(m.MissionRequestList(1, 1, kind))
    return [each.count for each in field.all(m.MissionCount)[-3:]]


class TestStorage:
    def test_reset_gives_the_defaults_tells_and_keeps_them(self) -> None:
        bench = Bench(MAN_DEADBAND=10, WP_SPEED=2, DRIVE_TYPE=2)
        assert bench.command(STORAGE, 2, -1) is Result.ACCEPTED
        bench.wait(0.1)
        told = {each.param_id: each.param_value for each in bench.all(m.ParamValue)}
        assert told == {"MAN_DEADBAND": 3.0, "WP_SPEED": pytest.approx(0.8)}
        assert bench.rover._params["DRIVE_TYPE"] == 2  # belongs to the hardware
        assert said(bench, "Parameters: 2 reset to defaults")
        assert bench.command(STORAGE, 4) is Result.ACCEPTED

    def test_reset_reaches_stored_values_and_leaves_what_file_pins(self) -> None:
        store, params = MemoryStore(), Params(pinned=["WP_SPEED"])
        params.set("WP_SPEED", 2)
        params.set("MAN_DEADBAND", 10)
        bench = Bench()
        bench.rover = Rover(params, now=bench.now, param_store=store)
        bench.wait(0.1)
        assert bench.command(STORAGE, 2) is Result.ACCEPTED
        assert store.values == {"MAN_DEADBAND": 3.0}
        assert params["WP_SPEED"] == 2

    def test_reset_goes_back_to_what_is_usual_for_this_car(self) -> None:
        params = Params(usual={"MOT1_MIN": 50, "MOT1_MAX": 80})
        params.set("MOT1_MIN", 5)
        params.set("MOT1_MAX", 30)  # 50 does not fit below it
        bench = Bench()
        bench.rover = Rover(params, now=bench.now)
        bench.wait(0.1)
        assert bench.command(STORAGE, 2) is Result.ACCEPTED
        assert (params["MOT1_MIN"], params["MOT1_MAX"]) == (50, 80)

    def test_reset_leaves_values_of_this_run_and_keeps_their_default(self) -> None:
        """FS_LOOP_TIMEOUT of a simulation, which runs on a desktop."""
        store, given = MemoryStore(), {"FS_LOOP_TIMEOUT": 1.0, "WP_SPEED": 2.0}
        store.values = {"WP_SPEED": 1.5}
        params, _ = merge_params(given, kept=store.values, usual={}, run=given)
        bench = Bench()
        bench.rover = Rover(params, now=bench.now, param_store=store)
        bench.wait(0.1)
        params.set("FS_LOOP_TIMEOUT", 0.5)
        params.set("MAN_DEADBAND", 10)
        assert bench.command(STORAGE, 2) is Result.ACCEPTED
        assert (params["FS_LOOP_TIMEOUT"], params["WP_SPEED"], params["MAN_DEADBAND"]) == (1.0, 2.0, 3.0)
        assert store.values == {"FS_LOOP_TIMEOUT": 0.2, "WP_SPEED": 0.8, "MAN_DEADBAND": 3.0}
        assert said(bench, "Parameters: 2 reset to defaults")

    def test_what_is_set_is_kept_already(self) -> None:
        store = MemoryStore()
        bench = Bench()
        assert bench.command(STORAGE, 1) is Result.FAILED
        assert said(bench, "PREFLIGHT_STORAGE refused: nothing is saved in this run")
        bench.rover = Rover(Params(), now=bench.now, param_store=store)
        bench.wait(0.1)
        assert bench.command(STORAGE, 1, NAN) is Result.ACCEPTED
        assert bench.command(STORAGE, 0) is Result.ACCEPTED
        assert store.saved == 1
        store.problem = "No space left on device"
        assert bench.command(STORAGE, 1) is Result.FAILED
        assert store.saved == 2  # tried again
        assert said(bench, "PREFLIGHT_STORAGE refused: No space left on device")

    def test_a_damaged_file_is_not_made_good_by_saving_nothing(self, tmp_path: Path) -> None:
        (tmp_path / "parameters").write_text("SPEED_MAX = 2.5")
        store, params, bench = ParamStore(FileWriter(tmp_path)), Params(), Bench()
        params.mark_damaged(store.damage)
        bench.rover = Rover(params, now=bench.now, param_store=store)
        bench.wait(0.1)
        assert bench.command(STORAGE, 1) is Result.FAILED
        assert said(bench, "PREFLIGHT_STORAGE refused: parameter file damaged; set one to go on")
        store.close()
        assert ParamStore(FileWriter(tmp_path)).damage == "parameter file damaged"

    @pytest.mark.parametrize("wish", [(3,), (5,), (-2,), (math.inf,), (0.5,), (0, 3), (0, 4), (2, 7), (0, 0, 100)])
    def test_what_is_not_offered_is_denied(self, wish: tuple[float, ...]) -> None:
        bench = Bench(MAN_DEADBAND=10)
        assert bench.command(STORAGE, *wish) is Result.DENIED
        assert bench.rover._params["MAN_DEADBAND"] == 10

    @pytest.mark.parametrize("wish", [(0,), (-1, -1, -1), (NAN,) * 7, (0, 0, 1)])
    def test_what_means_nothing_changes_nothing(self, wish: tuple[float, ...]) -> None:
        field = stocked()
        assert field.command(STORAGE, *wish) is Result.ACCEPTED
        assert field.rover._params["MAN_DEADBAND"] == 10
        assert lengths(field) == [1, 1, 1]

    def test_plans_are_erased_all_three_and_parameters_stay(self) -> None:
        field = stocked()
        assert field.command(STORAGE, -1, 2) is Result.ACCEPTED
        assert lengths(field) == [0, 0, 0]
        field.wait(0.1)
        current = field.newest(m.MissionCurrent)
        assert (current.mission_id, current.fence_id, current.rally_points_id) == (0, 0, 0)
        assert field.rover._params["MAN_DEADBAND"] == 10

    def test_nobody_erases_what_somebody_uploads(self) -> None:
        field = stocked()
        field.say(m.MissionCount(1, 1, 2, MissionType.RALLY))
        assert field.command(STORAGE, 2, 2) is Result.TEMPORARILY_REJECTED
        assert lengths(field) == [1, 1, 1]
        assert field.rover._params["MAN_DEADBAND"] == 10

    def test_erasing_lasts_until_the_disk_has_it(self) -> None:
        field = stocked(disk := SlowDisk())
        assert field.command(STORAGE, 2, 2) is Result.IN_PROGRESS
        field.wait(1.0)
        assert lengths(field) == [1, 1, 1]
        disk.end()
        field.wait(0.1)
        assert field.newest(m.CommandAck).result == Result.ACCEPTED
        assert lengths(field) == [0, 0, 0]
        assert set(disk.plans.values()) == {()}

    def test_erasing_fails_with_the_disk(self) -> None:
        field = stocked(disk := SlowDisk())
        assert field.command(STORAGE, -1, 2) is Result.IN_PROGRESS
        disk.end("No space left on device")
        field.wait(0.1)
        disk.end()  # what was there before, once more
        field.wait(1.0)
        assert field.newest(m.CommandAck).result == Result.FAILED
        assert said(field, "Mission not changed, it could not be saved: No space left on device")
        assert said(field, "PREFLIGHT_STORAGE refused: the plans could not be erased")
        assert lengths(field) == [1, 1, 1]

    def test_plans_are_saved_again_where_the_disk_did_not_take_them(self) -> None:
        field = stocked(disk := SlowDisk())
        before = dict(disk.plans)
        disk.plans.clear()
        disk.problem = "No space left on device"
        assert field.command(STORAGE, -1, 1) is Result.IN_PROGRESS
        disk.end()
        field.wait(0.1)
        assert field.newest(m.CommandAck).result == Result.ACCEPTED
        assert disk.plans == before

    def test_a_disk_that_does_not_answer_is_a_failure(self) -> None:
        field = stocked(SlowDisk())
        assert field.command(STORAGE, -1, 2) is Result.IN_PROGRESS
        field.wait(9.0)
        assert field.newest(m.CommandAck).result == Result.FAILED
        assert lengths(field) == [1, 1, 1]

    def test_where_nothing_is_kept_plans_are_not_saved(self) -> None:
        assert stocked().command(STORAGE, -1, 1) is Result.FAILED

    def test_while_armed_it_is_rejected_for_now(self) -> None:
        bench = Bench(MAN_DEADBAND=10)
        bench.drive()
        assert bench.command(STORAGE, 2) is Result.TEMPORARILY_REJECTED
        assert bench.rover._params["MAN_DEADBAND"] == 10

    def test_only_who_is_in_control_may(self) -> None:
        bench = Bench(MAN_DEADBAND=10)
        bench.arm()
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        assert bench.command(STORAGE, 2, system=OTHER) is Result.FAILED
        assert bench.rover._params["MAN_DEADBAND"] == 10
