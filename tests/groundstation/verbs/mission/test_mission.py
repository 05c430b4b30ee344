"""`mavhelm mission start`, `pause`, `jump`, `check` and `fence on`, with vehicles as ArduPilot and PX4 behave."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

Capture = pytest.CaptureFixture[str]
AUTO, HOLD = {ARDUPILOT: 10, PX4: 4 << 24 | 4 << 16}, {ARDUPILOT: 4, PX4: 3 << 24 | 4 << 16}
SET_CURRENT, FENCE_ENABLE = 224, 207
WAYPOINTS = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t-35.3632621\t149.1652299\t584.1\t1
1\t0\t3\t16\t0\t0\t0\t0\t-35.3630000\t149.1652299\t0\t1
2\t0\t3\t16\t0\t0\t0\t0\t-35.3630000\t149.1655000\t0\t1
"""


def run(capsys: Capture, vehicle: ForeignVehicle, *words: str) -> VerbRun:
    return run_verb(capsys, *words, "-e", vehicle.endpoint, "-v", "1")


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_start_and_pause_are_changes_of_mode(capsys: Capture, autopilot: int) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.mode = 1 << 16 if autopilot == PX4 else 0
        disarmed = run(capsys, vehicle, "mission", "start")
        assert disarmed.code == ExitCode.REFUSED
        assert "is disarmed; `mavhelm arm` arms it" in disarmed.err
        vehicle.armed = True
        started = run(capsys, vehicle, "mission", "start", "--json")
        assert (started.code, vehicle.mode) == (0, AUTO[autopilot]), started.err
        assert started.records[-1]["ok"] is True
        assert (run(capsys, vehicle, "mission", "pause").code, vehicle.mode) == (0, HOLD[autopilot])


def test_start_with_an_item_jumps_there_first(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed = True
        assert run(capsys, vehicle, "mission", "start", "3").code == 0
        sent = [
            (each.command, each.param1) for each in vehicle.of("COMMAND_LONG") if each.command in (SET_CURRENT, 176)
        ]
        assert sent == [(SET_CURRENT, 3.0), (176, 1.0)]  # the number is the vehicle's, as `mission show` prints it


def test_a_refused_jump_starts_nothing(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.armed = True
        vehicle.answers[SET_CURRENT] = (4, "Mission: no such item")
        for words in (("start", "9"), ("jump", "9")):
            refused = run(capsys, vehicle, "mission", *words)
            assert refused.code == ExitCode.REFUSED
            assert "Mission: no such item" in refused.err
        assert vehicle.mode == 0
        assert run(capsys, vehicle, "mission", "jump", "-1").code == ExitCode.USAGE


def test_check_compares_by_content(capsys: Capture, tmp_path: Path) -> None:
    file = tmp_path / "square.waypoints"
    file.write_text(WAYPOINTS)
    with foreign_vehicle() as vehicle:
        empty = run(capsys, vehicle, "mission", "check", str(file))
        assert empty.code == ExitCode.DIFFERS
        assert empty.err.endswith(f"2 items differ from {file}\n")
        assert run(capsys, vehicle, "mission", "put", str(file)).code == 0
        same = run(capsys, vehicle, "mission", "check", str(file))
        assert (same.code, same.out) == (0, ""), same.err
        vehicle.missions.items[0][2].param1 = 5.0
        other = run(capsys, vehicle, "mission", "check", str(file), "--json")
        assert other.code == ExitCode.DIFFERS
        assert [each["seq"] for each in other.records] == [2]
        assert "1=5" in other.records[0]["vehicle"]
        assert other.records[0]["differs"] == ["param1 0 here, 5 there"]


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_check_finds_equal_what_was_just_put(capsys: Capture, tmp_path: Path, autopilot: int) -> None:
    file = tmp_path / "a.waypoints"
    lines = [  # home, a waypoint, a loiter, DO_CHANGE_SPEED with the frame of ArduPilot's tools
        "0\t1\t0\t16\t0\t0\t0\t0\t-35.1\t149.1\t0\t1", "1\t0\t3\t16\t0.1\t0\t0\t0\t-35.2\t149.1\t0.1\t1",
        "2\t0\t3\t19\t5\t0\t0\t0\t-35.3\t149.1\t0\t1", "3\t0\t3\t178\t1\t0.3\t-1\t0\t0\t0\t0\t1",
    ]  # fmt: skip
    file.write_text("\n".join(["QGC WPL 110", *lines]))
    with foreign_vehicle(autopilot) as vehicle:
        assert run(capsys, vehicle, "mission", "put", str(file)).code == 0
        speed = vehicle.missions.items[0][-1]
        assert (speed.command, speed.frame) == (178, 2)
        for item in vehicle.missions.items[0]:  # as ArduPilot answers
            item.param3 = 1.0 if item.command == 19 else item.param3
            item.frame, item.autocontinue = (0 if item.command == 178 else item.frame), 1
        same = run(capsys, vehicle, "mission", "check", str(file))
        assert (same.code, same.out) == (0, ""), same.err


def test_the_fence_is_switched_on_and_off(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        assert run(capsys, vehicle, "fence", "on").code == 0
        vehicle.answers[FENCE_ENABLE] = (3, "")
        refused = run(capsys, vehicle, "fence", "off")
        assert refused.code == ExitCode.REFUSED
        assert [each.param1 for each in vehicle.of("COMMAND_LONG") if each.command == FENCE_ENABLE] == [1.0, 0.0]
