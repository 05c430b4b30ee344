"""`mavhelm arm` with vehicles as ArduPilot and PX4 behave, on real sockets."""

from __future__ import annotations

import threading

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mav

from groundstation.verbs.common.exit_codes import ExitCode
from tests.fakes.services import ARDUPILOT, PX4, ForeignVehicle, foreign_vehicle
from tests.groundstation.verbs.verb_runs import VerbRun, run_verb
from tests.waits import wait_until

Capture = pytest.CaptureFixture[str]
COMMAND_INT, COMMAND_LONG = 75, 76
ARM, MODE, PREARM = 400, 176, 0x10000000
READY_AFTER = 3.0
"""s, in which a busy machine hears the vehicle and looks once."""


def arm(capsys: Capture, vehicle: ForeignVehicle, *arguments: str) -> VerbRun:
    return run_verb(capsys, "arm", *arguments, "-e", vehicle.endpoint, "-v", "1")


def sys_status(*, ready: bool) -> mav.MAVLink_sys_status_message:
    return mav.MAVLink_sys_status_message(PREARM, PREARM, PREARM * ready, 0, 12000, -1, 73, 0, 0, 0, 0, 0, 0)


@pytest.mark.parametrize(("autopilot", "neutral"), [(ARDUPILOT, (0, 0)), (PX4, (0, 500))])
def test_neutral_then_manual_then_armed_then_neutral(capsys: Capture, autopilot: int, neutral: tuple[int, int]) -> None:
    with foreign_vehicle(autopilot) as vehicle:
        vehicle.mode = 4 if autopilot == ARDUPILOT else 4 << 16
        armed = arm(capsys, vehicle, "--json")
        assert (armed.code, vehicle.armed) == (0, True), armed.err
        assert armed.records[-1]["armed"] is True
        assert "nobody drives it when this verb ends" in armed.err
        sent = [each.get_type() for each in vehicle.messages]
        assert sent.index("MANUAL_CONTROL") < next(
            at for at, each in enumerate(vehicle.messages) if getattr(each, "command", 0) in (MODE, ARM)
        )
        assert {(each.y, each.z) for each in vehicle.of("MANUAL_CONTROL")} == {neutral}
        assert "MANUAL_CONTROL" in sent[-3:]  # the final ones


def test_it_waits_for_the_pre_arm_bit(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.telemetry[1] = sys_status(ready=False)
        threading.Timer(READY_AFTER, lambda: vehicle.telemetry.update({1: sys_status(ready=True)})).start()
        armed = arm(capsys, vehicle)
        assert (armed.code, vehicle.armed) == (0, True)
        assert "not ready to arm" in armed.err


def test_a_refusal_has_the_vehicles_own_words(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.telemetry[1] = sys_status(ready=False)
        vehicle.answers[ARM] = (4, "PreArm: Compass not calibrated")
        refused = arm(capsys, vehicle, "--wait", "0.5")
        assert (refused.code, vehicle.armed) == (ExitCode.REFUSED, False)
        assert refused.err.endswith('arm: refused, FAILED (4), "PreArm: Compass not calibrated"\n')


def test_px4_that_refuses_for_the_moment_is_asked_again(capsys: Capture) -> None:
    answers = iter([1, 1, 0])  # TEMPORARILY_REJECTED until it has heard MANUAL_CONTROL for a while
    with foreign_vehicle(PX4) as vehicle:
        vehicle.answers[ARM] = lambda message: (next(answers, 0), "")
        armed = arm(capsys, vehicle, "--wait", "60")
        assert (armed.code, vehicle.armed) == (0, True), armed.err
        again = [each for each in vehicle.messages if getattr(each, "command", 0) == ARM]
        assert len(again) == 3


def test_an_acknowledged_arming_that_the_heartbeat_does_not_show(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.obeys = False
        refused = arm(capsys, vehicle)
        assert refused.code == ExitCode.REFUSED
        assert "arming acknowledged, but its heartbeat reports disarmed in MANUAL" in refused.err


def test_an_interrupted_arming_disarms(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.obeys = False
        assert arm(capsys, vehicle, "--timeout", "2.5").code == ExitCode.NO_ANSWER
        wait_until(lambda: arms(vehicle) == [1.0, 0.0], "it was not disarmed")


def arms(vehicle: ForeignVehicle) -> list[float]:
    return [each.param1 for each in vehicle.of("COMMAND_LONG") if each.command == ARM]


def test_no_answer(capsys: Capture) -> None:
    with foreign_vehicle() as vehicle:
        vehicle.silent.add(76)
        silent = arm(capsys, vehicle)
        assert (silent.code, vehicle.armed) == (ExitCode.NO_ANSWER, False)


def test_of_two_vehicles_with_one_id_both_must_be_armed(capsys: Capture) -> None:
    with foreign_vehicle() as deaf, foreign_vehicle() as other:
        deaf.silent |= {COMMAND_LONG, COMMAND_INT}
        both = ("-v", "1", "-e", other.endpoint, "-e", deaf.endpoint)
        armed = run_verb(capsys, "arm", *both)
        assert (armed.code, other.armed, deaf.armed) == (ExitCode.REFUSED, True, False), armed.err
        assert "arming acknowledged, but the sender at" in armed.err
        again = run_verb(capsys, "arm", *both)
        assert again.code == ExitCode.REFUSED
        assert "the sender at" in again.err
        assert "reports disarmed in MANUAL" in again.err
