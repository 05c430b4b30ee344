"""The emergency stop: two commands, repeated until done, and its release."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from dialects.modes import Mode
from groundstation.intents.driving import ClearEmergencyStop, EmergencyStop
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.snapshot import EmergencyProgress
from groundstation.station.driving.stops.blind_stops import EVERYBODY, BlindStops
from groundstation.vehicles.demand.stop_commands import FORCE_DISARM, StopKind
from groundstation.vehicles.state.message_log import MessageLog
from link.core import Peer, Received
from tests.fakes.rover import FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, Cockpit, armed_cockpit

ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def test_emergency_stop_is_two_commands_and_neutral_at_once() -> None:
    cockpit = armed_cockpit()
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.51)  # between two demands
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
    assert cockpit.operator.gate_reason == "emergency stop"


def test_emergency_stop_is_repeated_until_the_link_is_back() -> None:
    cockpit = armed_cockpit()
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


def progress(cockpit: Cockpit) -> EmergencyProgress | None:
    return cockpit.view.emergency_progress


def test_an_emergency_stop_on_a_cut_link_claims_nothing() -> None:
    cockpit = armed_cockpit()
    cockpit.world.cut()
    cockpit.do(EmergencyStop())
    assert cockpit.view.emergency_stop
    assert progress(cockpit) is EmergencyProgress.SENT
    cockpit.run(1.2)
    assert progress(cockpit) is EmergencyProgress.UNANSWERED
    cockpit.run(20.0)
    assert progress(cockpit) is EmergencyProgress.UNANSWERED
    assert (cockpit.view.armed, cockpit.view.alive) == (True, False)
    cockpit.world.cut(False)
    cockpit.run(2.0)
    assert progress(cockpit) is None, "the vehicle itself reports the stop"
    assert cockpit.view.emergency_stop
    assert not cockpit.view.armed


def test_a_foreign_vehicle_confirms_by_answer_and_heartbeat() -> None:
    vehicle = FakeArduPilot()
    cockpit = armed_cockpit(vehicle)
    cockpit.do(EmergencyStop())
    cockpit.run(1.5)
    assert (progress(cockpit), cockpit.view.armed) == (EmergencyProgress.ACCEPTED, False)
    vehicle.armed = True  # by another ground station
    vehicle.silent_on |= {ARM, SWITCH}
    cockpit.run(1.5)
    assert (progress(cockpit), cockpit.view.armed) == (EmergencyProgress.ACCEPTED, True)


def test_a_vehicle_that_drops_commands_has_not_acknowledged() -> None:
    vehicle = FakeVehicle()
    cockpit = armed_cockpit(vehicle)
    vehicle.silent_on |= {ARM, SWITCH}
    cockpit.do(EmergencyStop())
    cockpit.run(4.0)
    assert (progress(cockpit), cockpit.view.armed) == (EmergencyProgress.UNANSWERED, True)


def test_estop_goes_on_while_the_vehicle_refuses_and_stays_armed() -> None:
    vehicle = FakeVehicle()
    cockpit = armed_cockpit(vehicle)
    vehicle.answers = {SWITCH: Result.UNSUPPORTED, ARM: Result.FAILED}
    cockpit.do(EmergencyStop())
    cockpit.run(3.0)
    assert len([command for command in vehicle.commands(ARM) if command.param2 == FORCE_DISARM]) >= 5
    assert (progress(cockpit), cockpit.view.armed) == (EmergencyProgress.REFUSED, True)
    vehicle.answers = {SWITCH: Result.UNSUPPORTED}
    cockpit.run(1.0)
    assert not vehicle.armed
    assert cockpit.view.emergency_stop, "our lock stays where the vehicle has none"


def test_a_report_from_before_the_stop_does_not_show_it() -> None:
    cockpit = armed_cockpit(FakeArduPilot())

    def report() -> None:
        """Have another sender of its id report disarmed."""
        received = Received(m.Heartbeat(10, 3, 81, 4, 4, 3), 1, 1, 0, Peer(0, ("10.0.0.2", 1)), introduced=True)
        cockpit.station.receive(received, cockpit.now)

    report()
    cockpit.run(0.1)
    cockpit.do(EmergencyStop())
    cockpit.run(1.2)
    assert not cockpit.view.armed
    assert cockpit.view.stop_doubt == "the sender at 10.0.0.2:1 has not reported since it began"
    report()
    assert cockpit.view.stop_doubt == ""


def test_arming_is_refused_here_while_the_emergency_stop_is_on() -> None:
    cockpit = armed_cockpit()
    cockpit.do(EmergencyStop())
    cockpit.run(1.0)
    before = len(cockpit.vehicle.commands(ARM))
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert len(cockpit.vehicle.commands(ARM)) == before
    assert cockpit.view.refusal == "arm: emergency stop active, clear it first"


@pytest.mark.parametrize("answer", [Result.ACCEPTED, Result.UNSUPPORTED])
def test_clearing_unlocks_when_the_vehicle_agrees(answer: Result) -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.answers[SWITCH] = answer
    cockpit.do(EmergencyStop())
    cockpit.run(2.0)
    assert cockpit.view.emergency_stop
    assert not cockpit.view.armed
    cockpit.do(ClearEmergencyStop(held=1.0))
    cockpit.run(2.0)
    assert not cockpit.view.emergency_stop
    assert not cockpit.view.armed, "clearing must not arm"
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert cockpit.view.armed


def test_refused_clearing_keeps_the_lock() -> None:
    cockpit = armed_cockpit()
    cockpit.do(EmergencyStop())
    cockpit.run(1.0)
    cockpit.vehicle.answers[SWITCH] = Result.FAILED
    cockpit.do(ClearEmergencyStop(held=1.0))
    cockpit.run(2.0)
    assert cockpit.view.emergency_stop
    assert cockpit.view.refusal == "release the emergency stop failed"


def test_clearing_where_no_stop_is_on_sends_nothing() -> None:
    cockpit = armed_cockpit()
    cockpit.do(ClearEmergencyStop(held=1.0))
    cockpit.run(1.0)
    assert cockpit.vehicle.commands(SWITCH) == []
    assert cockpit.view.armed


class MuteVehicle(FakeVehicle):
    """One that has no place for us: it obeys stops, and sends nothing but their acknowledgements."""

    def beat(self) -> None:
        """Send no HEARTBEAT."""


def test_before_any_vehicle_is_heard_the_estop_goes_to_all() -> None:
    vehicle = MuteVehicle()
    vehicle.armed = True
    cockpit = Cockpit(vehicle)
    cockpit.run(0.5)
    cockpit.do(EmergencyStop())
    cockpit.run(0.1)
    assert not vehicle.armed
    assert "(system 0)" in cockpit.snapshot.blind_stop
    cockpit.run(2.0)
    assert not vehicle.locked, "the safety switch of a copter in the air would let it fall"
    cockpit.run(31.0)
    assert cockpit.snapshot.blind_stop == ""


def test_a_vehicle_that_is_heard_after_a_stop_of_all_is_locked() -> None:
    vehicle = FakeVehicle()
    cockpit = Cockpit(vehicle)
    cockpit.do(EmergencyStop())
    cockpit.run(3.0)
    assert vehicle.locked
    assert cockpit.view.emergency_stop
    cockpit.do(ClearEmergencyStop(held=1.0))
    cockpit.run(3.0)
    assert not vehicle.locked, "the stop of all ends with its release"


def test_a_blind_stop_of_one_vehicle_goes_to_it_alone() -> None:
    vehicle = MuteVehicle()
    vehicle.armed = True
    cockpit = Cockpit(vehicle)
    cockpit.station.stop_blindly(StopKind.DISARM, 7, cockpit.now)
    cockpit.run(1.0)
    assert vehicle.armed
    assert "vehicle 7 (system 7)" in cockpit.snapshot.blind_stop
    cockpit.station.stop_blindly(StopKind.DISARM, 1, cockpit.now)
    cockpit.run(0.3)
    assert not vehicle.armed
    assert "DISARM sent" in cockpit.snapshot.blind_stop


def test_a_weaker_stop_does_not_replace_an_emergency_stop() -> None:
    stops = BlindStops((255, 190), MessageLog())
    stops.begin(StopKind.EMERGENCY, EVERYBODY, 0.0)
    stops.begin(StopKind.HOLD, EVERYBODY, 1.0)
    stops.begin(StopKind.HOLD, 4, 1.0)
    assert stops.describe().startswith("EMERGENCY STOP sent")
    assert stops.hear(4) is StopKind.EMERGENCY
    assert stops.hear(4) is None
    assert stops.tick(30.9, heard=True) != []
    assert stops.tick(31.1, heard=True) == []
    assert not stops


def test_of_very_many_blind_stops_the_last_go_to_all() -> None:
    stops = BlindStops((255, 190), MessageLog())
    for system in range(1, 34):
        stops.begin(StopKind.DISARM, system, 0.0)
    assert stops.hear(33) is StopKind.DISARM
    assert "(system 0)" in stops.describe()


def test_the_second_press_reaches_vehicles_that_are_not_heard() -> None:
    cockpit = armed_cockpit()
    cockpit.do(EmergencyStop(), EmergencyStop())
    cockpit.run(0.5)
    assert {each.target_system for each in cockpit.vehicle.commands(ARM)} >= {0, 1}


def count_modes(vehicle: FakeVehicle) -> int:
    """Return how many changes of the mode have arrived, in either form."""
    return sum(each.command == MODE for each in [*vehicle.of("COMMAND_LONG"), *vehicle.of("COMMAND_INT")])


def test_hold_repeats_until_shown_or_another_mode_chosen() -> None:
    vehicle = FakeVehicle(mode=Mode.GUIDED)
    cockpit = armed_cockpit(vehicle)
    vehicle.obeys = False
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(2.0)
    assert count_modes(vehicle) >= 3, "accepted, and not done"
    vehicle.obeys = True
    cockpit.run(2.0)
    heard = count_modes(vehicle)
    assert vehicle.mode == Mode.HOLD
    cockpit.run(3.0)
    assert count_modes(vehicle) == heard
    vehicle.obeys = False
    vehicle.change_mode(Mode.GUIDED)
    cockpit.run(1.5)
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(0.1)
    vehicle.obeys = True
    cockpit.do(SetMode(mode="MANUAL"))
    cockpit.run(3.0)
    assert vehicle.mode == Mode.MANUAL


def test_hold_that_no_heartbeat_shows_is_reported() -> None:
    vehicle = FakeVehicle(mode=Mode.GUIDED)
    cockpit = armed_cockpit(vehicle)
    vehicle.obeys = False
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(7.0)
    assert cockpit.view.refusal == "mode HOLD: Rover 1: its heartbeat reports ARMED in GUIDED"
