"""Stored parameters, restart, banner: bad input 57, and the exit codes of a real process."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionType, Result
from link.tlog.tlog import encode_record, read_records
from tests.vehicle.bench import AHEAD, DRIVER, OTHER, Bench, said
from tests.vehicle.field import Field
from tests.vehicle.ground import Ground, drive, running
from tests.vehicle.missions import send, way
from tests.vehicle.storage.test_plan_store import SlowDisk, field_with
from vehicle.commands.reboot import RebootRequest
from vehicle.navigation.geo import Point
from vehicle.params import Params, merge_params
from vehicle.rover import Rover
from vehicle.runtime.shutdown import Shutdown
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore

REBOOT, STORAGE = Command.PREFLIGHT_REBOOT_SHUTDOWN, Command.PREFLIGHT_STORAGE
NAN = math.nan


class TestReboot:
    def test_without_the_setting_it_is_denied(self) -> None:
        bench = Bench()
        for wish in ((1, 0), (0, 1), (0, 2)):
            assert bench.command(REBOOT, *wish) is Result.DENIED
        bench.wait(2.0)
        assert bench.rover.reboot_request(bench.now) is None

    @pytest.mark.parametrize("enabled", [0, 2])
    def test_57_while_armed_it_fails(self, enabled: float) -> None:
        bench = Bench(REBOOT_ENABLE=enabled)
        bench.drive()
        assert bench.command(REBOOT, 1, 0, 0, 0, 0, 20190226) is Result.FAILED
        bench.wait(1.0, AHEAD)
        assert bench.turning
        assert bench.rover.reboot_request(bench.now) is None
        assert said(bench, "PREFLIGHT_REBOOT_SHUTDOWN refused: armed")

    @pytest.mark.parametrize(
        ("wish", "leave"),
        [
            ((1, 0), RebootRequest.RESTART),
            ((0, 1), RebootRequest.REBOOT),
            ((1, 1), RebootRequest.REBOOT),
            ((0, 2), RebootRequest.POWER_OFF),
            ((1, 2), RebootRequest.POWER_OFF),
            ((1, *(NAN,) * 6), RebootRequest.RESTART),  # MAVSDK 4
            ((2, *(NAN,) * 6), RebootRequest.POWER_OFF),
            ((1, 1, 1, 1), RebootRequest.REBOOT),  # MAVSDK before
            ((2, 2, 2, 2), RebootRequest.POWER_OFF),
            ((0, 0, 1, 0), RebootRequest.RESTART),  # all components
            ((0, 0, 2, 1), RebootRequest.POWER_OFF),  # this one
            ((1, 0, 1, 100), RebootRequest.RESTART),  # a camera that we have not
        ],
    )
    def test_first_the_answer_then_the_end(self, wish: tuple[float, ...], leave: RebootRequest) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        assert bench.command(REBOOT, *wish) is Result.ACCEPTED
        assert bench.rover.reboot_request(bench.now) is None
        bench.wait(0.3)
        assert bench.command(REBOOT, *wish) is Result.ACCEPTED  # its answer was lost: the same end
        bench.wait(0.22)
        assert bench.rover.reboot_request(bench.now) is leave
        assert said(bench, f"GCS {DRIVER}: {leave.label}")

    @pytest.mark.parametrize(
        "wish",
        [
            (0, 0),
            (3, 0),
            (1, 3),
            (2, 1),
            (NAN, 0),
            (NAN,) * 7,
            (0.5, 0),
            (-1, 0),
            (math.inf, 0),
            (0, 0, 1, 100),
            (0, 0, 3, 0),
            (1, 0, 2, 1),
            (2, 0, 1, 0),
        ],
    )
    def test_what_is_not_offered_is_denied(self, wish: tuple[float, ...]) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        assert bench.command(REBOOT, *wish) is Result.DENIED
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None

    def test_the_setting_may_allow_the_program_only(self) -> None:
        bench = Bench(REBOOT_ENABLE=1)
        assert bench.command(REBOOT, 0, 1) is Result.DENIED
        assert bench.command(REBOOT, 2) is Result.DENIED
        assert said(bench, "PREFLIGHT_REBOOT_SHUTDOWN refused: REBOOT_ENABLE is 1")
        assert bench.command(REBOOT, 1, 0) is Result.ACCEPTED

    def test_who_arms_in_time_keeps_it(self) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        bench.command(REBOOT, 1)
        bench.arm()
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        bench.wait(1.0)
        assert bench.rover.reboot_request(bench.now) is None
        assert said(bench, "Armed: no restart")

    def test_only_who_is_in_control_may(self) -> None:
        bench = Bench(REBOOT_ENABLE=2)
        bench.arm()
        bench.command(Command.COMPONENT_ARM_DISARM, 0)
        assert bench.command(REBOOT, 1, system=OTHER) is Result.FAILED
        assert bench.command(REBOOT, 1, introduced=False) is Result.FAILED
        assert bench.command(REBOOT, 1, target=0) is None
        assert bench.command(REBOOT, 1) is Result.ACCEPTED

    def test_no_ground_station_sets_the_setting(self) -> None:
        bench = Bench()
        bench.heartbeat()
        bench.say(m.ParamSet(1, 1, b"REBOOT_ENABLE", 2, 9))
        assert bench.newest(m.ParamValue).param_value == 0


@pytest.mark.e2e
@pytest.mark.parametrize(("wish", "code"), [((1, 0), 80), ((0, 1), 81), ((0, 2), 82)])
def test_the_process_ends_with_the_code_that_says_what_is_wanted(
    tmp_path: Path, wish: tuple[float, float], code: int
) -> None:
    words = ("--param", "REBOOT_ENABLE=2", "--param", "FS_DISARM_T=300")
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint, *words) as vehicle:
        vehicle.ready()
        drive(ground, vehicle)
        ask(ground, REBOOT, *wish, until=lambda: Result.FAILED in answers(ground, REBOOT))
        ground.wait(vehicle.turning, "they turn still")
        ground.demand = None
        ask(ground, Command.COMPONENT_ARM_DISARM, until=lambda: not ground.armed and not vehicle.turning())
        ask(ground, REBOOT, *wish, until=lambda: vehicle.process.poll() is not None)
        ended, lines = vehicle.ended()
        assert ended == code
        assert lines[-1] == f"vehicle: {RebootRequest(code).label} as a ground station asked, motors neutral"
        ground.drain()
        assert answers(ground, REBOOT)[-1] == Result.ACCEPTED


def ask(ground: Ground, command: int, *params: float, until: Callable[[], bool]) -> None:
    """Again and again, as clients do."""
    one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))

    def over() -> bool:
        ground.say(m.CommandLong(1, 1, command, 0, one, two, three, four, five, six, seven))
        return until()

    ground.wait(over, f"what {command} is for")


def answers(ground: Ground, command: int) -> list[int]:
    return [each.result for each in ground.heard if isinstance(each, m.CommandAck) and each.command == command]


def test_a_signal_that_came_first_decides_the_code() -> None:
    ended: list[str] = []

    class Nothing:
        def shutdown(self, now: float) -> None:
            ended.append("motors")

        def stop(self) -> None:
            ended.append("links")

    import asyncio

    async def both() -> int:
        ending = Shutdown(Nothing(), Nothing())  # type: ignore[arg-type]
        ending._end("stopped by SIGTERM")
        ending.handle_reboot_request(RebootRequest.POWER_OFF)
        return ending._code

    assert asyncio.run(both()) == 0
    assert ended == ["motors", "links"]


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
        assert said(bench, "Parameters: 2 back to their defaults")
        assert bench.command(STORAGE, 4) is Result.ACCEPTED

    def test_reset_reaches_what_is_kept_and_leaves_what_the_file_pins(self) -> None:
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

    def test_reset_leaves_what_this_run_was_given_and_keeps_its_default(self) -> None:
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
        assert said(bench, "Parameters: 2 back to their defaults")

    def test_what_is_set_is_kept_already(self) -> None:
        store = MemoryStore()
        bench = Bench()
        assert bench.command(STORAGE, 1) is Result.FAILED
        assert said(bench, "PREFLIGHT_STORAGE refused: nothing is kept in this run")
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

    def test_plans_are_saved_once_more_where_the_disk_did_not_take_them(self) -> None:
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


def test_the_banner() -> None:
    bench = Bench(DRIVE_TYPE=2)
    assert bench.command(Command.DO_SEND_BANNER, introduced=False) is Result.TEMPORARILY_REJECTED
    assert bench.texts == []
    assert bench.command(Command.DO_SEND_BANNER, system=OTHER) is Result.ACCEPTED
    bench.wait(0.1)
    assert bench.texts == ["mavhelm 0.1.0, ackermann drive, mode MANUAL"]


class TestSigning:
    KEY = bytes(range(32))

    def test_it_is_told_once_and_never_repeated_back(self) -> None:
        bench = Bench()
        bench.heartbeat()
        sent = len(bench.sent)
        for _ in range(5):
            bench.say(m.SetupSigning(1, 1, self.KEY, 1))
            bench.wait(1.0)
        assert bench.texts == ["Signing is not offered: the key was not used"]
        assert not any(isinstance(each, m.SetupSigning) for each in bench.sent[sent:])

    def test_for_another_vehicle_it_is_not_ours(self) -> None:
        bench = Bench()
        bench.say(m.SetupSigning(2, 1, self.KEY, 1))
        bench.wait(0.1)
        assert bench.texts == []

    def test_its_key_is_in_no_telemetry_log(self) -> None:
        from dialects import codec

        message = m.SetupSigning(1, 1, self.KEY, 1)
        frame = codec.frame(message.id, codec.encode_payload(message), 0, 255, 190)
        beat = codec.frame(0, codec.encode_payload(m.Heartbeat(6, 8, 0, 0, 4, 3)), 1, 255, 190)
        kept = encode_record(1_000_000, beat) + encode_record(1_000_001, frame) + encode_record(1_000_002, beat)
        assert self.KEY not in kept
        assert [each.raw for each in read_records(kept)] == [beat, beat]
