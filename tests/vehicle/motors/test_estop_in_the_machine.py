"""The emergency stop's pin under the real rover: pressed it stops and stays, let go it starts and releases nothing."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import pytest
from gpiozero.pins.mock import MockFactory

from dialects import messages as m
from dialects.enums import Command, Failsafe, ModeFlag, Result, SystemState
from link.core import Received
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, OTHER, Bench, said
from vehicle.control_loop import MOTOR_RETRY_TIME, ControlLoop
from vehicle.drive.gate import Outputs
from vehicle.motors import MotorError, estop_reader
from vehicle.motors.drivers import open_motors
from vehicle.motors.safety_pins import PRESSED, GuardedMotors, SafetyPins
from vehicle.motors.settings import SafetyPinSettings
from vehicle.motors.simulated import SimulatedMotors
from vehicle.safety import states
from vehicle.sensors import NoSensors

ESTOP, ENABLE = 17, 22
SWITCH, DANGEROUS = Command.DO_SET_SAFETY_SWITCH_STATE, 1
ZERO = Outputs((0.0, 0.0), enabled=False)


class Car(Bench):
    """The rover in its machine, with the pins of a header; the contact is closed unless `pressed`."""

    def __init__(self, *, pressed: bool = False, enable_pin: int | None = ENABLE) -> None:
        factory = MockFactory()
        self.wheels = SimulatedMotors()
        self.contact, self.power = factory.pin(ESTOP), factory.pin(ENABLE)
        self.pins = SafetyPins(SafetyPinSettings(estop_pin=ESTOP, enable_pin=enable_pin), pin_factory=factory)
        self.press() if pressed else self.let_go()
        super().__init__()

    @cached_property
    def machine(self) -> ControlLoop:
        guarded = GuardedMotors(self.wheels, self.pins)
        return ControlLoop(self.rover, guarded, NoSensors(), stop_input=estop_reader(guarded))

    def press(self) -> None:
        self.contact.drive_high()

    def let_go(self) -> None:
        self.contact.drive_low()

    @property
    def rolling(self) -> bool:
        return any(self.wheels.outputs)

    def drive(self, *_: Any) -> None:
        super().drive()
        assert self.rolling

    def _receive(self, received: Received) -> None:
        self.machine.receive(received, self.now)

    def _tick(self) -> None:
        self.machine.tick(self.now)


def state(car: Car) -> states.SafetyState:
    return car.rover.state


@pytest.mark.parametrize("enable_pin", [ENABLE, None])
def test_a_press_turns_all_off_in_the_cycle_and_enters_the_estop(
    enable_pin: int | None,
) -> None:
    car = Car(enable_pin=enable_pin)
    car.drive()
    assert car.power.state == (enable_pin is not None)
    car.press()
    assert not car.power.state, "the power must go without waiting for a cycle"
    car.cycle()
    assert car.rover.outputs == ZERO
    assert (car.wheels.outputs, car.wheels.enabled) == ((0.0, 0.0), False)
    assert state(car) is states.SafetyState.ESTOP
    car.wait(0.2, AHEAD)
    beat = car.newest(m.Heartbeat)
    assert beat.system_status == SystemState.EMERGENCY
    assert not beat.base_mode & ModeFlag.ARMED
    failsafes = car.newest(m.RoverFailsafeStatus)
    assert failsafes.active == failsafes.latched == Failsafe.ESTOP, "it is not a fault of the motor driver"
    assert [text for text in car.texts if "EMERGENCY" in text] == [f"EMERGENCY STOP by button: {PRESSED}"]
    assert not said(car, "Motor driver failed")


def test_a_message_between_press_and_cycle_stops_too() -> None:
    car = Car()
    car.drive()
    car.press()
    car.stick(NEUTRAL)
    assert state(car) is states.SafetyState.ESTOP
    assert not car.rolling
    assert not car.wheels.enabled


def test_leaving_needs_a_closed_contact_control_and_arming() -> None:
    car = Car()
    car.drive()
    car.press()
    car.wait(0.5, NEUTRAL)
    assert car.command(SWITCH, DANGEROUS) is Result.FAILED
    car.wait(0.2, NEUTRAL)
    assert said(car, f"GCS {DRIVER}: release refused: {PRESSED}")
    assert car.arm() is Result.FAILED
    car.wait(0.2, NEUTRAL)
    assert said(car, f"PreArm: {PRESSED}")

    car.let_go()
    car.wait(3 * MOTOR_RETRY_TIME, AHEAD)
    assert state(car) is states.SafetyState.ESTOP, "closing the contact releases nothing"
    assert car.arm() is Result.FAILED
    assert car.command(SWITCH, DANGEROUS, system=OTHER) is Result.FAILED
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED
    assert state(car) is states.SafetyState.SAFE
    car.wait(1.0, AHEAD)
    assert not car.rolling
    car.wait(0.1, NEUTRAL)
    car.drive()
    assert car.power.state


def test_open_at_boot_nothing_arms_and_the_checks_say_why() -> None:
    car = Car(pressed=True)
    assert state(car) is states.SafetyState.ESTOP
    assert car.arm() is Result.FAILED
    assert car.command(Command.COMPONENT_ARM_DISARM, 1, 21196) is Result.FAILED, "nor by force"
    assert car.command(Command.RUN_PREARM_CHECKS) is Result.ACCEPTED
    car.wait(0.2)
    assert car.texts.count(f"PreArm: {PRESSED}") == 1
    assert car.newest(m.Heartbeat).system_status == SystemState.EMERGENCY
    car.let_go()
    car.wait(CYCLE)
    assert car.arm() is Result.FAILED
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED
    car.drive()


def test_press_while_disarmed_lasts_even_if_shorter_than_a_cycle() -> None:
    car = Car()
    car.press()
    car.let_go()
    car.cycle()
    assert state(car) is states.SafetyState.ESTOP
    assert car.arm() is Result.FAILED
    car.cycle()
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED
    car.drive()
    assert state(car) is states.SafetyState.ARMED, "an old touch must not come back"


def test_pressed_between_arming_and_the_first_cycle() -> None:
    car = Car()
    car.press()
    assert car.arm() is Result.ACCEPTED  # the cycle has not asked yet
    car.stick(NEUTRAL)
    car.stick(AHEAD)
    assert not car.rolling
    car.cycle()
    assert state(car) is states.SafetyState.ESTOP
    assert not car.rolling


def test_station_stop_is_not_released_while_the_contact_is_open() -> None:
    car = Car()
    car.drive()
    car.command(SWITCH, 0)
    car.press()
    car.cycle()
    assert car.command(SWITCH, DANGEROUS) is Result.FAILED
    car.let_go()
    car.cycle()
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED


def test_a_contact_that_cannot_be_read_is_open(monkeypatch: pytest.MonkeyPatch) -> None:
    car = Car()
    car.drive()

    def broken() -> bool:
        raise MotorError("emergency stop: Input/output error")

    monkeypatch.setattr(car.pins, "_is_open", broken)
    car.cycle()
    assert not car.rolling
    assert state(car) is states.SafetyState.ESTOP
    car.wait(0.1)
    assert said(car, "EMERGENCY STOP by button: emergency stop: Input/output error")
    assert car.command(SWITCH, DANGEROUS) is Result.FAILED
    monkeypatch.undo()
    car.cycle()
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED


def test_a_failed_driver_is_not_forgotten_behind_the_stop() -> None:
    car = Car()
    car.rover.motor_failed("no answer", car.now)
    car.press()
    car.cycle()
    assert state(car) is states.SafetyState.ESTOP
    car.let_go()
    car.cycle()
    assert car.command(SWITCH, DANGEROUS) is Result.ACCEPTED
    assert state(car) is states.SafetyState.FAULT


def test_after_the_end_the_contact_says_nothing_any_more() -> None:
    car = Car()
    car.machine.shutdown(car.now)
    car.rover.update_estop_input(PRESSED, car.now)
    assert state(car) is states.SafetyState.OFF


def test_a_driver_without_such_an_input_never_stops() -> None:
    assert estop_reader(open_motors("simulated"))() is None
