"""`mavhelm goto`, `home` and `speed` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

Capture = pytest.CaptureFixture[str]
REPOSITION, RETURN, SPEED = 192, 20, 178
GUIDED = {ARDUPILOT: 15, PX4: 3 << 24 | 4 << 16}
RTL = {ARDUPILOT: 11, PX4: 5 << 24 | 4 << 16}


def verb(capsys: Capture, vehicle: ForeignVehicle, *words: str) -> VerbRun:
    return run_verb(capsys, *words, "-e", vehicle.endpoint, "-v", "1")


@contextmanager
def armed(autopilot: int = ARDUPILOT) -> Iterator[ForeignVehicle]:
    """Run an armed vehicle that changes its mode when it is sent somewhere."""
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.armed = True
        vehicle.on_command[REPOSITION] = lambda: vehicle.change_mode(GUIDED[autopilot])
        vehicle.on_command[RETURN] = lambda: vehicle.change_mode(RTL[autopilot])
        yield vehicle


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_goto_a_place(capsys: Capture, autopilot: int) -> None:
    with armed(autopilot) as vehicle:
        sent = verb(capsys, vehicle, "goto", "-35.36287", "149.16599", "--json")
        assert sent.code == 0, sent.err
        assert "drives by itself" in sent.err
        [command] = vehicle.of("COMMAND_INT")
        assert (command.command, command.frame, command.x, command.y) == (REPOSITION, 6, -353628700, 1491659900)
        assert (command.param1, command.param2, math.isnan(command.param4)) == (-1, 1, True)


def test_goto_by_metres_from_where_it_is(capsys: Capture) -> None:
    with armed() as vehicle:
        assert verb(capsys, vehicle, "goto", "--by", "10", "-5").code == ExitCode.DIFFERS  # no position
        vehicle.telemetry[33] = mav.MAVLink_global_position_int_message(0, 600000000, 100000000, 0, 0, 0, 0, 0, 0)
        assert verb(capsys, vehicle, "goto", "--by", "10", "-5").code == 0
        [command] = vehicle.of("COMMAND_INT")
        north, east = (command.x - 600000000) / 1e7 * 111319.5, (command.y - 100000000) / 1e7 * 111319.5 / 2
        assert (north, east) == (pytest.approx(10, abs=0.02), pytest.approx(-5, abs=0.02))


def item(number: int, command: int, x: int, y: int) -> mav.MAVLink_mission_item_int_message:
    return mav.MAVLink_mission_item_int_message(255, 190, number, 3, command, 0, 1, 0, 0, 0, 0, x, y, 0.0)


def test_goto_an_item_of_the_mission(capsys: Capture) -> None:
    with armed() as vehicle:
        vehicle.missions.items[0] = [
            item(0, 16, 473977420, 85455940), item(1, 178, 0, 0), item(2, 16, 473980000, 85460000)
        ]  # fmt: skip
        assert verb(capsys, vehicle, "goto", "wp", "2").code == 0
        [command] = vehicle.of("COMMAND_INT")
        assert (command.command, command.x, command.y) == (REPOSITION, 473980000, 85460000)
        for number, words in (
            ("1", "item 1 has no place: DO_CHANGE_SPEED"),
            ("3", "no item 3, its mission has 3 items"),
        ):
            refused = verb(capsys, vehicle, "goto", "wp", number)
            assert (refused.code, words in refused.err) == (ExitCode.DIFFERS, True), refused.err
        assert len(vehicle.of("COMMAND_INT")) == 1


@pytest.mark.parametrize("autopilot", [ARDUPILOT, PX4])
def test_home_and_speed(capsys: Capture, autopilot: int) -> None:
    with armed(autopilot) as vehicle:
        assert verb(capsys, vehicle, "home").code == 0
        assert verb(capsys, vehicle, "speed", "0.6").code == 0
        [speed] = [each for each in vehicle.of("COMMAND_LONG") if each.command == SPEED]
        assert (speed.param1, speed.param2, speed.param3) == (1, pytest.approx(0.6), -1)


HOLD = 4
"""custom_mode of ArduPilot Rover."""


@pytest.mark.parametrize(("metres", "code"), [(1.0, ExitCode.DONE), (5.0, ExitCode.REFUSED)])
def test_home_where_it_is_home_already(capsys: Capture, metres: float, code: int) -> None:
    """The rover arrives at once and holds; no heartbeat with RTL may have come in between."""
    x = 600000000 + round(metres / 111319.5 * 1e7)
    with armed() as vehicle:
        vehicle.on_command[RETURN] = lambda: vehicle.change_mode(HOLD)
        vehicle.telemetry[33] = mav.MAVLink_global_position_int_message(0, x, 100000000, 0, 0, 0, 0, 0, 0)
        vehicle.telemetry[242] = mav.MAVLink_home_position_message(
            600000000, 100000000, 0, 0, 0, 0, [1.0, 0.0, 0.0, 0.0], 0, 0, 0
        )
        assert verb(capsys, vehicle, "home").code == code


def test_an_answer_without_the_mode_is_no_start(capsys: Capture) -> None:
    with armed() as vehicle:
        vehicle.on_command.clear()
        refused = verb(capsys, vehicle, "home")
        assert refused.code == ExitCode.REFUSED
        assert "accepted, but its heartbeat reports MANUAL, armed" in refused.err


@pytest.mark.slow
@pytest.mark.parametrize(
    ("beat_period", "code", "said"),
    [(5.0, ExitCode.DONE, "drives home"), (math.inf, ExitCode.NO_ANSWER, "accepted, but no heartbeat came for 8 s")],
)
def test_heartbeats_that_are_lost(capsys: Capture, beat_period: float, code: int, said: str) -> None:
    with armed() as vehicle:
        vehicle.beat_period = beat_period  # the first one comes at once
        vehicle.on_command[RETURN] = lambda: setattr(vehicle, "mode", RTL[ARDUPILOT])
        ended = verb(capsys, vehicle, "home")
        assert (ended.code, said in ended.err) == (code, True), ended.err


def test_refusals(capsys: Capture) -> None:
    with armed() as vehicle:
        vehicle.answers[REPOSITION] = (4, "Outside fence")
        refused = verb(capsys, vehicle, "goto", "1", "2")
        assert (refused.code, "Outside fence" in refused.err) == (ExitCode.REFUSED, True)
        vehicle.answers[SPEED] = (4, "")
        slow = verb(capsys, vehicle, "speed", "2")
        assert (slow.code, "ArduPilot takes a speed in AUTO, RTL" in slow.err) == (ExitCode.REFUSED, True)
        vehicle.change_mode(0, armed=False)
        disarmed = verb(capsys, vehicle, "goto", "1", "2")
        assert (disarmed.code, "is disarmed" in disarmed.err) == (ExitCode.REFUSED, True)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("goto", "write LAT LON in degrees, or --by"), ("goto 5", "write LAT LON"),
        ("goto wp", "goto wp 7"), ("goto wp 1.5", "1.5 is not a mission item number"),
        ("goto wp -1", "not a mission item number"), ("goto wp 1 --by 1 2", "goto wp 7"),
        ("goto 0 0", "is not a latitude"), ("goto 91 0", "91 0 is not a latitude"),
        ("goto nan 0", "'nan' is not a number"), ("goto --by 1", "expected 2"),
        ("goto 1 2 --by 1 2", "not both"), ("goto --by 1e9 0", "m at most"), ("speed 0", "not a speed"),
        ("speed inf", "is not a number"), ("speed -1", "not a speed"),
    ],
)  # fmt: skip
def test_mistakes(capsys: Capture, words: str, said: str) -> None:
    run = run_verb(capsys, *words.split(), "-e", "udpin:127.0.0.1:1")
    assert (run.code, len(run.err.splitlines()), said in run.err) == (ExitCode.USAGE, 1, True), run.err
