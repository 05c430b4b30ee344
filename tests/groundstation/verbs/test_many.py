"""One verb for many vehicles, `--all` and `--group`: real sockets, a table of results, the worst exit code."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode, worst_code
from groundstation.verbs.table import VERBS
from tests.fakes.params import Param
from tests.fakes.services import PX4, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

Capture = pytest.CaptureFixture[str]
DISARM = 400
CONFIG = '[groups]\nnorth = "1-2"\nsouth = ["3", "px4*"]\nlost = "1,9"\n'


class Vehicles:
    """Three ArduRovers with the ids 1 to 3 and a PX4 rover with the id 4."""

    def __init__(self, folder: Path, capsys: Capture, stack: ExitStack) -> None:
        make = [foreign_vehicle(system=1), foreign_vehicle(system=2), foreign_vehicle(system=3)]
        self.all = [stack.enter_context(each) for each in [*make, foreign_vehicle(PX4, system=4)]]
        self._capsys = capsys
        self._config = folder / "groundstation.toml"
        self._config.write_text(CONFIG)

    def verb(self, *words: str) -> VerbRun:
        links = [part for each in self.all for part in ("-e", each.endpoint)]
        return run_verb(self._capsys, *words, *links, "--config", str(self._config))

    @property
    def armed(self) -> list[int]:
        return [each.system for each in self.all if each.armed]

    def arm(self) -> None:
        for each in self.all:
            each.armed = True


@pytest.fixture
def vehicles(tmp_path: Path, capsys: Capture) -> Iterator[Vehicles]:
    with ExitStack() as stack:
        yield Vehicles(tmp_path, capsys, stack)


def test_all_run_at_once_with_a_result_table_and_the_worst_code(vehicles: Vehicles) -> None:
    vehicles.arm()
    vehicles.all[1].answers[DISARM] = (4, "not now")
    run = vehicles.verb("disarm", "--all")
    assert (run.code, vehicles.armed) == (ExitCode.REFUSED, [2])
    assert run.out.splitlines() == [
        "vehicle            result",
        "ArduPilot rover 1  done     is disarmed",
        'ArduPilot rover 2  refused  disarm: refused, FAILED (4), "not now"',
        "ArduPilot rover 3  done     is disarmed",
        "PX4 rover 4        done     is disarmed",
    ]
    assert run.err.endswith("4 vehicles: 3 done, 1 refused\n")


def test_groups_of_the_config_file_and_of_the_command_line(vehicles: Vehicles) -> None:
    for group, left in (("north", [3, 4]), ("south", [1, 2]), ("*px4*", [1, 2, 3]), ("2-4", [1])):
        vehicles.arm()
        run = vehicles.verb("disarm", "--group", group, "--json")
        assert (run.code, vehicles.armed) == (0, left), run.err
        assert sorted(each["vehicle"] for each in run.records) == sorted({1, 2, 3, 4} - set(left))
        assert all((each["ok"], each["result"], each["code"]) == (True, "done", 0) for each in run.records)


def test_a_vehicle_that_is_named_and_not_heard_is_in_the_table(vehicles: Vehicles) -> None:
    vehicles.arm()
    run = vehicles.verb("disarm", "--group", "lost", "--wait", "1.5")
    assert (run.code, vehicles.armed) == (ExitCode.NO_VEHICLE, [2, 3, 4])
    assert "Vehicle 9          not heard" in run.out.splitlines()


def test_data_of_each_vehicle(vehicles: Vehicles) -> None:
    for number, each in enumerate(vehicles.all):
        each.params.replace({"FS_TIMEOUT": Param(1.5 + number)})
    run = vehicles.verb("param", "get", "FS_TIMEOUT", "--all", "--json")
    assert run.code == 0, run.err
    values = {each["vehicle"]: each["data"][0]["param_value"] for each in run.records}
    assert values == {1: 1.5, 2: 2.5, 3: 3.5, 4: 4.5}


@pytest.mark.parametrize("words", ["drive --throttle 20 --for 1", "goto --by 1 1", "command DO_REPOSITION", "ftp ls /"])
def test_nobody_steers_several(vehicles: Vehicles, words: str) -> None:
    run = vehicles.verb(*words.split(), "--all")
    assert (run.code, run.err.count("\n")) == (ExitCode.USAGE, 1)
    assert "one vehicle at a time" in run.err
    assert not any(each.received for each in vehicles.all), "refused before a link is open"


def test_steering_is_never_for_many() -> None:
    steering = ("api", "drive", "goto", "motor", "send", "takeoff", "turn")
    assert not any(action.many for verb in steering for action in VERBS[verb].actions.values())


def test_mistakes(vehicles: Vehicles) -> None:
    for words, text in (
        ("stop --all -v 1", "choose one of"),
        ("stop --group west", "there are north, south, lost"),
        ("stop --group 0", "1 to 255"),
        ("status --all --watch", "for one vehicle"),
    ):
        run = vehicles.verb(*words.split())
        assert (run.code, text in run.err) == (ExitCode.USAGE, True), run.err


def test_the_worst_code_is_that_of_which_least_is_known() -> None:
    assert worst_code([0, 0]) == 0
    assert worst_code([0, ExitCode.DIFFERS, ExitCode.REFUSED]) == ExitCode.REFUSED
    assert worst_code([ExitCode.REFUSED, ExitCode.NO_ANSWER, ExitCode.NO_VEHICLE]) == ExitCode.NO_VEHICLE
