"""The station and the rover meet: messages that are sent on request only arrive as soon as they see each other."""

from __future__ import annotations

import pytest

from dialects.messages import ManualControl, RoverDriveStatus, RoverOperatorPresence
from groundstation.snapshot import VehicleView
from link.protocol.peer_table import PEER_SILENCE
from tests.test_stops import Drive
from tests.world import Host
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.safety.states import SafetyState
from vehicle.sensors import NoSensors


def view(drive: Drive) -> VehicleView | None:
    return drive.station.snapshot(drive.world.now, 0).vehicle


def complete(drive: Drive) -> bool:
    """Return whether CONTROL_STATUS and ROVER_DRIVE_STATUS have arrived: who is in control, and why nothing moves."""
    vehicle = view(drive)
    return vehicle is not None and vehicle.driver is not None and "disarmed" in vehicle.limits


def test_all_of_ours_is_there_at_once() -> None:
    drive = Drive(delay=0.01)
    found = drive.until(lambda: view(drive) is not None)
    assert found < 1.1
    assert drive.until(lambda: complete(drive)) < 0.2


@pytest.mark.parametrize("seed", range(10))
def test_a_bad_link_takes_it_some_tries(seed: int) -> None:
    drive = Drive(delay=0.03, loss=0.3, seed=seed)
    drive.until(lambda: view(drive) is not None)
    assert drive.until(lambda: complete(drive), within=15.0) < 5.0


def test_it_comes_back_after_a_long_cut() -> None:
    drive = Drive()
    drive.run(5.0)
    drive.world.cut()
    drive.run(PEER_SILENCE + 5.0)
    drive.world.cut(False)
    assert drive.until(lambda: view(drive) is not None and view(drive).alive) < 1.1  # type: ignore[union-attr]
    assert drive.until(lambda: complete(drive)) < 0.5


def test_it_comes_back_when_the_vehicle_has_restarted_unnoticed() -> None:
    drive = Drive()
    drive.run(5.0)
    assert complete(drive)
    now, motors = drive.world.now, SimulatedMotors()
    rover = Rover(Params({}), now=now)
    channel = drive.world._channel("far", (1, 1), "near")
    drive.world.far = Host(ControlLoop(rover, motors, NoSensors()), channel, 0.02)
    drive.run(3.0)
    told = [message for at, message in drive.world.far.sent if at > drive.world.now - 1.0]
    assert any(isinstance(message, RoverDriveStatus) for message in told)


def test_the_first_demand_has_its_proof_of_life() -> None:
    drive = Drive()
    drive.get_going()
    sent = [message for _, message in drive.world.near.sent]
    first = next(n for n, message in enumerate(sent) if isinstance(message, ManualControl))
    assert isinstance(sent[first - 1], RoverOperatorPresence)


def test_armed_is_seen_at_once() -> None:
    drive = Drive(delay=0.01)
    drive.get_going()
    drive.rover.motor_failed("broken", drive.world.now)
    assert drive.rover.state is not SafetyState.ARMED
    assert drive.until(lambda: not view(drive).armed) < 0.1  # type: ignore[union-attr]
