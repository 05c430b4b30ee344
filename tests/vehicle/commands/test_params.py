"""Parameters over the link: who may set which, what is locked while armed, and what is kept."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from dialects import messages as m
from dialects.enums import Command, ParamErrorCode, Result
from link.core import LinkReport, Peer
from tests.rows import each_row
from tests.vehicle.bench import CYCLE, DRIVER, OTHER, Bench, said
from vehicle.params import TABLE, Parameter, Params
from vehicle.rover import Rover
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.param_store import ParamStore

NAMES = [parameter.name for parameter in TABLE]
REAL32 = 9


class Memory(ParamStore):
    """A store in memory."""

    is_volatile = False
    problem: str | None = None
    idle = True

    def __init__(self) -> None:
        super().__init__()
        self.kept: dict[str, float] = {}
        self.saves = 0

    def set(self, name: str, value: float) -> None:
        self.kept[name] = value

    def save(self) -> None:
        """It is, unless there is a problem."""
        self.saves += 1


def bench_with(params: Params) -> tuple[Bench, Memory]:
    bench, memory = Bench(), Memory()
    bench.rover = Rover(params, now=bench.now, param_store=memory)
    bench.wait(CYCLE)
    return bench, memory


def set_(bench: Bench, name: str, value: float, system: int = DRIVER, kind: int = REAL32) -> float:
    """The value that the answer gives."""
    bench.say(m.ParamSet(1, 1, name.encode(), value, kind), system)
    answer = bench.newest(m.ParamValue)
    assert answer.param_id == name
    return float(answer.param_value)


def read(bench: Bench, name: bytes, index: int = -1) -> m.Message:
    bench.say(m.ParamRequestRead(1, 1, name, index))
    return bench.newest(m.Message)


def test_the_list_is_complete_and_in_order() -> None:
    bench = Bench()
    bench.say(m.ParamRequestList(1, 1))
    bench.wait(0.5)
    values = bench.all(m.ParamValue)
    assert [value.param_id for value in values] == NAMES
    assert [value.param_index for value in values] == list(range(len(TABLE)))
    assert {(value.param_type, value.param_count) for value in values} == {(REAL32, len(TABLE))}


def test_on_a_slow_link_the_list_leaves_room() -> None:
    bench = Bench()
    bench.rover.observe([LinkReport("serial", index=0, peers=1, capacity=5760.0)], bench.now)
    bench.say(m.ParamRequestList(1, 1))
    bench.wait(0.5)
    size = len(bench.all(m.ParamValue)) * 37
    assert 0.2 * 5760 * 0.5 < size < 0.3 * 5760 * 0.5 + 300
    bench.wait(len(NAMES) * 37 / (0.2 * 5760))
    assert [value.param_id for value in bench.all(m.ParamValue)] == NAMES


def test_63_asking_again_and_again_is_one_run_for_each_peer() -> None:
    bench = Bench()
    for _ in range(10):
        bench.say(m.ParamRequestList(1, 1))
        bench.say(m.ParamRequestList(1, 0), OTHER)
        bench.wait(0.02)
    bench.wait(0.5)
    to = [peer for message, peer in zip(bench.sent, bench.peers, strict=True) if isinstance(message, m.ParamValue)]
    assert to.count(Peer(0, f"gcs {DRIVER}")) == to.count(Peer(0, f"gcs {OTHER}")) == len(TABLE)


def test_read_by_name_and_by_index() -> None:
    bench = Bench()
    for answer in (read(bench, b"MAN_TIMEOUT"), read(bench, b"", NAMES.index("MAN_TIMEOUT"))):
        assert isinstance(answer, m.ParamValue)
        assert answer.param_id == "MAN_TIMEOUT"
        assert answer.param_value == pytest.approx(0.45)


@pytest.mark.parametrize(
    ("name", "index"), [(b"NO_SUCH", -1), (b"", 9999), (b"", -2), (b"\xff" * 16, -1), (b"", 32767)]
)
def test_62_what_is_not_there_is_an_error_and_no_value(name: bytes, index: int) -> None:
    answer = read(Bench(), name, index)
    assert isinstance(answer, m.ParamError)
    assert answer.error == ParamErrorCode.DOES_NOT_EXIST


def test_strangers_and_other_targets_get_nothing() -> None:
    bench = Bench()
    bench.say(m.ParamRequestList(1, 1), introduced=False)
    bench.say(m.ParamRequestList(2, 1))
    bench.say(m.ParamRequestList(1, 42))
    bench.wait(1.0)
    assert not bench.all(m.ParamValue)


def test_what_is_set_is_in_force_and_kept() -> None:
    bench, memory = bench_with(Params())
    assert set_(bench, "MOT_THR_MAX", 50) == 50
    assert memory.kept == {"MOT_THR_MAX": 50}
    bench.drive()
    assert bench.throttles == (0.5, 0.5)


def test_the_same_value_again_is_not_written_again() -> None:
    bench, memory = bench_with(Params())
    set_(bench, "MOT_THR_MAX", 100)
    assert memory.kept == {}


@pytest.mark.parametrize(
    ("name", "value", "stays"),
    [
        ("MAN_TIMEOUT", 9.0, 0.45),
        ("MAN_TIMEOUT", float("nan"), 0.45),
        ("MAN_TIMEOUT", float("inf"), 0.45),
        ("MAV_SYSID", 1.5, 1),
        ("DRIVE_TYPE", 2, 1),
    ],
)
def test_60_a_bad_value_is_refused_with_the_one_that_stays(name: str, value: float, stays: float) -> None:
    bench, memory = bench_with(Params())
    assert set_(bench, name, value) == pytest.approx(stays)
    assert bench.all(m.ParamError)
    bench.wait(0.1)
    assert said(bench, f"{name} not changed: ")
    assert memory.kept == {}


def test_60_another_type_is_refused() -> None:
    bench, memory = bench_with(Params())
    set_(bench, "MOT_THR_MAX", 50, kind=6)
    assert bench.newest(m.ParamError).error == ParamErrorCode.TYPE_MISMATCH
    assert memory.kept == {}


def test_60_an_unknown_name_is_an_error_and_said() -> None:
    bench = Bench()
    bench.say(m.ParamSet(1, 1, b"NO_SUCH", 2.0, REAL32))
    bench.wait(0.1)
    assert bench.newest(m.ParamError).error == ParamErrorCode.DOES_NOT_EXIST
    assert said(bench, "No parameter NO_SUCH")


def test_what_a_command_changes_is_told_to_everybody() -> None:
    bench = Bench()
    bench.heartbeat()
    assert bench.command(Command.DO_FENCE_ENABLE, 1) is Result.ACCEPTED
    bench.wait(0.1)
    told = bench.all(m.ParamValue)
    assert [(each.param_id, each.param_value) for each in told] == [("FENCE_ENABLE", 1.0)]
    assert bench.peers[bench.sent.index(told[0])] is None
    bench.say(m.ParamSet(1, 1, b"FENCE_ENABLE", 0, 9))
    bench.wait(0.5)
    assert len(bench.all(m.ParamValue)) == 2  # told once, by the answer


def test_61_safety_settings_are_locked_while_armed() -> None:
    bench, memory = bench_with(Params())
    bench.drive()
    assert set_(bench, "MAN_TIMEOUT", 2.0) == pytest.approx(0.45)
    assert set_(bench, "MOT_THR_MAX", 30) == 100
    assert bench.newest(m.ParamError).error == ParamErrorCode.PERMISSION_DENIED
    assert memory.kept == {}
    assert set_(bench, "MANUAL_EXPO", 0.5) == 0.5
    bench.command(Command.COMPONENT_ARM_DISARM, 0)
    assert set_(bench, "MAN_TIMEOUT", 0.5) == 0.5
    assert memory.kept == {"MANUAL_EXPO": 0.5, "MAN_TIMEOUT": 0.5}


def test_61_every_one_of_them_is() -> None:
    bench, memory = bench_with(Params())
    bench.drive()
    for parameter in TABLE:
        if parameter.safety:
            other = parameter.high if parameter.default != parameter.high else parameter.low
            assert set_(bench, parameter.name, other) == pytest.approx(parameter.default), parameter.name
    assert memory.kept == {}


def test_only_who_is_in_control_sets() -> None:
    bench, memory = bench_with(Params())
    assert set_(bench, "SPEED_MAX", 2.0, system=OTHER) == 2.0  # nobody is
    bench.drive()
    assert set_(bench, "SPEED_MAX", 3.0, system=OTHER) == 2.0
    bench.wait(0.1)
    assert said(bench, "SPEED_MAX not changed: you are not in control")
    assert memory.kept == {"SPEED_MAX": 2.0}


def test_what_the_file_of_settings_says_stays() -> None:
    bench, memory = bench_with(Params({"SPEED_MAX": 2.0}, pinned={"SPEED_MAX"}))
    assert set_(bench, "SPEED_MAX", 3.0) == 2.0
    assert bench.newest(m.ParamError).error == ParamErrorCode.READ_ONLY
    assert memory.kept == {}


@pytest.mark.parametrize("fence", [0, 1])
def test_no_command_puts_in_force_what_the_file_denies(fence: int) -> None:
    params = Params({"FENCE_ENABLE": fence}, pinned={"FENCE_ENABLE"})
    bench, _ = bench_with(params)
    bench.heartbeat()
    assert bench.command(Command.DO_FENCE_ENABLE, 1 - fence) is Result.FAILED
    assert said(bench, f"DO_FENCE_ENABLE refused: the configuration file sets FENCE_ENABLE {fence}")
    assert bench.command(Command.DO_FENCE_ENABLE, fence) is Result.ACCEPTED
    assert params["FENCE_ENABLE"] == fence


def test_64_after_damage_nobody_arms_until_somebody_sees_to_it() -> None:
    params = Params()
    params.mark_damaged("parameter file damaged")
    bench, memory = bench_with(params)
    assert bench.arm() is Result.FAILED
    bench.wait(0.1)
    assert said(bench, "PreArm: parameter file damaged, using defaults; set one to continue")
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.FAILED  # not even by force
    set_(bench, "MAN_TIMEOUT", 9.0)
    assert bench.arm() is Result.FAILED
    set_(bench, "MAN_TIMEOUT", 0.4)
    assert memory.kept == {"MAN_TIMEOUT": 0.4}
    assert bench.arm() is Result.ACCEPTED


def test_values_that_cannot_be_kept_are_told_once() -> None:
    bench, memory = bench_with(Params())
    memory.problem = "No space left on device"
    for _ in range(5):
        bench.rover.observe([], bench.now)
        bench.wait(1.0)
    assert bench.texts.count("Parameters are not saved: No space left on device; trying again") == 1


def observed(bench: Bench, seconds: int) -> None:
    """Let time pass; the links report once a second."""
    for _ in range(seconds):
        bench.rover.observe([], bench.now)
        bench.wait(1.0)


def test_an_unsaved_value_is_retried_and_its_save_told_once() -> None:
    bench, memory = bench_with(Params())
    memory.problem = "No space left on device"
    observed(bench, 20)
    assert memory.saves == 3  # after 2, 4 and 8 s
    observed(bench, 240)
    assert 6 <= memory.saves <= 9  # each minute
    assert "Parameters are saved now" not in bench.texts
    memory.problem = None
    observed(bench, 5)
    assert bench.texts.count("Parameters are saved now") == 1
    tried = memory.saves
    observed(bench, 70)
    assert memory.saves == tried
    memory.problem = "Input/output error"
    observed(bench, 1)
    memory.problem = "No space left on device"
    observed(bench, 4)
    assert memory.saves == tried + 1  # soon at first again
    assert bench.texts.count("Parameters are not saved: No space left on device; trying again") == 2


def test_a_disk_that_still_writes_is_not_asked_to_write_again() -> None:
    bench, memory = bench_with(Params())
    memory.problem, memory.idle = "No space left on device", False
    observed(bench, 10)
    assert memory.saves == 0
    memory.idle = True
    observed(bench, 1)
    assert memory.saves == 1


def test_a_value_a_full_disk_refused_is_saved_when_it_has_room(tmp_path: Path) -> None:
    folder = tmp_path / "state"
    store = ParamStore(FileWriter(folder))
    folder.write_text("in the way")  # as little room as a full disk, for root too
    bench = Bench()
    bench.rover = Rover(Params(), now=bench.now, param_store=store)
    bench.wait(CYCLE)
    set_(bench, "MOT_THR_MAX", 50)
    settled(store)
    observed(bench, 1)
    assert said(bench, "Parameters are not saved: File exists; trying again")
    folder.unlink()
    observed(bench, 4)
    settled(store)
    observed(bench, 1)
    assert said(bench, "Parameters are saved now")
    store.close()
    assert ParamStore(FileWriter(folder)).values == {"MOT_THR_MAX": 50}


def settled(store: ParamStore) -> None:
    """Until the thread has written; the test's own time limit ends it."""
    while not store.idle:
        os.sched_yield()


@pytest.mark.slow
@each_row("parameter", TABLE, ids=lambda parameter: parameter.name)
def test_no_value_that_can_be_set_prevents_the_start(parameter: Parameter) -> None:
    """A ground station could not mend it. Whole numbers choose what there is, so each of the first 20 counts."""
    between = {float(value) for value in range(20) if parameter.whole and parameter.low <= value <= parameter.high}
    for value in sorted({parameter.low, parameter.high, *between}):
        bench, _ = bench_with(Params({parameter.name: value}))
        bench.wait(0.1)
