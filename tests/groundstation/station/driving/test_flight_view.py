"""What the station tells its screens of a copter in the air: by a stand-in whose motion is ground truth."""

from __future__ import annotations

import pytest

from dialects import messages as m
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.vehicle import SetMode
from groundstation.snapshot import VehicleView
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.flight import FlightCockpit, hovering_cockpit

WIND = (1.5, 2.0)


def view(cockpit: FlightCockpit) -> VehicleView:
    seen = cockpit.station.snapshot(cockpit.now, 0.0).vehicle
    assert seen is not None
    return seen


@pytest.mark.parametrize(("build", "drifting"), [(ArduCopter, "ALT_HOLD"), (Px4Quad, "ALTITUDE")])
def test_the_wind_is_told_only_of_what_should_stand(build: type[ArduCopter | Px4Quad], drifting: str) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    copter.wind = WIND
    cockpit.run(12.0)
    assert (copter.speed, view(cockpit).drift) == (0.0, None)
    cockpit.do(SetMode(mode=drifting))
    cockpit.run(12.0)
    assert copter.speed == pytest.approx(2.5)
    assert view(cockpit).drift == pytest.approx(2.5, abs=0.1)
    cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0))
    cockpit.run(1.0)
    assert copter.speed > 2.5
    assert view(cockpit).drift is None
    cockpit.do(DriveKeyUp(key="i"), SetMode(mode="LAND"))
    cockpit.run(20.0)
    assert not copter.flies
    assert view(cockpit).drift is None


@pytest.mark.parametrize("build", [ArduCopter, Px4Quad])
def test_altitude_climb_and_the_way_home_are_those_of_the_copter(build: type[ArduCopter | Px4Quad]) -> None:
    cockpit = hovering_cockpit(build())
    copter = cockpit.copter
    copter.send(m.HomePosition(470000000, 80000000, 400000, 0, 0, 0, [1, 0, 0, 0], 0, 0, 0))
    cockpit.do(DriveKeyDown(key="i", throttle=1, steering=0), DriveKeyDown(key="w", throttle=0, steering=0, climb=1))
    cockpit.run(2.0)
    seen = view(cockpit)
    assert copter.altitude > 5.5
    assert seen.altitude == pytest.approx(copter.altitude, abs=0.4)
    assert seen.climb == pytest.approx(copter.climb, abs=0.3)
    assert seen.speed_over_ground == pytest.approx(copter.speed, abs=0.8)
    assert seen.home is not None
    assert seen.position is not None
    assert seen.position[0] - seen.home[0] == pytest.approx(copter.north, abs=1.5)
    assert seen.take_off == 3.0


def test_a_lost_fix_a_bad_estimate_and_a_breach_arrive() -> None:
    cockpit = hovering_cockpit(ArduCopter())
    cockpit.copter.send(m.GpsRawInt(0, 1, 0, 0, 0, 0xFFFF, 0xFFFF, 0xFFFF, 0xFFFF, 3))
    cockpit.copter.send(m.EkfStatusReport(0x1FF & ~(1 << 7), 0.1, 0.1, 0.1, 0.9, 0.0))
    cockpit.copter.send(m.FenceStatus(1, 1, 2, 0))
    cockpit.run(1.0)
    seen = view(cockpit)
    assert seen.gps_fix == 1
    assert [line.text for line in seen.health if line.name == "estimate"] == ["compass variance 0.90"]
    assert seen.breach == "above the highest altitude of the fence"
