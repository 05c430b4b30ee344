"""The stand-ins of copters fly, fall and land as their sources say, so that a test of a stop can fail."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from dialects import messages as m
from dialects.enums import Command
from link.core import Peer, Received
from tests.fakes.flying import FlyingVehicle, Sticks
from tests.fakes.multicopters import ArduCopter, Px4Quad

STEP = 0.02


class Pilot:
    """A program that sends MANUAL_CONTROL and heartbeats without any rule."""

    def __init__(self, copter: FlyingVehicle) -> None:
        self.copter, self.now = copter, 100.0
        self.say(m.Heartbeat(6, 8, 0, 0, 4, 3))

    def say(self, message: m.Message) -> None:
        self.copter.receive(Received(message, 255, 190, 0, Peer(0, "pilot"), introduced=True), self.now)

    def command(self, command: int, *params: float) -> None:
        self.say(m.CommandLong(1, 1, command, 0, *params, *[0.0] * (7 - len(params))))

    def run(self, seconds: float, z: int | None = 500, x: int = 0) -> None:
        for count in range(round(seconds / STEP)):
            if z is not None and count % 5 == 0:
                self.say(m.ManualControl(1, x, 0, z, 0, 0))
            if z is not None and count % 25 == 0:
                self.say(m.Heartbeat(6, 8, 0, 0, 4, 3))
            self.copter.tick(self.now)
            self.now += STEP


def flown(copter: FlyingVehicle, mode: str) -> Pilot:
    """Return a pilot whose copter has taken off by its own command and is in this mode."""
    pilot = Pilot(copter)
    pilot.run(1.0)
    pilot.command(Command.COMPONENT_ARM_DISARM, 1)
    assert copter.armed
    pilot.command(Command.NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 405.0 if isinstance(copter, Px4Quad) else 5.0)
    pilot.run(8.0)
    assert copter.altitude > 4.0
    copter.set_mode(mode)
    pilot.run(0.5)
    return pilot


@pytest.mark.parametrize(("copter", "mode"), [(ArduCopter, "LOITER"), (Px4Quad, "POSCTL")])
def test_the_middle_of_z_holds_the_altitude(copter: Callable[[], FlyingVehicle], mode: str) -> None:
    pilot = flown(copter(), mode)
    pilot.run(3.0, z=800)
    assert 0.5 < pilot.copter.climb < 2.0
    pilot.run(1.0)
    before = pilot.copter.altitude
    pilot.run(5.0, x=600)
    assert pilot.copter.altitude == pytest.approx(before)
    assert pilot.copter.north > 10.0
    pilot.run(4.0)
    assert pilot.copter.speed == 0.0


@pytest.mark.parametrize(("copter", "mode"), [(ArduCopter, "STABILIZE"), (Px4Quad, "STABILIZED")])
def test_no_throttle_where_it_is_thrust_is_a_fall(copter: Callable[[], FlyingVehicle], mode: str) -> None:
    pilot = flown(copter(), mode)
    pilot.run(2.0, z=0)
    assert not pilot.copter.flies
    assert pilot.copter.hit_ground_at > 8.0


def test_arducopters_override_ends_and_its_failsafe_acts() -> None:
    pilot = flown(ArduCopter(FS_GCS_ENABLE=0), "LOITER")
    pilot.run(2.0, x=600)
    pilot.run(3.3, z=None)
    assert pilot.copter.speed > 5.0
    pilot.run(0.4, z=None)
    assert pilot.copter.mode_name == "RTL"


def test_arducopters_options_keep_pilots_modes_going() -> None:
    """16 is the default: the failsafe for the station does nothing in LOITER, and only the receiver's is left."""
    pilot = flown(ArduCopter(FS_GCS_ENABLE=1, FS_OPTIONS=16, FS_THR_ENABLE=0, RC_OVERRIDE_TIME=-1), "LOITER")
    pilot.run(2.0, x=600)
    pilot.run(20.0, z=None)
    assert pilot.copter.mode_name == "LOITER"
    assert pilot.copter.speed > 5.0


def test_a_transmitter_at_zero_takes_over_from_the_override() -> None:
    copter = ArduCopter(FS_GCS_ENABLE=0)
    copter.receiver = Sticks(z=0)
    pilot = flown(copter, "LOITER")
    pilot.run(3.2, z=None)
    before = copter.altitude
    pilot.run(1.0, z=None)
    assert copter.altitude < before - 0.5


def test_px4_holds_then_flies_home() -> None:
    pilot = flown(Px4Quad(), "POSCTL")
    pilot.run(2.0, x=600)
    pilot.run(0.4, z=None)
    assert pilot.copter.mode_name == "POSCTL"
    pilot.run(0.4, z=None)
    assert pilot.copter.mode_name == "HOLD"
    pilot.run(5.0, z=None)
    assert pilot.copter.mode_name == "AUTO_RTL"


@pytest.mark.parametrize("action", [5, 6])
def test_px4_falls_where_a_lost_link_disarms_it(action: int) -> None:
    pilot = flown(Px4Quad(NAV_RCL_ACT=action), "POSCTL")
    pilot.run(3.0, z=None)
    assert pilot.copter.hit_ground_at > 5.0


@pytest.mark.parametrize(("copter", "land"), [(ArduCopter, "LAND"), (Px4Quad, "AUTO_LAND")])
def test_it_lands_disarms_and_is_not_disarmed_in_the_air(copter: Callable[[], FlyingVehicle], land: str) -> None:
    pilot = flown(copter(), "LOITER" if copter is ArduCopter else "POSCTL")
    pilot.command(Command.COMPONENT_ARM_DISARM, 0)
    assert pilot.copter.armed
    pilot.copter.set_mode(land)
    pilot.run(12.0)
    assert not pilot.copter.armed
    assert 0.0 < pilot.copter.hit_ground_at < 1.0


def test_arducopter_arms_with_a_middle_throttle_in_loiter_only() -> None:
    for mode, arms in (("LOITER", True), ("STABILIZE", False)):
        pilot = Pilot(ArduCopter(mode))
        pilot.run(1.0)
        pilot.command(Command.COMPONENT_ARM_DISARM, 1)
        assert pilot.copter.armed is arms
    pilot = Pilot(ArduCopter())
    pilot.run(1.0, z=700)
    pilot.command(Command.COMPONENT_ARM_DISARM, 1)
    assert not pilot.copter.armed
