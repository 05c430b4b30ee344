"""Kept plans: the same after a restart and kill -9, and what follows where one was damaged."""

from __future__ import annotations

import errno
import math
import os
import time
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavwp

from dialects import messages as m
from dialects.enums import Command, FenceItem, MissionResult, MissionType, Result
from dialects.modes import Mode
from link.core import Peer, Received
from link.services.mission.client import MissionClient, MissionOutcome
from link.services.mission.items import Items, MissionItem
from link.services.mission.plans import plan_id
from tests.link.mission_rig import plain
from tests.vehicle.bench import CYCLE, said
from tests.vehicle.field import Field
from tests.vehicle.ground import Ground, running
from tests.vehicle.missions import Item, do, send, upload, way
from vehicle.pace import PERIOD
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.plan_store import PlanStore
from vehicle.storage.store import PendingWrite

FORCE = 21196
MISSION, FENCE, RALLY = MissionType.MISSION, MissionType.FENCE, MissionType.RALLY


def item(
    number: int = 0, command: int = Command.NAV_WAYPOINT, params: tuple[float, ...] = (0.0, 0.0, 0.0)
) -> MissionItem:
    one, two, three = params
    return MissionItem(int(command), 6, (one, two, three, math.nan), 500000000 + number, 80000000, 0.125)


PLANS: dict[MissionType, Items] = {
    MISSION: (item(1), item(2, params=(3.5, 0.0, 0.0))),
    FENCE: (item(3, FenceItem.CIRCLE_INCLUSION, (50.0, 0.0, 0.0)),),
    RALLY: (item(4, FenceItem.RALLY_POINT),),
}


def kept(folder: Path, plans: dict[MissionType, Items]) -> PlanStore:
    store = PlanStore(FileWriter(folder))
    for kind, items in plans.items():
        store.save(kind, items)
    store.close()
    return store


class MemoryStore(PlanStore):
    """A store in memory."""

    is_volatile = False
    problem: str | None = None
    idle = True

    def __init__(self, plans: dict[MissionType, Items] | None = None, **damage: str) -> None:
        super().__init__()
        self.plans = plans or {}
        self.damage = {MissionType[kind.upper()]: why for kind, why in damage.items()}

    def save(self, kind: MissionType, items: Items) -> PendingWrite:
        self.plans[kind] = items
        return PendingWrite(done=True)


class SlowDisk(MemoryStore):
    """Writes when it is told to."""

    def __init__(self) -> None:
        super().__init__()
        self.requests: list[tuple[MissionType, Items, PendingWrite]] = []

    def save(self, kind: MissionType, items: Items) -> PendingWrite:
        self.idle = False
        self.requests.append((kind, items, PendingWrite()))
        return self.requests[-1][2]

    def end(self, problem: str | None = None) -> None:
        """All that waits is there now, or the last of it is not."""
        for kind, items, request in self.requests:
            request.done, request.problem = True, problem
            if problem is None:
                self.plans[kind] = items
        self.requests, self.idle, self.problem = [], True, problem


def field_with(store: MemoryStore, **params: float) -> Field:
    class StoringField(Field):
        plans = store

    return StoringField(**params)  # type: ignore[arg-type]


def field_that_kept(item: Item, disk: SlowDisk) -> tuple[Field, MissionItem]:
    """A mission of one item, in force and on the disk."""
    field = field_with(disk)
    send(field, item)
    disk.end()
    field.wait(0.1)
    (kept,) = disk.plans[MISSION]
    return field, kept


# ---- the store ----


def test_a_first_start_has_nothing_and_no_damage(tmp_path: Path) -> None:
    store = PlanStore(FileWriter(tmp_path / "not" / "there"))
    assert (store.plans, store.damage, store.problem) == ({MISSION: (), FENCE: (), RALLY: ()}, {}, None)
    store.close()


