"""An emergency stop, a power switch and a sign of life on GPIO pins, around any driver; they work without the rover.

The stop is a normally closed contact to ground: pressed, unplugged and broken are the same. While it is open no motor
can be enabled, `set` raises, and the enable pin is off at the edge already, from gpiozero's own thread. The rover asks
for it each cycle and latches its emergency stop (vehicle/safety/state_machine.py): closing the contact starts and releases nothing.
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
    """The pins themselves. Made with the power off."""

    def __init__(self, safety: SafetyPinSettings, *, pin_factory: Any = None) -> None:
        """Raises MotorError."""
        self.tripped = False
        """The stop was open at some time since the power was switched on."""
        self._noticed = False
        """... since `pressed` was asked last."""
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
        """The stop is open, or was since the last call. Raises MotorError where it cannot be read."""
        noticed = self._noticed
        if noticed:  # and only then, or an edge in gpiozero's thread between the two lines would be forgotten
            self._noticed = False
        return self._open() or noticed

    def require_closed(self) -> None:
        """Raises StopPressedError where the stop is open, or was since the power was switched on; MotorError."""
        if self._open():
            self._trip()
        if self.tripped:
            raise StopPressedError(PRESSED)

    def power_on(self) -> None:
        """Let the motors have power. Raises MotorError where the stop is open."""
        self.tripped = False
        self.require_closed()
        with translated("enable pin"):
            if self._enable is not None:
                self._enable.on()
        try:
            self.require_closed()  # pressed in between: its edge came before `on`
        except MotorError:
            self.power_off()
            raise

    def power_off(self) -> None:
        """No power, and no sign of life."""
        with translated("enable pin"), contextlib.ExitStack() as steps:
            for pin in (self._heartbeat, self._enable):
                if pin is not None:
                    steps.callback(pin.off)
        self.tripped = False

    def toggle_heartbeat(self) -> None:
        """Change the heartbeat pin."""
        if self._heartbeat is not None:
            with translated("heartbeat pin"):
                self._heartbeat.toggle()

    def close(self) -> None:
        """Power off and let the pins go. May come twice."""
        pins = [pin for pin in (self._heartbeat, self._enable, self._estop) if pin is not None]
        with translated("safety pins"), contextlib.ExitStack() as steps:
            for pin in pins:
                steps.callback(pin.close)
            steps.callback(self.power_off)
        self._enable = self._estop = self._heartbeat = None

    def _open(self) -> bool:
        with translated("emergency stop"):
            return self._estop is not None and not self._estop.is_active

    def _trip(self) -> None:
        """Also called from gpiozero's thread at the edge."""
        self.tripped = self._noticed = True
        if self._enable is not None:
            self._enable.off()


class GuardedMotors:
    """Any motors, behind safety pins. Fits `vehicle.motors.Motors`."""

    def __init__(self, motors: Motors, pins: SafetyPins) -> None:
        self.count = motors.count
        self._motors = motors
        self._pins = pins
        self._enabled = False

    def enable(self) -> None:
        """The driver first, from neutral, then the power. Raises StopPressedError while the stop is open."""
        if not self._enabled:
            self._pins.tripped = False  # what was while there was no power is the rover's to remember
        self._pins.require_closed()
        self._motors.enable()
        if not self._enabled:
            self._power_on()

    def disable(self) -> None:
        """The power first, then the driver."""
        self._enabled = False
        _both(self._pins.power_off, self._motors.disable)

    def set(self, throttles: Sequence[float]) -> None:
        """Set the motors and beat. Raises StopPressedError while the stop is open."""
        self._pins.require_closed()
        self._motors.set(throttles)
        if self._enabled:
            self._pins.toggle_heartbeat()

    def prove(self) -> None:
        """What the driver has to prove; the pins need no proof."""
        arming_check(self._motors)()

    def stop_pressed(self) -> str | None:
        """Why the stop stops, or None: see vehicle.motors.stop_input."""
        return PRESSED if self._pins.poll_pressed() else None

    def close(self) -> None:
        """Power off, driver closed, pins let go."""
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
