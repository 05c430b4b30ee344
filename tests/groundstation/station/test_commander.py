"""Arming, disarming, modes, control and the emergency stop, against a vehicle that answers as the test says."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from dialects.modes import Mode
from groundstation.intents import (
    Arm,
    ClearEmergencyStop,
    Disarm,
    DriveKeyDown,
    DriveKeyUp,
    EmergencyStop,
    ReportKeyReleases,
    RequestControl,
    SetMode,
)
from groundstation.station.emergency import FORCE_DISARM
from tests.groundstation.fake_vehicle import OURS, Cockpit, FakeVehicle

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def cockpit_with(vehicle: FakeVehicle) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    assert cockpit.view.alive
    return cockpit


def armed(vehicle: FakeVehicle | None = None) -> Cockpit:
    cockpit = cockpit_with(vehicle or FakeVehicle())
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert cockpit.view.armed
    return cockpit


def test_arming_in_hold_asks_for_manual_first() -> None:
    vehicle = FakeVehicle(mode=Mode.HOLD)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(1.0)
    order = [message.command for _, message in vehicle.all(m.CommandLong) if message.command in (ARM, MODE)]
    assert order == [MODE, ARM]
    assert (cockpit.view.mode, cockpit.view.armed, cockpit.view.driver) == ("MANUAL", True, OURS)


def test_arming_in_guided_leaves_the_mode_alone() -> None:
    cockpit = armed(FakeVehicle(mode=Mode.GUIDED))
    assert cockpit.vehicle.commands(MODE) == []
    assert cockpit.view.mode == "GUIDED"


def test_neutral_demands_go_before_arming_where_the_vehicle_does_not_tell_its_driver() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(1.0)
    armed_at = min(at for at, message in vehicle.all(m.CommandLong) if message.command == ARM)
    before = [message for at, message in vehicle.all(m.ManualControl) if at < armed_at]
    assert len(before) >= 2
    assert all(message.z == 0 and message.y == 0 for message in before)


def test_no_demand_goes_before_arming_to_a_vehicle_that_obeys_nobody_yet() -> None:
    cockpit = armed()
    armed_at = min(at for at, message in cockpit.vehicle.all(m.CommandLong) if message.command == ARM)
    assert [at for at, _, _ in cockpit.demands() if at < armed_at] == []


def test_refused_mode_ends_the_arming() -> None:
    vehicle = FakeVehicle(mode=Mode.HOLD)
    vehicle.answers[MODE] = Result.FAILED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(3.0)
    assert vehicle.commands(ARM) == []
    assert cockpit.view.refusal == "mode MANUAL failed"


def test_refusal_comes_with_the_vehicles_reason() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM], vehicle.reasons[ARM] = Result.FAILED, b"PreArm: battery low"
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm failed: PreArm: battery low"
    assert not cockpit.view.armed


def test_a_reason_after_the_refusal_counts_and_a_later_text_does_not() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.DENIED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(0.3)
    vehicle.say(m.StatusText(4, b"wheel blocked"))
    cockpit.run(2.0)
    assert cockpit.view.refusal == "arm denied: wheel blocked"
    vehicle.say(m.StatusText(4, b"something else"))
    cockpit.run(0.2)
    assert cockpit.view.refusal == "arm denied: wheel blocked"


def test_acceptance_clears_the_refusal() -> None:
    vehicle = FakeVehicle()
    vehicle.answers[ARM] = Result.TEMPORARILY_REJECTED
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert cockpit.view.refusal == "arm temporarily rejected"
    del vehicle.answers[ARM]
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert cockpit.view.refusal is None
    assert cockpit.view.armed


def test_no_answer_is_told() -> None:
    vehicle = FakeVehicle()
    vehicle.silent_on.add(ARM)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(4.0)
    assert cockpit.view.refusal == "arm: no answer"
    assert len(vehicle.commands(ARM)) == 6


def test_acknowledged_but_not_armed_is_told() -> None:
    vehicle = FakeVehicle()
    vehicle._obey = lambda message, source: None  # type: ignore[method-assign]
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(4.0)
    assert cockpit.view.refusal == "arming acknowledged, but the heartbeat reports disarmed"


def test_disarm_is_asked_again_while_the_heartbeat_says_armed() -> None:
    cockpit = armed()
    obey, vehicle = cockpit.vehicle._obey, cockpit.vehicle
    vehicle._obey = lambda message, source: None  # type: ignore[method-assign]  # acknowledged, and not done
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert cockpit.view.armed
    vehicle._obey = obey  # type: ignore[method-assign]
    cockpit.run(2.0)
    assert not cockpit.view.armed


def test_disarm_that_never_becomes_true_is_told() -> None:
    cockpit = armed()
    cockpit.vehicle._obey = lambda message, source: None  # type: ignore[method-assign]
    cockpit.do(Disarm())
    cockpit.run(8.0)
    assert cockpit.view.refusal == "disarm: Rover 1 still reports armed"


def test_disarm_during_arming_ends_the_arming() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(0.05)
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert [command.param1 for command in vehicle.commands(ARM)] == [0]
    assert not cockpit.view.armed


def test_mode_by_name() -> None:
    cockpit = armed()
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(1.0)
    assert cockpit.view.mode == "HOLD"
    assert "mode HOLD accepted" in cockpit.texts


@pytest.mark.parametrize("name", ["FLY", "", "manual"])
def test_unknown_mode_is_told_and_not_sent(name: str) -> None:
    cockpit = armed()
    cockpit.do(SetMode(mode=name))
    cockpit.run(0.5)
    assert cockpit.vehicle.commands(MODE) == []
    assert cockpit.view.refusal == f"Rover 1 has no mode {name}"


def test_request_control_of_a_vehicle_that_does_not_know_the_command_claims_it() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    vehicle.armed = True
    vehicle.answers[Command.REQUEST_OPERATOR_CONTROL] = Result.UNSUPPORTED
    cockpit = cockpit_with(vehicle)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert vehicle.all(m.ManualControl) == [], "an idle station must not fight another driver"
    cockpit.do(DriveKeyUp(key="i"), RequestControl())
    cockpit.run(0.5)
    cockpit.do(FORWARD)
    cockpit.run(0.5)
    assert vehicle.all(m.ManualControl)[-1][1].z == 600


def test_emergency_stop_is_two_commands_and_neutral_at_once() -> None:
    cockpit = armed()
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert cockpit.demands()[-1][1] == 600
    at = cockpit.now
    cockpit.do(EmergencyStop())
    cockpit.run(0.02)
    switch, disarm = cockpit.vehicle.commands(SWITCH)[-1], cockpit.vehicle.commands(ARM)[-1]
    assert switch.param1 == 0
    assert (disarm.param1, disarm.param2) == (0, FORCE_DISARM)
    assert cockpit.demands(at + 0.001)[0][1] == 0
    cockpit.run(1.0)
    assert cockpit.view.emergency_stop
    assert cockpit.helm.gate_reason == "emergency stop"


def test_emergency_stop_is_repeated_until_the_link_is_back() -> None:
    cockpit = armed()
    cockpit.world.cut()
    cockpit.do(EmergencyStop())
    cockpit.run(20.0)
    assert cockpit.vehicle.armed
    cockpit.world.cut(False)
    back = cockpit.now
    took = cockpit.world.run_until(lambda: cockpit.vehicle.locked, within=1.0)
    assert took < 0.6, back
    cockpit.run(2.0)
    heard = len(cockpit.vehicle.commands(SWITCH))
    cockpit.run(5.0)
    assert len(cockpit.vehicle.commands(SWITCH)) == heard, "acknowledged and true: nothing is left to ask for"


def test_emergency_stop_goes_on_while_the_vehicle_refuses_and_stays_armed() -> None:
    vehicle = FakeVehicle()
    cockpit = armed(vehicle)
    vehicle.answers = {SWITCH: Result.UNSUPPORTED, ARM: Result.FAILED}
    cockpit.do(EmergencyStop())
    cockpit.run(3.0)
    assert len([command for command in vehicle.commands(ARM) if command.param2 == FORCE_DISARM]) >= 5
    vehicle.answers = {SWITCH: Result.UNSUPPORTED}
    cockpit.run(1.0)
    assert not vehicle.armed
    assert cockpit.view.emergency_stop, "our lock stays where the vehicle has none"


def test_arming_is_refused_here_while_the_emergency_stop_is_on() -> None:
    cockpit = armed()
    cockpit.do(EmergencyStop())
    cockpit.run(1.0)
    before = len(cockpit.vehicle.commands(ARM))
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert len(cockpit.vehicle.commands(ARM)) == before
    assert cockpit.view.refusal == "arm: emergency stop active, clear it first"


@pytest.mark.parametrize("answer", [Result.ACCEPTED, Result.UNSUPPORTED])
def test_clearing_unlocks_when_the_vehicle_agrees(answer: Result) -> None:
    cockpit = armed()
    cockpit.vehicle.answers[SWITCH] = answer
    cockpit.do(EmergencyStop())
    cockpit.run(2.0)
    assert cockpit.view.emergency_stop
    assert not cockpit.view.armed
    cockpit.do(ClearEmergencyStop())
    cockpit.run(2.0)
    assert not cockpit.view.emergency_stop
    assert not cockpit.view.armed, "clearing must not arm"
    cockpit.do(Arm())
    cockpit.run(1.0)
    assert cockpit.view.armed


def test_refused_clearing_keeps_the_lock() -> None:
    cockpit = armed()
    cockpit.do(EmergencyStop())
    cockpit.run(1.0)
    cockpit.vehicle.answers[SWITCH] = Result.FAILED
    cockpit.do(ClearEmergencyStop())
    cockpit.run(2.0)
    assert cockpit.view.emergency_stop
    assert cockpit.view.refusal == "clear emergency stop failed"


def test_clearing_where_no_stop_is_on_sends_nothing() -> None:
    cockpit = armed()
    cockpit.do(ClearEmergencyStop())
    cockpit.run(1.0)
    assert cockpit.vehicle.commands(SWITCH) == []
    assert cockpit.view.armed


def test_emergency_stop_during_arming_ends_the_arming() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT, driver=None)
    cockpit = cockpit_with(vehicle)
    cockpit.do(Arm())
    cockpit.run(0.05)
    cockpit.do(EmergencyStop())
    cockpit.run(3.0)
    assert [command.param1 for command in vehicle.commands(ARM)] == [0]
    assert not vehicle.armed
