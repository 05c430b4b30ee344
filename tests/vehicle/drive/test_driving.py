"""The whole vehicle without its process: rover, control loop, motors and simulated body, driven by messages."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

import pytest

from dialects.axes import Axes, build_manual_control
from dialects.enums import Autopilot, Command, DriveType, ModeFlag, SystemState, VehicleType
from dialects.messages import CommandLong, Heartbeat, LocalPositionNed, Message, StatusText, SysStatus
from link.core import Peer, Received
from vehicle.control_loop import MOTOR_RETRY_TIME, ControlLoop
from vehicle.motors import MotorError
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody
from vehicle.sim.chassis import AckermannChassis, Chassis, SkidChassis

Kind = TypeVar("Kind", bound=Message)

AHEAD = Axes(throttle=0.8)
CYCLE = 0.02


class Unplugged(SimulatedMotors):
    """Simulated motors with a cable that comes loose."""

    plugged = True

    def set(self, throttles: Sequence[float]) -> None:
        if not self.plugged:
            raise MotorError("no answer")
        super().set(throttles)


class Drive:
    """A vehicle with its driver; time passes in `run`."""

    def __init__(self, params: Params | None = None, battery: float = 1.0, chassis: Chassis | None = None) -> None:
        self.now = 1000.0
        self.motors = Unplugged()
        self.rover = Rover(params or Params(), now=self.now)
        body = SimulatedBody(lambda: self.motors.outputs, battery=Battery(battery), chassis=chassis or SkidChassis())
        self.machine = ControlLoop(self.rover, self.motors, body)
        self.said: list[Message] = []
        self._sequence = 0
        self.run(0.5)

    def run(self, seconds: float, demand: Axes | None = None) -> None:
        """Run the control cycles of the vehicle; the operator sends `demand` at 25 Hz."""
        for cycle in range(round(seconds / CYCLE)):
            self.now += CYCLE
            if demand is not None and cycle % 2 == 0:
                self.say(build_manual_control(demand, 1))
            self.machine.tick(self.now)
            self.said += [outgoing.message for outgoing in self.machine.messages_to_send()]

    def say(self, message: Message) -> None:
        """Send a message of the operator."""
        self._sequence = (self._sequence + 1) % 256
        self.machine.receive(Received(message, 255, 190, self._sequence, Peer(0, "gcs"), introduced=True), self.now)

    def arm(self) -> None:
        """Take control and arm with a neutral demand."""
        self.say(Heartbeat(VehicleType.GCS, Autopilot.INVALID, 0, 0, SystemState.ACTIVE, 3))
        self.say(CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0))
        self.run(1.2, Axes())

    @property
    def armed(self) -> bool:
        """Armed according to the newest HEARTBEAT."""
        return bool(self.newest(Heartbeat).base_mode & ModeFlag.ARMED)

    def newest(self, kind: type[Kind]) -> Kind:
        """The newest message of a kind."""
        return [message for message in self.said if isinstance(message, kind)][-1]

    def texts(self) -> str:
        """Return all STATUSTEXTs."""
        return "\n".join(message.text for message in self.said if isinstance(message, StatusText))


def driving(battery: float = 1.0) -> Drive:
    drive = Drive(battery=battery)
    drive.arm()
    drive.run(1.0, AHEAD)
    assert drive.motors.outputs == pytest.approx((0.8, 0.8), abs=0.05)
    return drive


def test_driving_north_is_reported_in_telemetry() -> None:
    drive = driving()
    drive.run(4.0, AHEAD)
    position = drive.newest(LocalPositionNed)
    assert position.x > 3.0
    assert position.y == pytest.approx(0.0, abs=0.01)
    assert position.vx > 1.0


def test_the_rover_stops_when_the_demands_stop() -> None:
    drive = driving()
    drive.run(1.5)
    assert drive.motors.outputs == (0.0, 0.0)
    before = drive.newest(LocalPositionNed).x
    drive.run(1.0)
    assert drive.newest(LocalPositionNed).x == pytest.approx(before, abs=0.01)


def test_steering_right_turns_the_nose_right() -> None:
    drive = driving()
    drive.run(2.0, Axes(throttle=0.3, steering=0.3))
    assert drive.newest(LocalPositionNed).y > 0.1


def test_an_ackermann_drive_steers() -> None:
    drive = Drive(Params({"DRIVE_TYPE": DriveType.ACKERMANN}), chassis=AckermannChassis())
    drive.arm()
    drive.run(2.0, Axes(throttle=0.8, steering=0.5))
    assert drive.motors.outputs[1] > 0.2
    assert drive.newest(LocalPositionNed).y > 0.1


def test_a_motor_failure_disarms_and_a_repair_allows_arming() -> None:
    drive = driving()
    drive.motors.plugged = False
    drive.run(CYCLE, AHEAD)
    assert drive.motors.outputs == (0.0, 0.0)
    assert not drive.motors.enabled
    drive.run(2 * MOTOR_RETRY_TIME, AHEAD)
    assert not drive.armed
    assert "no answer" in drive.texts()
    drive.arm()
    assert not drive.armed, "the fault is still there"
    drive.motors.plugged = True
    drive.run(2 * MOTOR_RETRY_TIME)
    drive.arm()
    assert drive.armed
    drive.run(1.0, AHEAD)
    assert drive.motors.outputs == pytest.approx((0.8, 0.8), abs=0.05)


def test_an_empty_battery_ends_the_drive() -> None:
    drive = driving(battery=0.05)
    assert drive.newest(SysStatus).voltage_battery < 10_500
    drive.run(40.0, AHEAD)
    assert drive.motors.outputs == (0.0, 0.0)


def test_after_shutdown_nothing_turns_and_last_state_is_poweroff() -> None:
    drive = driving()
    drive.machine.shutdown(drive.now)
    assert drive.motors.outputs == (0.0, 0.0)
    drive.run(1.0, AHEAD)
    assert drive.motors.outputs == (0.0, 0.0)
    assert drive.newest(Heartbeat).system_status == SystemState.POWEROFF
    assert not drive.armed
