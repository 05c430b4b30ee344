"""Cockpits in the states in which tests of the station start."""

from __future__ import annotations

import pytest

from groundstation.intents.driving import DriveKeyDown
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm
from tests.groundstation.fake_vehicle import Cockpit, FakeVehicle

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
LEFT = DriveKeyDown(key="j", throttle=0, steering=-1)


def armed_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.5)
    assert cockpit.view.armed
    return cockpit


def driving_cockpit(vehicle: FakeVehicle | None = None) -> Cockpit:
    """Armed, key releases reported, `i` held: the vehicle gets 60 %."""
    cockpit = armed_cockpit(vehicle)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(0.51)  # what comes next comes between two demands
    assert cockpit.operator.throttle == pytest.approx(0.6)
    return cockpit


def cockpit_with(vehicle: FakeVehicle) -> Cockpit:
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    assert cockpit.view.alive
    return cockpit
