"""Safety pins around any motor driver: an emergency stop, a power switch and a heartbeat on GPIO pins.

The stop is a normally closed contact to ground: pressed, unplugged and broken have the same effect. While the contact
is open no motor can be enabled, `set` raises, and the enable pin is switched off at the edge, from gpiozero's thread.
The rover reads the stop in each cycle and latches its emergency stop (vehicle/safety/state_machine.py): closing the
contact starts and releases nothing.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import Any

from vehicle.motors import MotorError, Motors, StopPressedError, arming_check
from vehicle.motors.pins import DigitalInputDevice, DigitalOutputDevice, translated
from vehicle.motors.settings import SafetyPinSettings

PRESSED = "the emergency stop is pressed, or its wire is open"


class SafetyPins:
    """The pins. The power is off after construction."""

    def __init__(self, safety: SafetyPinSettings, *, pin_factory: Any = None) -> None:
        """Open the pins. Raises MotorError."""
        self.tripped = False
        """The stop was open at some time since the power was switched on."""
        self._opened_since_poll = False
        """The stop was open at some time since the last `poll_pressed`."""
        self._enable = self._estop = self._heartbeat = None
        with contextlib.ExitStack() as opened, translated("safety pins"):
            opened.callback(self.close)
            if safety.enable_pin is not None:
                self._enable = DigitalOutputDevice(
                    safety.enable_pin, active_high=safety.enable_active_high, pin_factory=pin_factory
                )
            if safety.heartbeat_pin is not None:
                self._heartbeat = DigitalOutputDevice(safety.heartbeat_pin, pin_factory=pin_factory)
            if safety.estop_pin is not None:
                self._estop = DigitalInputDevice(safety.estop_pin, pull_up=True, pin_factory=pin_factory)
                self._estop.when_deactivated = self._trip
            opened.pop_all()

    def poll_pressed(self) -> bool:
        """Return whether the stop is open, or was since the last call. Raises MotorError if it cannot be read."""
        opened = self._opened_since_poll
        if opened:  # conditional: an edge in gpiozero's thread between these two lines would be lost otherwise
            self._opened_since_poll = False
        return self._is_open() or opened

    def require_closed(self) -> None:
        """Raise StopPressedError if the stop is open, or was since the power was switched on. Raises MotorError."""
        if self._is_open():
            self._trip()
        if self.tripped:
            raise StopPressedError(PRESSED)

    def power_on(self) -> None:
        """Switch the power of the motors on. Raises MotorError if the stop is open."""
        self.tripped = False
        self.require_closed()
        with translated("enable pin"):
            if self._enable is not None:
                self._enable.on()
        try:
            self.require_closed()  # the stop may have opened before `on`
        except MotorError:
            self.power_off()
            raise

    def power_off(self) -> None:
        """Switch the power and the heartbeat off."""
        with translated("enable pin"), contextlib.ExitStack() as steps:
            for pin in (self._heartbeat, self._enable):
                if pin is not None:
                    steps.callback(pin.off)
        self.tripped = False

    def toggle_heartbeat(self) -> None:
        """Toggle the heartbeat pin."""
        if self._heartbeat is not None:
            with translated("heartbeat pin"):
                self._heartbeat.toggle()

    def close(self) -> None:
        """Switch the power off and release the pins. May be called twice."""
        pins = [pin for pin in (self._heartbeat, self._enable, self._estop) if pin is not None]
        with translated("safety pins"), contextlib.ExitStack() as steps:
            for pin in pins:
                steps.callback(pin.close)
            steps.callback(self.power_off)
        self._enable = self._estop = self._heartbeat = None

    def _is_open(self) -> bool:
        with translated("emergency stop"):
            return self._estop is not None and not self._estop.is_active

    def _trip(self) -> None:
        """Latch the stop and switch the power off. Also called from gpiozero's thread at the edge."""
        self.tripped = self._opened_since_poll = True
        if self._enable is not None:
            self._enable.off()


class GuardedMotors:
    """Motors of any driver behind safety pins. Fits `vehicle.motors.Motors`."""

    def __init__(self, motors: Motors, pins: SafetyPins) -> None:
        self.count = motors.count
        self._motors = motors
        self._pins = pins
        self._enabled = False

    def enable(self) -> None:
        """Enable the driver, then switch the power on. Raises StopPressedError while the stop is open."""
        if not self._enabled:
            self._pins.tripped = False  # a stop without power is latched by the rover
        self._pins.require_closed()
        self._motors.enable()
        if not self._enabled:
            self._power_on()

    def disable(self) -> None:
        """Switch the power off, then disable the driver."""
        self._enabled = False
        _both(self._pins.power_off, self._motors.disable)

    def set(self, throttles: Sequence[float]) -> None:
        """Set the motors and toggle the heartbeat. Raises StopPressedError while the stop is open."""
        self._pins.require_closed()
        self._motors.set(throttles)
        if self._enabled:
            self._pins.toggle_heartbeat()

    def prove(self) -> None:
        """Run the arming check of the driver. Raises MotorError."""
        arming_check(self._motors)()

    def stop_pressed(self) -> str | None:
        """Return why the stop is active, or None: see vehicle.motors.estop_reader."""
        return PRESSED if self._pins.poll_pressed() else None

    def close(self) -> None:
        """Switch the power off, close the driver, then release the pins."""
        self._enabled = False
        with contextlib.ExitStack() as steps:
            steps.callback(self._pins.close)
            _both(self._pins.power_off, self._motors.close)

    def _power_on(self) -> None:
        try:
            self._pins.power_on()
        except MotorError:
            self._motors.disable()
            raise
        self._enabled = True


def _both(first: Callable[[], None], second: Callable[[], None]) -> None:
    with contextlib.ExitStack() as steps:
        steps.callback(second)
        first()
