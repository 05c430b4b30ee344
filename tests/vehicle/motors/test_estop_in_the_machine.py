"""The emergency stop's pin under the machine that drives the rover: pressed it disarms, released it starts nothing."""

from __future__ import annotations

from collections.abc import Sequence

from gpiozero.pins.mock import MockFactory

from link.core import LinkReport, Outgoing, Received
from vehicle.machine import RETRY, Machine
from vehicle.motors.safety_pins import GuardedMotors, SafetyPins
from vehicle.motors.settings import Safety
from vehicle.motors.simulated import SimulatedMotors
from vehicle.outputs import Outputs
from vehicle.readings import Readings
from vehicle.sensors import NoSensors

ESTOP, ENABLE = 17, 22


class Driver:
    """Full ahead while armed; disarmed by a motor failure, and armed again only by hand."""

    def __init__(self) -> None:
        self.armed = True
        self.reasons: list[str] = []
        self.repaired = 0

    @property
    def outputs(self) -> Outputs:
        return Outputs((1.0, 1.0) if self.armed else (0.0, 0.0), enabled=self.armed)

    def receive(self, received: Received, now: float) -> None: ...
    def tick(self, now: float) -> None: ...
    def observe(self, reports: Sequence[LinkReport], now: float) -> None: ...
    def sense(self, readings: Readings, now: float) -> None: ...
    def shutdown(self, now: float) -> None: ...

    def messages_to_send(self) -> list[Outgoing]:
        return []

    def motor_failed(self, reason: str, now: float) -> None:
        self.armed = False
        self.reasons.append(reason)

    def motor_repaired(self, now: float) -> None:
        self.repaired += 1


def test_pressed_and_released_while_driving() -> None:
    pins, wheels, driver = MockFactory(), SimulatedMotors(), Driver()
    safety = SafetyPins(Safety(estop_pin=ESTOP, enable_pin=ENABLE), pin_factory=pins)
    estop, power = pins.pin(ESTOP), pins.pin(ENABLE)
    estop.drive_low()
    machine = Machine(driver, GuardedMotors(wheels, safety), NoSensors())

    machine.tick(0.0)
    assert wheels.outputs == (1.0, 1.0)
    assert power.state

    estop.drive_high()
    assert not power.state, "the power must go without waiting for a cycle"
    machine.tick(0.02)
    assert wheels.outputs == (0.0, 0.0)
    assert driver.reasons == ["the emergency stop is pressed, or its wire is open"]

    machine.tick(0.02 + RETRY)
    assert driver.repaired == 0, "pressed it must not count as repaired"
    driver.armed = True  # somebody who arms against it
    machine.tick(1.5)
    assert wheels.outputs == (0.0, 0.0)
    assert not power.state
    driver.armed = False

    estop.drive_low()
    machine.tick(1.52 + RETRY)
    machine.tick(1.6 + 2 * RETRY)
    assert driver.repaired == 1
    assert not power.state, "released it must not start anything"
    driver.armed = True
    machine.tick(1.62 + 2 * RETRY)
    assert wheels.outputs == (1.0, 1.0)
    assert power.state
    machine.close()
    assert not power.state
