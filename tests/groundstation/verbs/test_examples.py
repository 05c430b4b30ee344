"""docs/commands.md: generated from the table of verbs, and each of its examples is run."""

from __future__ import annotations

import shlex
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.verbs.action import ONLY
from groundstation.verbs.command_doc import update
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.table import VERBS, find_examples
from groundstation.verbs.verb import Stage
from tests.fakes.params import Param
from tests.fakes.services import ForeignVehicle, foreign_vehicle
from tests.groundstation.formats.test_plan_file import as_text, document
from tests.groundstation.verbs.verb_runs import run_verb

DOCUMENT = Path(__file__).parents[3] / "docs/commands.md"
ALL = [each.command for each in find_examples(Stage)]
SHORTER = {
    "status": ("--timeout", "5"), "vehicles": ("--for", "0.2"), "links": ("--for", "0.2"), "messages": ("--for", "0.2"),
    "watch": ("--timeout", "0.3"), "ping": ("--count", "2", "--interval", "0.1"), "control give": ("--wait", "2"),
}  # fmt: skip
"""Verb -> options that make it take less time."""
ELSEWHERE = frozenset(
    {
        "api",
        "mcp",
        "drive",
        "turn",
        "takeoff",
        "land",
        "send",
        "doctor",
        "motor",
        "export",
        "replay",
        "record",
        "ros1",
        "ros2",
        "sign",
        "keys",
        "completion",
    }
)
"""Verbs that other tests run: with a watchdog, with a station, or without a vehicle."""
OF_HANDS = frozenset({"wp", "compass", "sticks"})
"""Words of examples that need more of a vehicle, and have tests of their own."""
RUN = [words for command in ALL if (words := shlex.split(command)[1:])[0] not in ELSEWHERE and not OF_HANDS & {*words}]
CODES = {"watch": {0, 7}, "control give": {7}}
"""Verb -> its codes with this vehicle; all others end with 0."""


def name_of(words: list[str]) -> str:
    actions = VERBS[words[0]].actions
    return words[0] if ONLY in actions else f"{words[0]} {words[1]}"


def test_the_document_is_generated() -> None:
    text = DOCUMENT.read_text()
    assert update(text) == text, "run python -m groundstation.verbs.command_doc docs/commands.md"


def test_every_verb_and_action_has_an_example() -> None:
    shown = {name_of(words) for command in ALL if (words := shlex.split(command)[1:])}
    assert {f"{verb} {action}".strip() for verb, row in VERBS.items() for action in row.actions} - shown == set()


def test_each_example_runs(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.lua").write_text("-- a script\n")
    failed = []
    with foreign_vehicle() as vehicle:
        prepare(vehicle)
        for words in RUN:
            vehicle.armed = words[0] in ("goto", "home", "mission", "speed")
            Path("patrol.plan").write_text(as_text(document()))
            name = name_of(words)
            overwrites = ["--yes"] if name in ("mission get", "param save") else []
            one = [] if "--all" in words else ["-v", "1"]
            ours = ["-e", vehicle.endpoint, *one, *overwrites, *SHORTER.get(name, ())]
            ran = run_verb(capsys, *(word for word in words if word != "-e" and not word.startswith("udpout:")), *ours)
            if ran.code not in CODES.get(name, {ExitCode.DONE}):
                failed.append((words, ran.code, ran.err))
    assert failed == []


def prepare(vehicle: ForeignVehicle) -> None:
    """Give the vehicle what the examples ask for."""
    vehicle.beat_period = 0.05
    vehicle.params |= {name: Param(1.0) for name in ("FS_TIMEOUT", "FS_ACTION")}
    vehicle.modes[:] = [("MANUAL", 0, 0), ("HOLD", 4, 0), ("AUTO", 10, 0), ("RTL", 11, 0), ("GUIDED", 15, 0)]
    vehicle.logs[:] = [b"log" * 50]
    vehicle.telemetry[33] = mav.MAVLink_global_position_int_message(0, -353632620, 1491652370, 0, 0, 0, 0, 0, 0)
    vehicle.telemetry[242] = mav.MAVLink_home_position_message(0, 0, 0, 0, 0, 0, [1.0, 0.0, 0.0, 0.0], 0, 0, 0)
    vehicle.on_command[192] = lambda: vehicle.change_mode(15)
    vehicle.on_command[20] = lambda: vehicle.change_mode(11)
    assert vehicle.files is not None
    vehicle.files.files["/logs/00000001.tlog"] = b"bytes"
