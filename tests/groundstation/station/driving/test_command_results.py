"""Texts of refused and unanswered commands, with the vehicle's reason."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Result, Sensor
from groundstation.intents.vehicle import Arm
from groundstation.station.driving.command_results import SHOWN_FOR
from groundstation.ui.log.join import find_group
from groundstation.views.log import LogRequest
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit, cockpit_with

ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def test_refusal_comes_with_the_vehicles_reason() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.FAILED, "PreArm: battery low"
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: PreArm: battery low"
    assert not cockpit.view.armed


def test_the_log_joins_the_request_the_result_and_the_reason() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.FAILED, "PreArm: battery low"
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    page = cockpit.station.log.build_page(LogRequest(), cockpit.now, cockpit.now)
    assert page is not None
    (answer,) = [line for line in page.lines if line.text == "arm failed"]
    assert answer.origin is not None
    assert (answer.origin.system, answer.origin.result) == (1, Result.FAILED)
    group = find_group(page.lines, answer)
    assert group.request is not None
    assert group.request.text == "arm"
    (text,) = group.texts
    assert text.text == "PreArm: battery low"
    assert text.origin is not None
    assert (text.origin.component, text.origin.vehicle) == (1, cockpit.view.name)


def test_a_reason_after_the_refusal_counts_and_a_later_text_not() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.DENIED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(0.3)
    vehicle.send(m.StatusText(4, b"wheel blocked"))
    cockpit.run(2.0)
    assert cockpit.view.refusal == "arm denied: wheel blocked"
    vehicle.send(m.StatusText(4, b"something else"))
    cockpit.run(0.2)
    assert cockpit.view.refusal == "arm denied: wheel blocked"


def test_the_reason_of_a_refusal_may_be_a_notice() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.FAILED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(0.3)
    vehicle.send(m.StatusText(5, b"No Mission. Can't set AUTO."))
    vehicle.send(m.StatusText(4, b"Mode change failed"))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: No Mission. Can't set AUTO.; Mode change failed"


def test_acceptance_clears_the_refusal() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.TEMPORARILY_REJECTED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm temporarily rejected"
    del vehicle.answers[ARM]
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal is None
    assert cockpit.view.armed


def sys_status(*, ready: bool) -> m.SysStatus:
    health = Sensor.PREARM if ready else 0
    return m.SysStatus(Sensor.PREARM, Sensor.PREARM, health, 0, 12000, 100, 80, 0, 0, 0, 0, 0, 0)


def refused_arming() -> Cockpit:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.FAILED, "Arm: Accels inconsistent"
    cockpit = cockpit_with(vehicle)
    vehicle.send(sys_status(ready=False))
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: Arm: Accels inconsistent"
    return cockpit


def test_a_refusal_to_arm_is_gone_when_the_checks_are_passed() -> None:
    cockpit = refused_arming()
    cockpit.vehicle.send(sys_status(ready=True))
    cockpit.run(0.1)
    assert cockpit.view.prearm
    assert cockpit.view.refusal is None


def test_a_refusal_while_the_checks_are_passed_is_shown() -> None:
    cockpit = refused_arming()
    cockpit.vehicle.send(sys_status(ready=True))
    cockpit.run(1.0)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: Arm: Accels inconsistent"


def test_a_refusal_to_arm_is_gone_when_another_station_arms() -> None:
    cockpit = refused_arming()
    cockpit.vehicle.armed = True
    cockpit.vehicle.beat()
    cockpit.run(0.1)
    assert cockpit.view.refusal is None


def test_a_refusal_is_not_shown_for_ever() -> None:
    cockpit = refused_arming()
    cockpit.run(SHOWN_FOR - 2.0)
    assert cockpit.view.refusal
    cockpit.run(2.0)
    assert cockpit.view.refusal is None
    assert "arm failed" in cockpit.texts


def test_no_answer_is_reported() -> None:
    vehicle = FakeVehicle()
    vehicle.silent_on.add(ARM)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(4.0)
    assert cockpit.view.refusal == "arm: no answer"
    assert len(vehicle.commands(ARM)) == 6
