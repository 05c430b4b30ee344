"""Control of a vehicle that sends no CONTROL_STATUS: when it begins and when it ends."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.driving import DriveKeyUp
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, Disarm, RequestControl
from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.station.driving.claims import Claims
from groundstation.vehicles.state.vehicle_state import VehicleState
from tests.fakes.rover import FakeArduPilot
from tests.groundstation.cockpits import FORWARD, Cockpit, cockpit_with, driving_cockpit


def foreign_disarm_and_arm(cockpit: Cockpit) -> None:
    """Another ground station disarms the vehicle and arms it again, each shown by a heartbeat."""
    for armed in (False, True):
        cockpit.vehicle.armed = armed
        cockpit.run(1.2)


def test_a_vehicle_that_another_station_armed_is_not_ours() -> None:
    cockpit = driving_cockpit(FakeArduPilot())
    cockpit.do(DriveKeyUp(key="i"))
    foreign_disarm_and_arm(cockpit)
    assert not cockpit.view.in_control
    assert cockpit.operator.gate_reason == "not in control"
    quiet = cockpit.now
    cockpit.do(FORWARD)
    cockpit.run(2.0)
    assert cockpit.demands(quiet) == [], "an idle station must not fight another driver"
    cockpit.do(DriveKeyUp(key="i"), RequestControl())
    cockpit.run(0.5)
    assert cockpit.view.in_control
    cockpit.do(FORWARD)
    cockpit.run(0.5)
    assert cockpit.vehicle.all(m.ManualControl)[-1][1].z == 600


def test_both_heartbeats_in_one_read_are_noticed() -> None:
    cockpit = driving_cockpit(FakeArduPilot())
    for armed in (False, True):
        cockpit.vehicle.armed = armed
        cockpit.vehicle.beat()
    cockpit.run(0.1)
    assert cockpit.view.armed
    assert not cockpit.view.in_control


def test_after_a_disarm_nobody_is_in_control() -> None:
    cockpit = driving_cockpit(FakeArduPilot())
    cockpit.do(Disarm())
    cockpit.run(1.5)
    assert (cockpit.view.armed, cockpit.view.in_control) == (False, False)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.5)
    assert (cockpit.view.armed, cockpit.view.in_control) == (True, True)


def test_a_request_to_a_disarmed_vehicle_ends_when_another_arms() -> None:
    cockpit = cockpit_with(FakeArduPilot())
    cockpit.do(ReportKeyReleases(), RequestControl())
    cockpit.run(5.0)
    assert cockpit.view.in_control
    cockpit.vehicle.armed = True
    cockpit.run(1.2)
    assert not cockpit.view.in_control


@pytest.mark.parametrize("heartbeat_after", [0.0, 0.9 * CONFIRM_WITHIN])
def test_our_own_arming_shows_in_a_later_heartbeat(heartbeat_after: float) -> None:
    vehicle, claims = VehicleState(1, 1), Claims()
    claims.add(vehicle, 100.0, by_arming=True)
    claims.update(100.0 + heartbeat_after)
    vehicle.armed = True
    claims.update(100.0 + heartbeat_after)
    assert 1 in claims
    claims.update(200.0)
    assert 1 in claims
    vehicle.armed = False
    claims.update(200.0)
    assert 1 not in claims


def test_an_arming_that_never_shows_is_no_claim() -> None:
    vehicle, claims = VehicleState(1, 1), Claims()
    claims.add(vehicle, 100.0, by_arming=True)
    claims.update(100.1 + CONFIRM_WITHIN)
    assert 1 not in claims


def test_a_removed_claim_is_gone() -> None:
    vehicle, claims = VehicleState(1, 1), Claims()
    claims.add(vehicle, 100.0, by_arming=False)
    claims.remove(1)
    claims.remove(1)
    assert 1 not in claims
