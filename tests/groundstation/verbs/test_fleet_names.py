"""Vehicles of a fleet in verbs: chosen and shown by their names, and refused at once where the certificate may not."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.verbs.common.arguments import vehicle_id
from groundstation.verbs.common.exit_codes import ExitCode
from tests.e2e.fleet_programs import RouterProcess, make_fleet
from tests.e2e.programs import Vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

pytestmark = [pytest.mark.slow, pytest.mark.e2e, pytest.mark.xdist_group("fleet names")]
Capture = pytest.CaptureFixture[str]
NAMES = {"rover1": 1, "boat": 2}


@pytest.fixture(scope="module")
def fleet(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("names")
    with ExitStack() as stack:
        fleet = make_fleet(folder, alice="watch", bob="drive", rover1="vehicle", boat="vehicle")
        RouterProcess(fleet, stack)
        for name, system in NAMES.items():
            (folder / name).mkdir()
            vehicle = Vehicle(folder / name, f"zenoh:{fleet}/{name}.json5/farm/{name}", "--system", str(system))
            stack.callback(vehicle.end)
        yield fleet


class Run:
    """Runs `mavhelm words` as an operator."""

    def __init__(self, fleet: Path, capsys: Capture) -> None:
        self._fleet, self._capsys = fleet, capsys

    def __call__(self, operator: str, *words: str) -> VerbRun:
        return run_verb(self._capsys, *words, "-e", f"zenoh:{self._fleet}/{operator}.json5/farm", "--station", "never")


@pytest.fixture
def run(fleet: Path, capsys: Capture) -> Run:
    return Run(fleet, capsys)


def test_names_choose_and_are_shown(run: Run) -> None:
    every = run("alice", "disarm", "--group", "rover1,Rover 2", "--wait", "30")
    assert (every.code, [line.split()[0] for line in every.out.splitlines()]) == (0, ["vehicle", "rover1", "boat"])
    one = run("alice", "status", "-v", "boat", "--json")
    assert (one.records[0]["vehicle"], one.records[0]["name"]) == (2, "boat")
    assert [each["vehicle"] for each in run("alice", "disarm", "--group", "*oat", "--json").records] == [2]
    missing = run("alice", "status", "-v", "lorry", "--wait", "2")
    assert (missing.code, "no vehicle lorry" in missing.err) == (ExitCode.NO_VEHICLE, True)
    assert "choose one with --vehicle" in run("bob", "mode", "MANUAL").err


def test_a_role_that_is_missing_is_named_at_once(run: Run) -> None:
    for operator, words, role in (
        ("alice", "arm -v rover1", "drive"),
        ("alice", "drive --arm --throttle 20 --for 1 -v rover1", "drive"),
        ("alice", "mode AUTO -v rover1", "drive"),
        ("bob", "param set WP_RADIUS 2 -v rover1", "setup"),
        ("bob", "mission clear -v rover1", "setup"),
    ):
        refused = run(operator, *words.split(), "--timeout", "60")
        assert (refused.code, refused.err.count("\n")) == (ExitCode.REFUSED, 1), refused.err
        assert f"the certificate of {operator} may" in refused.err
        assert f"ask for the role {role}" in refused.err
    many = run("bob", "param", "set", "WP_RADIUS", "2", "--all")
    assert (many.code, many.err.endswith("2 vehicles: 2 refused\n")) == (ExitCode.REFUSED, True), many
    assert run("alice", "estop", "-v", "rover1").code == 0, "stops need no role"


@pytest.mark.parametrize("text", ["rover1", "7b", "1.5-x"])
def test_words_that_are_names_of_a_fleet(text: str) -> None:
    assert vehicle_id(text) == text
