"""`mavhelm doctor`, `motor` and `calibrate` on real sockets, with their exit codes."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.params import Param
from tests.fakes.services import PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import run_verb
from tests.ports import free_port
from tests.waits import wait_until

Capture = pytest.CaptureFixture[str]
MOTOR_TEST, ACTUATOR_TEST, CHECKS, CALIBRATION, REBOOT = 209, 310, 401, 241, 246

SAFE = {
    "RC_OVERRIDE_TIME": 0.5, "FS_GCS_ENABLE": 1, "FS_THR_ENABLE": 1, "FS_GCS_TIMEOUT": 5, "MAV_GCS_SYSID": 255,
    "BATT_LOW_VOLT": 0, "SERVO1_FUNCTION": 73, "SERVO3_FUNCTION": 74,
}  # fmt: skip


@pytest.fixture
def rover() -> Iterator[ForeignVehicle]:
    with foreign_vehicle() as vehicle:
        vehicle.params.replace({name: Param(float(value)) for name, value in SAFE.items()})
        yield vehicle


def test_nothing_stops_you(capsys: Capture, rover: ForeignVehicle) -> None:
    run = run_verb(capsys, "doctor", "-e", rover.endpoint)
    assert run.code == ExitCode.DONE, run.out + run.err
    assert "ok our id       255, nobody else has it" in run.out
    assert "nothing stops you from driving ArduPilot rover 1" in run.err
    assert [each.command for each in rover.of("COMMAND_LONG")].count(CHECKS) == 1


def test_px4_that_says_it_is_not_ready_is_doubtful(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.ready = False
        run = run_verb(capsys, "doctor", "-e", vehicle.endpoint)
        assert "HEARTBEAT says UNINIT" in run.out
        assert "nothing stops you" not in run.err


def test_what_stops_you(capsys: Capture, rover: ForeignVehicle, tmp_path: Path) -> None:
    rover.params["FS_THR_ENABLE"].value = 0.0
    rover.answers[CHECKS] = (0, "PreArm: Compass not calibrated")
    report = tmp_path / "report.txt"
    run = run_verb(capsys, "doctor", "-e", rover.endpoint, "--json", "--report", str(report))
    assert run.code == ExitCode.DIFFERS
    rows = {record["row"]: record for record in run.records[:-1]}
    assert rows["pre_arm"]["evidence"] == "Compass not calibrated"
    assert rows["pre_arm"]["advice"] == "calibrate the compass, outdoors"
    assert rows["stop_bound"]["set"] == {"name": "FS_THR_ENABLE", "value": 1.0}
    assert run.records[-1]["faults"] == ["pre_arm", "stop_bound"]
    assert not run.records[-1]["ok"]
    assert "Compass not calibrated" in report.read_text()
    again = run_verb(capsys, "doctor", "-e", rover.endpoint, "--report", str(report))
    assert again.code == ExitCode.USAGE
    assert "exists already" in again.err


def test_nothing_is_heard(capsys: Capture) -> None:
    run = run_verb(capsys, "doctor", "-e", f"udpin:127.0.0.1:{free_port()}", "--wait", "0.2")
    assert run.code == ExitCode.NO_VEHICLE
    assert "X  link         nothing heard on udpin:127.0.0.1" in run.out


@pytest.mark.parametrize(("answer", "code"), [
    ((0, ""), ExitCode.DONE), ((4, "Motor Test: vehicle not ready"), ExitCode.REFUSED), (None, ExitCode.NO_ANSWER),
])  # fmt: skip
def test_motor(capsys: Capture, rover: ForeignVehicle, answer: tuple[int, str] | None, code: int) -> None:
    if answer is None:
        rover.silent.add(76)
    else:
        rover.answers[MOTOR_TEST] = answer
    run = run_verb(capsys, "motor", "2", "-12", "--for", "0.6", "-e", rover.endpoint)
    assert run.code == code, run.err
    sent = [message for message in rover.of("COMMAND_LONG") if message.command == MOTOR_TEST]
    turns = [message for message in sent if message.param3]
    assert {(message.param1, message.param2) for message in turns} == {(4.0, 0.0)}
    assert all(message.param4 <= 0.5 for message in turns), "a program that is killed leaves a wheel turning for 0.5 s"
    assert len(turns) == (1 if code == ExitCode.REFUSED else 3)
    assert not sent[-1].param3
    if code == ExitCode.REFUSED:
        assert "Motor Test: vehicle not ready" in run.err


@pytest.mark.parametrize(("words", "code"), [
    (("motor", "1", "31"), ExitCode.USAGE),
    (("motor", "1", "nan"), ExitCode.USAGE),
    (("motor", "1", "10", "--for", "2.5"), ExitCode.USAGE),
    (("motor", "x", "10"), ExitCode.USAGE),
    (("calibrate", "teapot"), ExitCode.USAGE),
])  # fmt: skip
def test_mistakes(capsys: Capture, words: tuple[str, ...], code: int) -> None:
    assert run_verb(capsys, *words, "-e", "udpin:127.0.0.1:0").code == code


def test_a_motor_that_is_not_there(capsys: Capture, rover: ForeignVehicle) -> None:
    run = run_verb(capsys, "motor", "7", "10", "-e", rover.endpoint)
    assert run.code == ExitCode.USAGE
    assert "there is no motor 7; there are: 1 left wheel, 2 right wheel" in run.err


def test_px4_gets_an_actuator_test(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        run = run_verb(capsys, "motor", "1", "10", "--for", "0.1", "-e", vehicle.endpoint)
        assert run.code == ExitCode.DONE, run.err
        first, *_, last = (message for message in vehicle.of("COMMAND_LONG") if message.command == ACTUATOR_TEST)
        assert (round(first.param1, 2), first.param5) == (0.1, 1.0)
        assert last.param1 != last.param1, "NaN stops"


@pytest.mark.parametrize(("kind", "parameter"), [("gyro", "param1"), ("level", "param5"), ("pressure", "param3")])
def test_calibrate(capsys: Capture, rover: ForeignVehicle, kind: str, parameter: str) -> None:
    run = run_verb(capsys, "calibrate", kind, "-e", rover.endpoint, "-v", "1")
    assert run.code == ExitCode.DONE, run.err
    sent = next(message for message in rover.of("COMMAND_LONG") if message.command == CALIBRATION)
    assert getattr(sent, parameter) == (2.0 if kind == "level" else 1.0)


def test_a_calibration_that_is_refused(capsys: Capture, rover: ForeignVehicle) -> None:
    rover.answers[CALIBRATION] = (4, "Gyro cal failed")
    run = run_verb(capsys, "calibrate", "gyro", "-e", rover.endpoint, "-v", "1")
    assert run.code == ExitCode.REFUSED
    assert "Gyro cal failed" in run.err


def test_px4_has_calibrated_when_it_says_so(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        done = run_verb(capsys, "calibrate", "gyro", "-e", vehicle.endpoint, "-v", "1")
        assert (done.code, vehicle.calibrating) == (ExitCode.DONE, False), done.err
        assert "has calibrated: gyros" in done.err
        vehicle.calibration.failure = "[cal] calibration failed: gyro"
        failed = run_verb(capsys, "calibrate", "gyro", "-e", vehicle.endpoint, "-v", "1")
        assert failed.code == ExitCode.REFUSED
        assert "calibration failed: gyro" in failed.err
        assert "has calibrated" not in failed.err


def test_a_repeated_command_meets_the_calibration_it_has_begun(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.silent_on.add(CALIBRATION)
        vehicle.calibration.seconds = 3.0
        done = run_verb(capsys, "calibrate", "gyro", "-e", vehicle.endpoint, "-v", "1")
        assert (done.code, vehicle.calibrating) == (ExitCode.DONE, False), done.err
        assert "has calibrated: gyros" in done.err
        assert len([each for each in vehicle.of("COMMAND_LONG") if each.command == CALIBRATION]) > 1


def test_a_calibration_whose_end_is_not_reported(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.calibration.failure = "something else"
        run = run_verb(capsys, "calibrate", "level", "-e", vehicle.endpoint, "-v", "1")
        assert run.code == ExitCode.NO_ANSWER
        assert "it has ended, and its text was lost: calibrate again" in run.err


def test_a_refusal_while_it_calibrates_says_so(capsys: Capture) -> None:
    with foreign_vehicle(PX4) as vehicle:
        vehicle.calibrating, vehicle.calibration.seconds = True, 1e6
        vehicle.calibration._ends_at = float("inf")
        vehicle.answers[CALIBRATION] = 1, "motion, retrying.."
        vehicle.answers[REBOOT] = 2, "motion, retrying.."
        for verb in (("calibrate", "level"), ("reboot",)):
            run = run_verb(capsys, *verb, "-e", vehicle.endpoint, "-v", "1")
            assert run.code == ExitCode.REFUSED
            assert "a calibration is under way, try again when it has ended" in run.err
            assert "motion" not in run.err


def test_ardupilot_gives_no_reason_while_it_calibrates(capsys: Capture, rover: ForeignVehicle) -> None:
    rover.answers[CALIBRATION] = 1
    run = run_verb(capsys, "calibrate", "level", "-e", rover.endpoint, "-v", "1")
    assert run.code == ExitCode.REFUSED
    assert "TEMPORARILY_REJECTED: another calibration may be under way, try again in some seconds" in run.err


MAG_CAL_START, MAG_CAL_ACCEPT, MAG_CAL_CANCEL, INTERVAL = 42424, 42425, 42426, 511


def send_all(rover: ForeignVehicle, *messages: mav.MAVLink_message) -> None:
    """Send messages one after the other."""
    for message in messages:
        rover.send(message)


def progress(percent: int) -> mav.MAVLink_mag_cal_progress_message:
    return mav.MAVLink_mag_cal_progress_message(0, 1, 2, 1, percent, [0] * 10, 0.0, 0.0, 1.0)


def report(status: int) -> mav.MAVLink_mag_cal_report_message:
    return mav.MAVLink_mag_cal_report_message(0, 1, status, 0, 8.2, 1, 2, 3, 1, 1, 1, 0, 0, 0)


def commanded(rover: ForeignVehicle, command: int) -> bool:
    return any(message.command == command for message in rover.of("COMMAND_LONG"))


def test_a_compass_is_measured_and_written(capsys: Capture, rover: ForeignVehicle) -> None:
    rover.on_command[MAG_CAL_START] = partial(send_all, rover, progress(40), progress(90), report(4))
    run = run_verb(capsys, "calibrate", "compass", "-e", rover.endpoint, "-v", "1", "--json")
    assert run.code == ExitCode.DONE, run.err
    assert run.records[-1]["fits"] == [8.2]
    assert "compass 1 fit 8.2: written" in run.err
    assert commanded(rover, MAG_CAL_ACCEPT)
    assert not commanded(rover, MAG_CAL_CANCEL)


def test_a_compass_that_fails_is_cancelled(capsys: Capture, rover: ForeignVehicle) -> None:
    rover.on_command[MAG_CAL_START] = partial(send_all, rover, progress(40), report(10))
    run = run_verb(capsys, "calibrate", "compass", "-e", rover.endpoint, "-v", "1")
    assert run.code == ExitCode.REFUSED
    assert "the residuals are too large" in run.err
    wait_until(lambda: commanded(rover, MAG_CAL_CANCEL), "it is cancelled")
    assert not commanded(rover, MAG_CAL_ACCEPT)


def test_a_compass_that_never_ends_is_cancelled_at_the_timeout(capsys: Capture, rover: ForeignVehicle) -> None:
    rover.on_command[MAG_CAL_START] = lambda: rover.send(progress(40))
    run = run_verb(capsys, "calibrate", "compass", "-e", rover.endpoint, "-v", "1", "--timeout", "3")
    assert run.code == ExitCode.NO_ANSWER, run.err
    wait_until(lambda: commanded(rover, MAG_CAL_CANCEL), "it is cancelled")


def channels(first: int, second: int) -> mav.MAVLink_rc_channels_message:
    return mav.MAVLink_rc_channels_message(*[0, 2, first, second, *[0] * 16, 255])


def test_the_sticks_are_printed_as_parameters(capsys: Capture, rover: ForeignVehicle) -> None:
    places = ((1102, 1500), (1898, 1500), (1504, 1510))
    rover.on_command[INTERVAL] = partial(send_all, rover, *(channels(*each) for each in places))
    run = run_verb(capsys, "calibrate", "sticks", "--for", "0.5", "-e", rover.endpoint, "-v", "1")
    assert run.code == ExitCode.DONE, run.err
    assert [line.split() for line in run.out.splitlines()] == [
        ["RC1_MIN", "1102"], ["RC1_TRIM", "1504"], ["RC1_MAX", "1898"],
    ]  # fmt: skip
    assert not rover.of("PARAM_SET")


def test_sticks_that_cannot_be_calibrated(capsys: Capture, rover: ForeignVehicle) -> None:
    short = ("calibrate", "sticks", "--for", "0.3", "-e", rover.endpoint, "-v", "1")
    assert run_verb(capsys, *short).code == ExitCode.NO_ANSWER
    rover.on_command[INTERVAL] = lambda: rover.send(channels(1500, 1500))
    assert run_verb(capsys, *short).code == ExitCode.DIFFERS
    rover.armed = True
    assert run_verb(capsys, *short).code == ExitCode.REFUSED
    assert run_verb(capsys, "calibrate", "gyro", "--for", "1", "-e", rover.endpoint).code == ExitCode.USAGE