def test_plans_survive_a_restart_to_the_last_digit(tmp_path: Path) -> None:
    kept(tmp_path, PLANS)
    store = PlanStore(FileWriter(tmp_path))
    assert {kind: plain(items) for kind, items in store.plans.items()} == {
        kind: plain(items) for kind, items in PLANS.items()
    }
    assert store.damage == {}
    kept(tmp_path, {MISSION: ()})
    assert PlanStore(FileWriter(tmp_path)).plans[MISSION] == ()
    assert sorted(os.listdir(tmp_path)) == ["fence.waypoints", "mission.waypoints", "rally.waypoints"]


def test_other_tools_read_the_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MAVLINK20", raising=False)  # set by other tests, after mavutil has chosen its dialect
    kept(tmp_path, PLANS)
    loader: Any = mavwp.MAVWPLoader()  # type: ignore[no-untyped-call]
    assert loader.load(str(tmp_path / "mission.waypoints")) == 2
    assert loader.wp(1).param1 == 3.5


@pytest.mark.parametrize("harm", [lambda data: data[:-20], lambda data: data.replace(b"16", b"17"), lambda data: b""])
def test_a_damaged_plan_is_kept_aside_until_a_good_one(tmp_path: Path, harm: Any) -> None:
    kept(tmp_path, PLANS)
    file = tmp_path / "mission.waypoints"
    file.write_bytes(harm(file.read_bytes()))
    for _ in range(2):  # a restart does not make it good
        store = PlanStore(FileWriter(tmp_path))
        assert store.damage == {MISSION: "saved mission damaged"}
        assert MISSION not in store.plans
        assert len(store.plans[FENCE]) == 1
        assert (tmp_path / "mission.waypoints.damaged").exists()
    kept(tmp_path, {MISSION: ()})
    assert PlanStore(FileWriter(tmp_path)).damage == {}


def test_a_plan_that_cannot_be_read_is_damage_too(tmp_path: Path) -> None:
    (tmp_path / "fence.waypoints").mkdir()
    assert PlanStore(FileWriter(tmp_path)).damage == {FENCE: "saved fence cannot be read, Is a directory"}


def test_a_full_disk_is_a_problem_and_the_old_plan_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    kept(tmp_path, PLANS)

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr(os, "fsync", full)
        assert kept(tmp_path, {MISSION: ()}).problem == "No space left on device"
    assert len(PlanStore(FileWriter(tmp_path)).plans[MISSION]) == 2


# ---- the vehicle ----


def test_kept_plans_are_in_force_with_their_ids() -> None:
    bench = field_with(MemoryStore(PLANS))
    bench.wait(1.1)
    told = bench.newest(m.MissionCurrent)
    ids = tuple(plan_id(items) for items in PLANS.values())
    assert (told.mission_id, told.fence_id, told.rally_points_id) == ids
    assert told.total == 2
    for kind in PLANS:
        bench.say(m.MissionRequestList(1, 1, kind))
        assert bench.newest(m.MissionCount).opaque_id == plan_id(PLANS[kind])


def test_what_is_uploaded_cleared_or_written_as_a_file_is_kept() -> None:
    memory = MemoryStore()
    field = field_with(memory)
    upload(field, way(5, 0))
    assert [each.command for each in memory.plans[MISSION]] == [Command.NAV_WAYPOINT]
    field.say(m.MissionClearAll(1, 1, MISSION))
    assert memory.plans[MISSION] == ()


def test_a_slow_disk_delays_the_answer_and_the_plan() -> None:
    field = field_with(disk := SlowDisk())
    before = len(field.all(m.MissionAck))
    send(field, way(5, 0))
    field.wait(3.0)
    assert field.all(m.MissionAck)[before:] == []
    assert field.newest(m.MissionCurrent).mission_id == 0
    disk.end()
    field.wait(PERIOD + 3 * CYCLE)
    (answer,) = field.all(m.MissionAck)[before:]
    assert (answer.type, answer.opaque_id) == (0, field.newest(m.MissionCurrent).mission_id)
    assert answer.opaque_id != 0


