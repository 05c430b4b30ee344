"""The exit codes of all verbs: without a vehicle, with wrong arguments, refused and not answered."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.table import VERBS
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.formats.test_plan_file import as_text, document
from tests.groundstation.verbs.test_examples import RUN, prepare
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port

Capture = pytest.CaptureFixture[str]
COMMANDS = {
    ("reboot",): 246,
    ("command", "DO_SET_HOME", "1"): 179,
    ("request", "HOME_POSITION"): 512,
    ("rate", "ATTITUDE", "10"): 511,
    ("speed", "0.6"): 178,
    ("param", "store"): 245,
    ("param", "reset", "--yes"): 245,
    ("calibrate", "gyro"): 241,
    ("calibrate", "level"): 241,
    ("calibrate", "pressure"): 241,
}
"""Verbs of one command, and its number."""


def commands_to(vehicle: ForeignVehicle) -> dict[tuple[str, ...], int]:
    """Return those that are sent to it: ArduPilot stores each parameter when it is set, and knows no command for it."""
    return {words: n for words, n in COMMANDS.items() if words != ("param", "store") or vehicle.autopilot != ARDUPILOT}


@pytest.fixture(params=[ARDUPILOT, PX4], ids=["ardupilot", "px4"])
def vehicle(request: pytest.FixtureRequest) -> Iterator[ForeignVehicle]:
    with foreign_vehicle(request.param) as running:
        prepare(running)
        yield running


def without_endpoint(words: list[str]) -> list[str]:
    """Return the words of an example without its endpoint: a network may lack a route to that address."""
    at = words.index("-e") if "-e" in words else len(words)
    return words[:at] + words[at + 2 :]


def test_no_vehicle(capsys: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.lua").touch()
    Path("patrol.plan").write_text(as_text(document()))
    Path("rover.param").write_text("FS_TIMEOUT 1\n")
    Path("run.keys").write_text("0.5 press i\n0.6 release i\n")
    where = ("-e", f"udpin:127.0.0.1:{free_port()}", "--wait", "0.02")
    codes = {}
    for words in map(without_endpoint, RUN):
        found = run_verb(capsys, *words, *where)
        codes[" ".join(words)] = found.code if "Traceback" not in found.err else found.err
    assert {words: code for words, code in codes.items() if code != ExitCode.NO_VEHICLE} == {}


def test_wrong_arguments(capsys: Capture) -> None:
    for verb, row in VERBS.items():
        for action in row.actions:
            words = [verb, *filter(None, (action,)), "--no-such-option"]
            assert run_verb(capsys, *words).code == ExitCode.USAGE, words


def test_refused(capsys: Capture, vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    codes = {}
    for words, command in commands_to(vehicle).items():
        vehicle.answers = {command: (4, "not now")}
        codes[words] = run_verb(capsys, *words, "-e", vehicle.endpoint, "-v", "1").code
    assert {words: code for words, code in codes.items() if code != ExitCode.REFUSED} == {}


def test_not_answered(capsys: Capture, vehicle: ForeignVehicle) -> None:
    vehicle.armed = True
    vehicle.silent |= {75, 76}  # COMMAND_INT, COMMAND_LONG
    codes = {}
    for words in commands_to(vehicle):
        codes[words] = run_verb(capsys, *words, "-e", vehicle.endpoint, "-v", "1", "--timeout", "0.15").code
    assert {words: code for words, code in codes.items() if code != ExitCode.NO_ANSWER} == {}
