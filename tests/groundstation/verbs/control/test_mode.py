"""`mavhelm modes` and `mode` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb

Capture = pytest.CaptureFixture[str]
SHORT = [("MANU", 0, 0), ("STER", 3, 0), ("HOLD", 4, 0), ("AUTO", 10, 2)]
"""As ArduRover 4.7 lists them; AUTO has no mission."""


def verb(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, *arguments, "-e", vehicle.endpoint, "-v", "1")


def test_modes_as_the_vehicle_lists_them(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes[:] = SHORT
        assert verb(capsys, vehicle, "modes").out == (
            "> MANUAL                0\n  STEERING              3\n  HOLD                  4\n"
            "  AUTO                 10  not now\n"
        )  # fmt: skip
        records = verb(capsys, vehicle, "modes", "--json").records
        assert records[3] == {"name": "AUTO", "custom_mode": 10, "selectable": False, "current": False}


@pytest.mark.parametrize(("autopilot", "name"), [(ARDUPILOT, "GUIDED"), (PX4, "AUTO_MISSION")])
def test_modes_by_autopilot_and_type(capsys: Capture, autopilot: int, name: str) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.answers[512] = (3, "")  # REQUEST_MESSAGE is not supported
        listed = verb(capsys, vehicle, "modes")
        assert listed.code == 0
        assert name in listed.out.split()
        assert "not listed by the vehicle" in listed.err


@pytest.mark.parametrize(("autopilot", "custom"), [(ARDUPILOT, 4), (PX4, 3 << 24 | 4 << 16)])
def test_a_change_is_done_when_the_heartbeat_reports_it(capsys: Capture, autopilot: int, custom: int) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.answers[512] = (3, "")
        name = "hold" if autopilot == ARDUPILOT else "auto_loiter"
        changed = verb(capsys, vehicle, "mode", name, "--json")
        assert changed.code == 0, changed.err
        assert vehicle.mode == custom
        [record] = changed.records
        assert (record["ok"], record["mode"], record["verb"]) == (True, "HOLD", "mode")


def test_a_usual_mode_does_not_wait_for_the_list(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes[:] = SHORT
        assert verb(capsys, vehicle, "mode", "HOLD").code == 0
        assert vehicle.mode == 4
        wanted = [each.param1 for each in vehicle.messages if getattr(each, "command", 0) == Command.REQUEST_MESSAGE]
        assert m.AvailableModes.id not in wanted


def test_a_mode_that_is_accepted_and_not_reported_is_not_done(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes, vehicle.obeys = SHORT, False
        changed = verb(capsys, vehicle, "mode", "HOLD")
        assert changed.code == ExitCode.REFUSED
        assert "accepted, but its heartbeat reports another mode" in changed.err


def test_a_refusal_has_the_vehicles_own_words(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes, vehicle.answers[176] = SHORT, (4, "No Mission. Can't set AUTO.")
        refused = verb(capsys, vehicle, "mode", "auto")
        assert refused.code == ExitCode.REFUSED
        assert refused.err.endswith('mode AUTO: refused, FAILED, "No Mission. Can\'t set AUTO."\n')


def test_a_mode_that_moves_the_vehicle_is_named(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes[:] = SHORT
        assert "may move by itself in AUTO" in verb(capsys, vehicle, "mode", "AUTO").err
        assert verb(capsys, vehicle, "mode", "STEERING").err == ""


def hold_of_px4(vehicle: ForeignVehicle) -> None:
    """List modes as PX4's main branch does: standard modes have no name."""
    vehicle.modes = [("", 3 << 24 | 4 << 16, 0), ("", 4 << 24 | 4 << 16, 0), ("", 5 << 24 | 4 << 16, 0),
                     ("", 3 << 16, 0), ("Manual", 1 << 16, 0), ("Mine", 11 << 24 | 4 << 16, 0),
                     ("", 99 << 16, 0), ("", 98 << 16, 0), ("Manual", 1 << 16, 0)]  # fmt: skip
    vehicle.standard_modes = {5 << 24 | 4 << 16: 5, 4 << 24 | 4 << 16: 6, 3 << 16: 1, 99 << 16: 7, 98 << 16: 7}


def test_px4_modes_have_names_and_none_is_listed_twice(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        hold_of_px4(vehicle)
        records = verb(capsys, vehicle, "modes", "--json").records
        assert [each["name"] for each in records] == [
            "HOLD", "AUTO_MISSION", "AUTO_RTL", "POSCTL", "MANUAL", "AUTO_EXTERNAL1", "LAND", "LAND 6422528",
        ]  # fmt: skip


@pytest.mark.parametrize(
    ("name", "custom", "told"),
    [
        ("Hold", 3 << 24 | 4 << 16, "holds its place, and may drive for it"),
        ("auto_loiter", 3 << 24 | 4 << 16, "holds its place, and may drive for it"),
        ("Position", 3 << 16, ""),
        ("Manual", 1 << 16, ""),
        ("Mission", 4 << 24 | 4 << 16, "may move by itself in AUTO_MISSION; this program no longer sends heartbeats"),
        ("mine", 11 << 24 | 4 << 16, "may move by itself in AUTO_EXTERNAL1"),
    ],
)
def test_a_mode_of_px4_is_told_as_it_is(capsys: Capture, name: str, custom: int, told: str) -> None:
    with foreign_vehicle(PX4) as vehicle:
        hold_of_px4(vehicle)
        vehicle.mode = 1 << 16
        changed = verb(capsys, vehicle, "mode", name)
        assert (changed.code, vehicle.mode) == (0, custom)
        assert told in changed.err
        assert bool(told) == ("may" in changed.err)


def test_a_mode_that_does_not_exist(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.modes[:] = SHORT
        unknown = verb(capsys, vehicle, "mode", "FLY")
        assert unknown.code == ExitCode.REFUSED
        assert "no such mode; there are: MANUAL, STEERING, HOLD, AUTO" in unknown.err
        assert [command for command in vehicle.of("COMMAND_LONG") if command.command == 176] == []