def test_a_disk_that_refuses_leaves_the_old_plan_in_force() -> None:
    field, first = field_that_kept(way(5, 0), disk := SlowDisk())
    send(field, way(7, 0))
    disk.end("No space left on device")
    field.wait(0.1)
    assert field.newest(m.MissionAck).type == MissionResult.ERROR
    assert said(field, "Mission not changed, it could not be saved: No space left on device")
    assert [items for _, items, _ in disk.requests] == [(first,)]  # written back, in case
    field.say(m.MissionRequestInt(1, 1, 0, 0))
    assert field.newest(m.MissionItemInt).x == first.x


def test_drive_begun_by_old_plan_goes_on_by_it_during_a_write() -> None:
    field, first = field_that_kept(way(30, 0), disk := SlowDisk())
    send(field, way(0, 30))
    field.begin(Mode.AUTO)
    disk.end()
    field.wait(0.1)
    assert field.newest(m.MissionAck).type == MissionResult.DENIED
    assert said(field, "mission not changed: AUTO drives by it")
    disk.end()
    assert disk.plans[MISSION] == (first,)
    field.beat(5.0)
    assert field.truth.north > 1.0


def test_a_failed_upload_does_not_mend_a_damaged_fence() -> None:
    disk = SlowDisk()
    disk.damage[FENCE] = "saved fence damaged"
    field = field_with(disk, FENCE_ENABLE=1)
    send(field, kind=FENCE)
    disk.end("No space left on device")
    field.wait(0.1)
    assert disk.requests == []
    assert field.arm() is Result.FAILED


def test_plans_that_cannot_be_kept_are_told() -> None:
    memory = MemoryStore()
    memory.problem = "No space left on device"
    bench = field_with(memory)
    bench.wait(1.0)
    assert said(bench, "Plans are not saved: No space left on device")


def test_a_damaged_mission_forbids_auto_and_nothing_else() -> None:
    field = field_with(MemoryStore(mission="saved mission damaged"))
    assert said(field, "Saved mission damaged: upload it again")
    assert field.arm() is Result.ACCEPTED
    assert field.set_mode(Mode.AUTO) is Result.FAILED
    assert said(field, "Mode AUTO refused: saved mission damaged")
    assert field.command(Command.MISSION_START) is Result.FAILED
    assert said(field, "MISSION_START refused: saved mission damaged")
    assert upload(field, way(5, 0)) == MissionResult.ACCEPTED
    assert field.set_mode(Mode.AUTO) is Result.ACCEPTED


def test_it_is_said_again_while_disarmed() -> None:
    bench = field_with(MemoryStore(rally="saved rally damaged"))

    def told() -> int:
        return sum("Saved rally damaged" in text for text in bench.texts)

    bench.wait(65.0)
    assert told() == 3
    assert bench.arm() is Result.ACCEPTED
    bench.wait(35.0)
    assert told() == 3


def test_a_damaged_fence_in_force_forbids_arming_also_by_force() -> None:
    field = field_with(MemoryStore(fence="saved fence damaged"), FENCE_ENABLE=1)
    assert field.arm() is Result.FAILED
    assert said(field, "PreArm: saved fence damaged, upload it again or set FENCE_ENABLE 0")
    assert field.command(Command.COMPONENT_ARM_DISARM, 1, FORCE) is Result.FAILED
    assert upload(field, kind=FENCE) == MissionResult.ACCEPTED  # to clear it is a decision too
    assert field.arm() is Result.ACCEPTED


def test_a_damaged_fence_not_in_force_only_cannot_be_turned_on() -> None:
    field = field_with(MemoryStore(fence="saved fence damaged"))
    assert field.arm() is Result.ACCEPTED
    assert field.command(Command.DO_FENCE_ENABLE, 1) is Result.FAILED
    assert said(field, "DO_FENCE_ENABLE refused: saved fence damaged")
    assert upload(field, do(Command.DO_FENCE_ENABLE, 1), way(30, 0)) == MissionResult.ACCEPTED
    assert field.command(Command.MISSION_START) is Result.ACCEPTED
    field.beat(1.0)
    assert field.mode is Mode.HOLD
    assert said(field, "AUTO: saved fence damaged")
    assert field.stands_for(1.0)


