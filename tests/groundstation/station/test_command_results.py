"""Texts of refused and unanswered commands, with the vehicle's reason."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Command, Result
from groundstation.intents import (
    Arm,
)
from tests.groundstation.cockpits import cockpit_with
from tests.groundstation.fake_vehicle import FakeVehicle

ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def test_refusal_comes_with_the_vehicles_reason() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM], vehicle.reasons[ARM] = Result.FAILED, b"PreArm: battery low"
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: PreArm: battery low"
    assert not cockpit.view.armed


def test_a_reason_after_the_refusal_counts_and_a_later_text_does_not() -> None:
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


def test_no_answer_is_reported() -> None:
    vehicle = FakeVehicle()
    vehicle.silent_on.add(ARM)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(4.0)
    assert cockpit.view.refusal == "arm: no answer"
    assert len(vehicle.commands(ARM)) == 6
