"""Disarming, modes and control requests, with a scripted vehicle."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result
from groundstation.intents.driving import DriveKeyUp
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Disarm, RequestControl, SetMode
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, armed_cockpit, cockpit_with

ARM, MODE, SWITCH = Command.COMPONENT_ARM_DISARM, Command.DO_SET_MODE, Command.DO_SET_SAFETY_SWITCH_STATE


def test_disarm_is_repeated_while_the_heartbeat_reports_armed() -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.obeys = False  # acknowledged, and not done
    cockpit.do(Disarm())
    cockpit.run(2.0)
    assert cockpit.view.armed
    cockpit.vehicle.obeys = True
    cockpit.run(2.0)
    assert not cockpit.view.armed


def test_disarm_that_never_takes_effect_is_reported() -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.obeys = False
    cockpit.do(Disarm())
    cockpit.run(8.0)
    assert cockpit.view.refusal == "disarm: Rover 1: its heartbeat reports ARMED in MANUAL"


def test_disarm_is_repeated_past_rejections_and_silence() -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.answers[ARM] = Result.TEMPORARILY_REJECTED
    cockpit.do(Disarm())
    cockpit.run(2.0)
    cockpit.vehicle.silent_on.add(ARM)
    cockpit.run(3.0)
    assert cockpit.view.armed
    cockpit.vehicle.silent_on.clear()
    cockpit.vehicle.answers.clear()
    cockpit.run(2.0)
    assert not cockpit.view.armed


def test_a_stop_without_an_answer_is_reported_in_the_end() -> None:
    cockpit = armed_cockpit()
    cockpit.vehicle.silent_on.add(ARM)
    cockpit.do(Disarm())
    cockpit.run(5.5)
    assert cockpit.view.refusal is None
    cockpit.run(1.0)
    assert cockpit.view.refusal == "disarm: no answer"


def test_mode_by_name() -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(1.0)
    assert cockpit.view.mode == "HOLD"
    assert "mode HOLD accepted" in cockpit.texts


@pytest.mark.parametrize("name", ["FLY", ""])
def test_unknown_mode_is_reported_and_not_sent(name: str) -> None:
    cockpit = armed_cockpit()
    cockpit.do(SetMode(mode=name))
    cockpit.run(0.5)
    assert cockpit.vehicle.commands(MODE) == []
    assert cockpit.view.refusal == f"mode {name}: Rover 1: it has no mode {name}"


def test_request_control_claims_a_vehicle_without_the_command() -> None:
    vehicle = FakeVehicle(autopilot=Autopilot.ARDUPILOT)
    vehicle.armed = True
    vehicle.answers[Command.REQUEST_OPERATOR_CONTROL] = Result.UNSUPPORTED
    cockpit = cockpit_with(vehicle)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.5)
    assert vehicle.all(m.ManualControl) == [], "an idle station must not fight another driver"
    cockpit.do(DriveKeyUp(key="i"), RequestControl())
    cockpit.run(0.5)
    assert cockpit.view.refusal is None
    assert "this vehicle does not manage control, you drive" in cockpit.texts
    cockpit.do(FORWARD)
    cockpit.run(0.5)
    assert vehicle.all(m.ManualControl)[-1][1].z == 600


def test_a_refused_control_request_stays_a_refusal() -> None:
    vehicle = FakeVehicle(driver=254)
    vehicle.answers[Command.REQUEST_OPERATOR_CONTROL] = Result.DENIED
    cockpit = cockpit_with(vehicle)
    cockpit.do(RequestControl())
    cockpit.run(0.5)
    assert cockpit.view.refusal == "request control denied"
    cockpit.do(SetMode(mode="HOLD"))
    cockpit.run(0.5)
    assert cockpit.view.refusal is None
