"""A rover in its control loop that counts its whole cycles."""

from __future__ import annotations

from collections.abc import Sequence

from dialects.axes import Axes
from link.core import Received
from tests.vehicle.bench import AHEAD, NEUTRAL, Bench
from vehicle.control_loop import ControlLoop
from vehicle.motors.simulated import SimulatedMotors
from vehicle.pace import BUSY_TIME
from vehicle.readings import Readings


class CountingMotors(SimulatedMotors):
    written = 0
    """How often they were set."""

    def set(self, throttles: Sequence[float]) -> None:
        self.written += 1
        super().set(throttles)


class Machine(Bench):
    """The bench with the control loop around the rover. The emergency stop is a plain attribute."""

    loop: ControlLoop | None = None
    driver: CountingMotors | None = None
    pressed: str | None = None
    sensed = 0
    """Whole cycles so far."""

    @property
    def body(self) -> ControlLoop:
        self.loop = self.loop or ControlLoop(self.rover, self.motors, self, stop_input=lambda: self.pressed)
        return self.loop

    @property
    def motors(self) -> CountingMotors:
        self.driver = self.driver or CountingMotors()
        return self.driver

    @property
    def turning(self) -> bool:
        return any(self.motors.outputs)

    def read(self, now: float) -> Readings:
        self.sensed += 1
        return self.readings

    def _tick(self) -> None:
        self.body.tick(self.now)

    def _receive(self, received: Received) -> None:
        self.body.receive(received, self.now)

    def whole_cycles(self, seconds: float, axes: Axes | None = None) -> int:
        before = self.sensed
        self.wait(seconds, axes)
        return self.sensed - before


def idle_machine() -> Machine:
    machine = Machine(FS_GCS_ENABLE=0)
    machine.wait(BUSY_TIME + 1.0)
    return machine


def cruise(machine: Machine, axes: Axes = AHEAD) -> Machine:
    machine.arm()
    machine.wait(0.5, NEUTRAL)
    machine.wait(BUSY_TIME + 2.0, axes)
    assert machine.turning
    return machine
