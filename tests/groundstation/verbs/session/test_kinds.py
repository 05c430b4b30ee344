"""Verbs and a copter as ArduCopter 4.7 answers, on a real socket: none arms it, moves it, or sends a mode by number."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

Capture = pytest.CaptureFixture[str]
WHY = "keys do not drive a helicopter: a released key lets it fall"
LISTED = [("STAB", 0, 0), ("ALTH", 2, 0), ("AUTO", 3, 0), ("GUID", 4, 0), ("LOIT", 5, 0), ("RTL", 6, 0), ("LAND", 9, 0)]
HELICOPTER = 4
MOVING = {22, 176, 178, 192, 209, 300, 310, 400}


def verb(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, *arguments, "-e", vehicle.endpoint, "-v", "1")


@contextmanager
def copter(autopilot: int = ARDUPILOT, *, armed: bool = False) -> Iterator[ForeignVehicle]:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.kind, vehicle.modes, vehicle.armed = HELICOPTER, LISTED, armed
        vehicle.params["SERVO1_FUNCTION"] = 33.0
        yield vehicle


def moved(vehicle: ForeignVehicle) -> list[object]:
    """Return what might have moved it."""
    commands = [each for each in vehicle.of("COMMAND_LONG") + vehicle.of("COMMAND_INT") if each.command in MOVING]
    starts = [each for each in commands if each.command != 400 or each.param1]
    demands = [each for name in ("MANUAL_CONTROL", "RC_CHANNELS_OVERRIDE", "SET_POSITION_TARGET_LOCAL_NED", "SET_MODE")
               for each in vehicle.of(name)]  # fmt: skip
    return [*starts, *demands]


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
@pytest.mark.parametrize(
    "arguments",
    [
        ("arm",),
        ("drive", "--throttle", "30", "--for", "1"),
        ("drive", "--throttle", "30", "--for", "1", "--arm"),
        ("stop",),
        ("goto", "47.1", "8.5"),
        ("speed", "1"),
        ("mission", "start"),
        ("send", "MANUAL_CONTROL", "z=600", "--rate", "10", "--for", "1", "--yes"),
        ("send", "SET_MODE", "base_mode=1", "custom_mode=4", "--yes"),
        ("command", "COMPONENT_ARM_DISARM", "1"),
        ("command", "DO_SET_MODE", "1", "4"),
        ("command", "DO_MOTOR_TEST", "1", "0", "10", "1"),
    ],
    ids=" ".join,
)
def test_no_verb_moves_it(capsys: Capture, arguments: tuple[str, ...], autopilot: int) -> None:
    with copter(autopilot, armed=arguments[0] not in ("arm", "drive")) as vehicle:
        vehicle.modes = []
        run = verb(capsys, vehicle, *arguments)
        assert run.code == ExitCode.REFUSED, run.err
        assert WHY in run.err
        assert len(run.err.splitlines()) == 1
        assert moved(vehicle) == []


def test_its_own_modes_are_listed_and_set(capsys: Capture) -> None:
    with copter(armed=True) as vehicle:
        names = [each["name"] for each in verb(capsys, vehicle, "modes", "--json").records]
        assert names == ["STABILIZE", "ALT_HOLD", "AUTO", "GUIDED", "LOITER", "RTL", "LAND"]
        for name, number in (("LAND", 9), ("alth", 2), ("RTL", 6)):
            assert verb(capsys, vehicle, "mode", name).code == 0
            assert vehicle.mode == number
        unknown = verb(capsys, vehicle, "mode", "HOLD")
        assert unknown.code == ExitCode.REFUSED
        assert "no such mode; there are: STABILIZE, ALT_HOLD" in unknown.err
        assert vehicle.mode == 6


def test_without_a_list_no_mode_is_set(capsys: Capture) -> None:
    with copter(armed=True) as vehicle:
        vehicle.answers[512] = (3, "")
        refused = verb(capsys, vehicle, "mode", "LAND")
        assert refused.code == ExitCode.REFUSED
        assert f"{WHY}, and it lists no modes itself" in refused.err
        assert moved(vehicle) == []


@pytest.mark.parametrize("name", ["disarm", "estop"])
def test_what_ends_its_power_passes(capsys: Capture, name: str) -> None:
    with copter(armed=True) as vehicle:
        run = verb(capsys, vehicle, name)
        assert run.code == 0, run.err
        assert not vehicle.armed
        assert moved(vehicle) == []
