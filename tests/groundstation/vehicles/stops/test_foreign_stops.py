"""The stop matrix for a vehicle that holds the last demand for 3 s: here only what WE send can stop it in time.

Virtual time; each test first sees the motors turn, and the first shows what happens where nobody says neutral.
"""

from __future__ import annotations

from itertools import pairwise

import pytest

from dialects import messages as m
from dialects.enums import Autopilot, Command
from dialects.modes import Mode
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, Stop
from groundstation.intents.session import Quit, ReportKeyReleases, SetKeyGate
from groundstation.intents.vehicle import Arm, Disarm
from tests.fakes.rover import LATCH, FakeArduPilot
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import Cockpit

FORWARD = DriveKeyDown(key="i", throttle=1, steering=0)
LEFT = DriveKeyDown(key="j", throttle=0, steering=-1)


def driving(style: str = "hold", vehicle: FakeArduPilot | None = None) -> tuple[Cockpit, FakeArduPilot]:
    """Armed, a key held, the motors turn."""
    vehicle = vehicle or FakeArduPilot(mode=Mode.HOLD)
    cockpit = Cockpit(vehicle)
    cockpit.run(2.0)
    cockpit.do(SetStyle(style=style), Arm(held=1.0))
    cockpit.run(2.0)
    assert (cockpit.view.armed, cockpit.view.mode) == (True, "MANUAL")
    cockpit.do(ReportKeyReleases(), FORWARD, *([LEFT] if style == "hold" else []))
    cockpit.run(1.0)
    assert vehicle.moves
    return cockpit, vehicle


def assert_stopped_by_us(cockpit: Cockpit, vehicle: FakeArduPilot, since: float, within: float = 0.05) -> None:
    """Neutral long before it lets go by itself, and for good."""
    cockpit.run(1.0)
    assert not vehicle.moves
    assert vehicle.stopped_at - since <= within
    at, newest = [(at, each) for at, each in vehicle.all(m.ManualControl) if at <= vehicle.stopped_at][-1]
    assert (newest.y, newest.z) == (0, 0)
    assert at == vehicle.stopped_at, "it stopped because it was told"
    cockpit.run(10.0)
    assert vehicle.stopped_at - since <= within, "nothing moves later"


def test_the_danger_is_real() -> None:
    cockpit, vehicle = driving()
    cut = cockpit.now
    cockpit.world.cut()
    cockpit.run(LATCH - 0.1)
    assert vehicle.moves
    cockpit.run(0.5)
    assert vehicle.stopped_at - cut == pytest.approx(LATCH, abs=0.1)


def test_key_released() -> None:
    cockpit, vehicle = driving()
    released = cockpit.now
    cockpit.do(DriveKeyUp(key="i"), DriveKeyUp(key="j"))
    assert_stopped_by_us(cockpit, vehicle, released)


@pytest.mark.parametrize("style", ["hold", "latch", "step"])
def test_stop_key(style: str) -> None:
    cockpit, vehicle = driving(style)
    at = cockpit.now
    cockpit.do(Stop())
    assert_stopped_by_us(cockpit, vehicle, at)


@pytest.mark.parametrize("style", ["hold", "latch", "step"])
def test_screen_frozen(style: str) -> None:
    cockpit, vehicle = driving(style)
    frozen = cockpit.now
    cockpit.leasing = False
    assert_stopped_by_us(cockpit, vehicle, frozen, within=0.45)


@pytest.mark.parametrize("style", ["hold", "latch", "step"])
def test_gate_closed(style: str) -> None:
    cockpit, vehicle = driving(style)
    closed = cockpit.now
    cockpit.do(SetKeyGate(open=False, reason="help is open"))
    assert_stopped_by_us(cockpit, vehicle, closed)


@pytest.mark.parametrize("style", ["hold", "latch", "step"])
def test_quit(style: str) -> None:
    cockpit, vehicle = driving(style)
    at = cockpit.now
    cockpit.do(Quit())
    assert_stopped_by_us(cockpit, vehicle, at)
    assert cockpit.station.finished


@pytest.mark.parametrize("style", ["hold", "latch", "step"])
def test_station_exception(style: str) -> None:
    cockpit, vehicle = driving(style)
    at = cockpit.now
    cockpit.core.activate(at)
    cockpit.world.settle()
    assert_stopped_by_us(cockpit, vehicle, at)
    assert cockpit.core.finished