def test_a_plan_of_another_version_is_damage() -> None:
    field = field_with(MemoryStore({MISSION: (item(command=Command.NAV_RETURN_TO_LAUNCH), item(command=22))}))
    assert said(field, "Saved mission does not fit this version")
    assert field.newest(m.MissionCurrent).mission_id == 0
    assert field.set_mode(Mode.AUTO) is Result.FAILED


# ---- the daemon ----


def done(ground: Ground, client: MissionClient, *, good: bool = True) -> MissionOutcome:
    """Let a client do its job with a real vehicle."""
    outcomes: list[MissionOutcome] = []
    taken = len(ground.heard)

    def step() -> bool:
        nonlocal taken
        now, news = time.monotonic(), ground.heard[taken:]
        taken += len(news)
        for message in news:
            client.receive(Received(message, 1, 1, 0, Peer(0, "vehicle"), introduced=True), now)
        client.tick(now)
        for outgoing in client.messages_to_send():
            ground.say(outgoing.message)
        outcomes.extend(client.outcomes())
        return bool(outcomes)

    ground.wait(step, "the end of a mission job")
    assert outcomes[0].done is good
    return outcomes[0]


@pytest.mark.e2e
def test_plans_survive_kill_9(tmp_path: Path) -> None:
    state = tmp_path / "state"
    words = ("--sim", "--state", str(state))
    client = MissionClient(255, 190, target_system=1)
    ids = {}
    with Ground() as ground, running(tmp_path, *words, ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: bool(ground.heard), "the vehicle is there")
        for kind, items in PLANS.items():
            client.upload(items, kind, time.monotonic())
            ids[kind] = done(ground, client).plan_id
        vehicle.process.kill()  # at once: the answer to the last one says that it is on the disk
        vehicle.process.wait(60)
    with Ground() as ground, running(tmp_path, *words, ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: bool(ground.heard), "the vehicle is there again")
        for kind, items in PLANS.items():
            client.download(kind, time.monotonic())
            outcome = done(ground, client)
            assert outcome.plan_id == ids[kind] == plan_id(items)
            assert plan_id(outcome.items) == ids[kind]
            assert [each.command for each in outcome.items] == [each.command for each in items]
        ground.wait(lambda: any(isinstance(each, m.MissionCurrent) for each in ground.heard), "MISSION_CURRENT")
        [*_, current] = [each for each in ground.heard if isinstance(each, m.MissionCurrent)]
        assert (current.mission_id, current.fence_id, current.rally_points_id) == tuple(ids.values())


@pytest.mark.e2e
def test_a_plan_the_disk_refuses_is_refused_and_the_former_stays(tmp_path: Path) -> None:
    client = MissionClient(255, 190, target_system=1)
    with Ground() as ground, running(tmp_path, "--sim", "--state", "/proc/no/such", ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: bool(ground.heard), "the vehicle is there")
        client.upload(PLANS[MISSION], MISSION, time.monotonic())
        assert done(ground, client, good=False).result == MissionResult.ERROR
        text = "Mission not changed, it could not be saved: No such file or directory"
        ground.wait(lambda: text in "".join(ground.texts()), "the driver is told")
        client.download(MISSION, time.monotonic())
        assert done(ground, client).items == ()


@pytest.mark.e2e
def test_without_a_folder_nothing_is_kept(tmp_path: Path) -> None:
    client = MissionClient(255, 190, target_system=1)
    with Ground() as ground, running(tmp_path, "--sim", ground.endpoint) as vehicle:
        vehicle.ready()
        ground.wait(lambda: bool(ground.heard), "the vehicle is there")
        client.upload(PLANS[MISSION], MISSION, time.monotonic())
        assert done(ground, client).plan_id == plan_id(PLANS[MISSION])
        vehicle.process.terminate()
        assert vehicle.ended()[0] == 0
    assert not list(tmp_path.rglob("*.waypoints"))
