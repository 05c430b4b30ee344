"""A control cycle writes the motors before it builds any message."""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command
from link.core import Peer, Received
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.sensors import NoSensors

CYCLE = 0.02


class Watched(SimulatedMotors):
    """Notes how much the rover had to say when each value came."""

    def __init__(self, rover: Rover) -> None:
        super().__init__()
        self._rover = rover
        self.said: list[int] = []

    def set(self, throttles: Sequence[float]) -> None:
        self.said.append(len(self._rover._outbox._outgoing))
        super().set(throttles)


def test_a_cycle_writes_the_motors_before_it_builds_a_message() -> None:
    rover = Rover(Params(), now=0.0)
    motors = Watched(rover)
    machine = ControlLoop(rover, motors, NoSensors())
    peer, told = Peer(0, "gcs"), 0

    def say(message: m.Message, number: int, now: float) -> None:
        machine.receive(Received(message, 255, 190, number % 256, peer, True), now)
        machine.messages_to_send()

    machine.tick(0.0)
    say(m.Heartbeat(6, 8, 0, 0, 4, 3), 0, 0.0)
    say(m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0), 1, 0.0)
    for number in range(2, 202):
        now = number * CYCLE
        say(build_manual_control(Axes(throttle=0.5 if number > 20 else 0.0), 1), number, now)
        motors.said.clear()
        machine.tick(now)
        assert motors.said == [0] or number < 50  # once, with nothing made before
        told += len(machine.messages_to_send())
    assert any(motors.outputs)
    assert told > 20