def test_disarmed_and_emergency_stop() -> None:
    for order in (Disarm(), EmergencyStop()):
        cockpit, vehicle = driving()
        at = cockpit.now
        cockpit.do(order)
        cockpit.run(1.0)
        assert not vehicle.armed
        assert vehicle.stopped_at - at <= 0.05


def test_neutral_flows_while_it_stands_armed() -> None:
    cockpit, vehicle = driving()
    cockpit.do(DriveKeyUp(key="i"), DriveKeyUp(key="j"))
    cockpit.run(2.0)
    start = cockpit.now
    cockpit.run(20.0)
    idle = [at for at, each in vehicle.all(m.ManualControl) if at >= start]
    assert len(idle) >= 5 * 20 - 1
    assert max(after - before for before, after in pairwise(idle)) <= 0.2 + 0.02
    assert not vehicle.moves


def test_arming_waits_for_neutral_and_shows_why_it_was_refused() -> None:
    vehicle = FakeArduPilot()
    vehicle._station = 254  # another ground station holds its throttle; ours is not heard
    cockpit = Cockpit(vehicle)
    cockpit.run(1.5)
    vehicle._throttle, vehicle._demand_at = 400, cockpit.now
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert not vehicle.armed
    assert cockpit.view.refusal == "arm failed: Arm: Throttle (RC3) is not neutral"
    vehicle._station = 255
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert vehicle.armed
    first_arm = next(at for at, each in vehicle.all(m.CommandLong) if each.command == Command.COMPONENT_ARM_DISARM)
    assert any(at < first_arm for at, _ in vehicle.all(m.ManualControl)), "neutral went before"


def test_the_vehicle_of_a_named_other_station_does_not_move() -> None:
    vehicle = FakeArduPilot(station=252)
    vehicle.params["MAV_GCS_SYSID"] = 252.0
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    assert cockpit.view.obeys == "obeys ground station 252 only and we are 255: use --system 252"
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    cockpit.do(ReportKeyReleases(), FORWARD)
    cockpit.run(1.0)
    assert not vehicle.moves


def test_parameters_the_vehicle_lacks_are_requested_three_times() -> None:
    vehicle = FakeArduPilot()
    cockpit = Cockpit(vehicle)
    cockpit.run(10.0)
    asked = [each.param_id for _, each in vehicle.all(m.ParamRequestRead)]
    assert asked.count("SYSID_MYGCS") == 3
    assert asked.count("RC_OVERRIDE_TIME") == 1
    assert any("drives on for 3 s" in warning for warning in cockpit.view.warnings)


def test_what_the_driver_sees_of_it() -> None:
    cockpit, vehicle = driving()
    assert {output.name: output.value for output in cockpit.view.outputs} == {"servo 1": None, "servo 3": None}
    assert cockpit.view.demand is None, "the meaning of a pulse is not known"
    vehicle.set_pulses("SERVO1", "SERVO3", "RC1", "RC3")
    cockpit.run(61.0)  # until they are requested again
    outputs = {output.name: output.value for output in cockpit.view.outputs}
    assert outputs == pytest.approx({"servo 1": -0.6, "servo 3": 0.6}), "servo 1 steers, servo 3 drives"
    assert cockpit.view.demand == pytest.approx((0.6, -0.6))
    assert cockpit.view.name == "ArduPilot rover 1"
    assert cockpit.view.battery_voltage == pytest.approx(12.0)
    assert cockpit.view.in_control


@pytest.mark.parametrize(
    ("vehicle", "words"),
    [
        (FakeVehicle(), "it stops by itself"),
        (FakeVehicle(autopilot=Autopilot.PX4), None),
        (FakeVehicle(driver=255), None),
        (FakeArduPilot(), "by its settings it drives on for 3 s"),
    ],
    ids=["own rover", "PX4", "generic with CONTROL_STATUS", "ArduPilot"],
)
def test_only_of_our_own_vehicle_it_is_known_that_it_stops(vehicle: FakeVehicle, words: str | None) -> None:
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    if words == "it stops by itself":
        vehicle.send(m.RoverDriveStatus(0, 0, 0, 0, [0] * 4, 0, 0, 0))
        cockpit.run(0.5)
    cockpit.world.cut()
    cockpit.run(3.0)
    assert not cockpit.view.alive
    assert cockpit.view.link_loss_action == words


def test_in_an_autonomous_mode_stopping_is_not_known() -> None:
    vehicle = FakeArduPilot(mode=Mode.AUTO)
    vehicle.armed = True
    cockpit = Cockpit(vehicle)
    cockpit.run(3.0)
    assert cockpit.view.link_loss_action is None
