"""Changes of mode, arming and control as lines of the log."""

from __future__ import annotations

from dialects.modes import Mode
from groundstation.intents.vehicle import Arm, RequestControl, SetMode
from groundstation.vehicles.state.message_log import STATE
from groundstation.views.log import LogRequest
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import Cockpit


def changes(cockpit: Cockpit) -> list[str]:
    page = cockpit.station.log.build_page(LogRequest(), cockpit.now, cockpit.now)
    return [line.text for line in page.lines if line.label == STATE] if page else []


def test_arming_mode_and_control_of_our_vehicle() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    assert changes(cockpit) == []
    cockpit.do(Arm(held=1.0))
    cockpit.run(2.0)
    cockpit.do(SetMode("HOLD"))
    cockpit.run(1.0)
    assert sorted(changes(cockpit)) == [
        "Rover 1: armed",
        "Rover 1: ground station 255 (this one) in control",
        "Rover 1: mode HOLD, was MANUAL",
    ]


def test_what_others_do_is_logged_too() -> None:
    cockpit = Cockpit()
    cockpit.run(2.0)
    cockpit.vehicle.driver, cockpit.vehicle.mode = 250, Mode.HOLD
    cockpit.run(2.0)
    cockpit.vehicle.driver = 0
    cockpit.run(2.0)
    assert changes(cockpit) == [
        "Rover 1: mode HOLD, was MANUAL",
        "Rover 1: ground station 250 in control",
        "Rover 1: no ground station in control",
    ]


def test_a_vehicle_that_does_not_tell_its_control_says_nothing() -> None:
    cockpit = Cockpit(FakeArduPilot())
    cockpit.run(2.0)
    cockpit.do(RequestControl(), Arm(held=1.0))
    cockpit.run(2.0)
    assert changes(cockpit) == ["ArduPilot rover 1: armed"]
