"""Brushed motors on H-bridges at GPIO pins of a Raspberry Pi: software PWM by gpiozero and lgpio.

lgpio generates 0.1 Hz to 10 kHz, and gpiozero passes whole percents (rounded down), so the resolution is 1 %. That is
enough for wheels, but not for servos and ESCs: 1 % of their 20 ms is 200 us. Use pca9685 or sysfs-pwm for those.
A pin keeps its level when the process is killed: a bridge without a timeout of its own needs `safe_stop`, a heartbeat
pin, or both.
"""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from typing import Annotated, Any

import msgspec
from msgspec.structs import astuple

from vehicle.motors import check_throttles
from vehicle.motors.settings import Pin, pin_name, reject_duplicates


class TwoInputs(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="wiring", tag="two-inputs"
):  # fmt: skip
    """IN1 and IN2, PWM on one and low on the other: DRV8833, DRV8871, L9110, MX1508, TB6612, L298N (ENA, ENB high)."""

    forward: Pin
    """PWM input for forward, IN1."""
    backward: Pin
    """PWM input for backward, IN2."""


class PhaseEnable(
    msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="wiring", tag="phase-enable"
):  # fmt: skip
    """PWM and direction: Cytron MD boards, DRV8835 in its phase/enable mode, Pololu G2."""

    enable: Pin
    """PWM."""
    phase: Pin
    """Direction; low is forward."""


class GpioSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """H-bridges in motor order, all with the same PWM frequency."""

    bridges: Annotated[tuple[TwoInputs | PhaseEnable, ...], msgspec.Meta(min_length=1, max_length=8)]
    frequency: Annotated[float, msgspec.Meta(ge=10, le=10_000)] = 500.0
    """Hz. A higher frequency is quieter and needs more CPU time; lgpio rejects more than 10 kHz."""

    @property
    def pins(self) -> list[int]:
        """The pins of all bridges."""
        return [pin for bridge in self.bridges for pin in astuple(bridge)]

    def __post_init__(self) -> None:
        reject_duplicates(self.pins)

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(pin) for pin in self.pins]


class GpioMotors:
    """Fits `vehicle.motors.Motors`. Disabled means every input low: the bridge is off and the motor coasts."""

    Settings = GpioSettings

    def __init__(self, settings: GpioSettings, *, pin_factory: Any = None) -> None:
        """Open the pins. `pin_factory` is gpiozero's; None selects the one of this machine. Raises MotorError."""
        from vehicle.motors.pins import translated  # its library is needed to open the pins, not to check settings

        self.count = len(settings.bridges)
        self.enabled = False
        self._bridges: list[Any] = []
        self._translated = translated
        with contextlib.ExitStack() as opened, translated("motor pins"):
            for bridge in settings.bridges:
                motor = _open_bridge(bridge, pin_factory)
                opened.callback(motor.close)
                _set_frequency(motor, bridge, settings.frequency)
                self._bridges.append(motor)
            opened.pop_all()

    def enable(self) -> None:
        """Let the motors turn, from neutral."""
        if not self.enabled:
            self._stop()
            self.enabled = True

    def disable(self) -> None:
        """Set every input low."""
        self.enabled = False
        self._stop()

    def set(self, throttles: Sequence[float]) -> None:
        """Set the PWM of each bridge; no effect while disabled."""
        values = check_throttles(throttles, self.count)
        if self.enabled:
            with self._translated("motor pins"):
                for bridge, value in zip(self._bridges, values, strict=True):
                    bridge.value = value

    def close(self) -> None:
        """Set every input low, then release the pins."""
        self.enabled = False
        with contextlib.ExitStack() as steps, self._translated("motor pins"):
            for bridge in self._bridges:
                steps.callback(bridge.close)
                steps.callback(bridge.stop)
            self._bridges = []

    def _stop(self) -> None:
        with contextlib.ExitStack() as steps, self._translated("motor pins"):  # every bridge, even if one raises
            for bridge in self._bridges:
                steps.callback(bridge.stop)


def _open_bridge(bridge: TwoInputs | PhaseEnable, pin_factory: Any) -> Any:
    from vehicle.motors.pins import Motor, PhaseEnableMotor

    match bridge:
        case TwoInputs():
            return Motor(bridge.forward, bridge.backward, pwm=True, pin_factory=pin_factory)
        case PhaseEnable():
            return PhaseEnableMotor(bridge.phase, bridge.enable, pwm=True, pin_factory=pin_factory)


def _set_frequency(motor: Any, bridge: TwoInputs | PhaseEnable, frequency: float) -> None:
    match bridge:
        case TwoInputs():
            motor.forward_device.frequency = motor.backward_device.frequency = frequency
        case PhaseEnable():
            motor.enable_device.frequency = frequency
