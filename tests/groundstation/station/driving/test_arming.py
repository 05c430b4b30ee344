"""The arming sequence: neutral, MANUAL, arm, confirmed by the heartbeat."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from dialects.modes import Mode
from groundstation.intents.driving import EmergencyStop
from groundstation.intents.vehicle import Arm, Disarm
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import OURS, armed_cockpit, cockpit_with

ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def test_arming_in_hold_changes_to_manual_first() -> None:
    vehicle = FakeVehicle(mode=Mode.HOLD)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    order = [message.command for _, message in vehicle.all(m.CommandLong) if message.command in (ARM, MODE)]
    assert order == [MODE, ARM]
    assert (cockpit.view.mode, cockpit.view.armed, cockpit.view.driver) == ("MANUAL", True, OURS)


def test_arming_in_guided_leaves_the_mode_alone() -> None:
    cockpit = armed_cockpit(FakeVehicle(mode=Mode.GUIDED))
    assert cockpit.vehicle.commands(MODE) == []
    assert cockpit.view.mode == "GUIDED"


def test_neutral_demands_precede_arming_without_control_status() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    armed_at = min(at for at, message in vehicle.all(m.CommandLong) if message.command == ARM)
    before = [message for at, message in vehicle.all(m.ManualControl) if at < armed_at]
    assert len(before) >= 2
    assert all(message.z == 0 and message.y == 0 for message in before)


def test_no_demand_precedes_arming_while_no_driver_is_in_control() -> None:
    cockpit = armed_cockpit()
    armed_at = min(at for at, message in cockpit.vehicle.all(m.CommandLong) if message.command == ARM)
    assert [at for at, _, _ in cockpit.demands() if at < armed_at] == []


def test_refused_mode_ends_the_arming() -> None:
    vehicle = FakeVehicle(mode=Mode.HOLD)
    vehicle.answers[MODE] = Result.FAILED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(3.0)
    assert vehicle.commands(ARM) == []
    assert cockpit.view.refusal == "mode MANUAL failed"


def test_acknowledged_but_not_armed_is_reported() -> None:
    vehicle = FakeVehicle()
    vehicle.obeys = False
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(4.0)
    assert cockpit.view.refusal == "arming acknowledged, but its heartbeat reports disarmed in MANUAL"


def test_disarm_during_arming_ends_the_arming() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(0.05)
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert [command.param1 for command in vehicle.commands(ARM)] == [0]
    assert not cockpit.view.armed


def test_emergency_stop_during_arming_ends_the_arming() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm(held=1.0))
    cockpit.run(0.05)
    cockpit.do(EmergencyStop())
    cockpit.run(3.0)
    assert [command.param1 for command in vehicle.commands(ARM)] == [0]
    assert not vehicle.armed
