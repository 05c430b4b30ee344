"""Copters that keys fly: the rows of PREPARED beside those of DRIVEN, for the tests of one module.

pytestmark = pytest.mark.usefixtures("copters_fly")     # with `from tests.flight import copters_fly`
"""

from __future__ import annotations

import pytest

from dialects.enums import Command
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, SetMode, TakeOff
from tests.fakes.flying import FlyingVehicle
from tests.fakes.multicopters import ArduCopter
from tests.groundstation.cockpits import Cockpit

HEIGHT = 5.0
"""m, of the take-off."""


class FlightCockpit(Cockpit):
    """A station and a copter in virtual time."""

    def __init__(self, copter: FlyingVehicle) -> None:
        super().__init__(copter)
        self.copter = copter


def hovering_cockpit(copter: FlyingVehicle, height: float = HEIGHT) -> FlightCockpit:
    """Return a station whose copter has been armed and taken off by its operator, and hovers in a mode for keys."""
    cockpit = FlightCockpit(copter)
    cockpit.do(ReportKeyReleases())
    cockpit.run(2.0)
    for _ in range(12):  # its settings are read first
        cockpit.do(Arm(held=1.0))
        cockpit.run(0.5)
        if copter.armed:
            break
    assert copter.armed, cockpit.texts
    cockpit.run(1.0)
    cockpit.do(TakeOff(altitude=height, held=1.0))
    begun = cockpit.now
    while abs(copter.altitude - height) > 0.1 and cockpit.now - begun < 5.0 + height:
        cockpit.run(0.2)
    cockpit.run(1.0)
    assert copter.commands(Command.NAV_TAKEOFF)
    if not isinstance(copter, ArduCopter):
        cockpit.do(SetMode(mode="MANUAL"))
        cockpit.run(2.0)
    assert copter.altitude == pytest.approx(height, abs=0.3), cockpit.texts
    assert cockpit.operator.gate_reason == ""
    return cockpit
