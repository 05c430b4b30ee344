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
    """IN1 and IN2, PWM on one, or on `enable`: DRV8833, DRV8871, L9110, MX1508, BTS7960, TB6612, L298N."""

    forward: Pin
    """Input for forward: IN1, AIN1, RPWM."""
    backward: Pin
    """Input for backward: IN2, AIN2, LPWM."""
    enable: Pin | None = None
    """PWM input beside IN1 and IN2: ENA or ENB of an L298N without its jumper, PWMA or PWMB of a TB6612.
    Without it the PWM is on IN1 and IN2: the bridge has no such input, or a jumper or wire holds it high.
    """


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
        return [pin for bridge in self.bridges for pin in astuple(bridge) if pin is not None]

    def __post_init__(self) -> None:
        reject_duplicates(self.taken)

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(pin) for pin in self.pins]


class GpioMotors:
    """Fits `vehicle.motors.Motors`. Disabled means every input low, `enable` first: the motor gets no voltage."""

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


class EnableMotor:
    """A bridge with two direction inputs and the PWM at its enable input, with the interface of gpiozero's motors.

    Enable is low while the motor is silent and while the direction changes.
    """

    def __init__(self, bridge: TwoInputs, pin_factory: Any) -> None:
        from vehicle.motors.pins import Motor, PWMOutputDevice

        with contextlib.ExitStack() as opened:
            self.enable_device = PWMOutputDevice(bridge.enable, pin_factory=pin_factory)
            opened.callback(self.enable_device.close)
            self._inputs = Motor(bridge.forward, bridge.backward, pwm=False, pin_factory=pin_factory)
            opened.pop_all()

    @property
    def value(self) -> float:
        """-1 (backward) to 1 (forward), as gpiozero's motors."""
        return float(self._inputs.value * self.enable_device.value)

    @value.setter
    def value(self, value: float) -> None:
        direction = (value > 0.0) - (value < 0.0)
        if self._inputs.value != direction:
            self.enable_device.off()
            self._inputs.value = direction
        self.enable_device.value = abs(value)

    def stop(self) -> None:
        """Set enable low, then both inputs, even if one raises."""
        with contextlib.ExitStack() as steps:
            steps.callback(self._inputs.stop)
            self.enable_device.off()

    def close(self) -> None:
        """Release the pins."""
        with contextlib.ExitStack() as steps:
            steps.callback(self._inputs.close)
            self.enable_device.close()


def _open_bridge(bridge: TwoInputs | PhaseEnable, pin_factory: Any) -> Any:
    from vehicle.motors.pins import Motor, PhaseEnableMotor

    match bridge:
        case TwoInputs(enable=None):
            return Motor(bridge.forward, bridge.backward, pwm=True, pin_factory=pin_factory)
        case TwoInputs():
            return EnableMotor(bridge, pin_factory)
        case PhaseEnable():
            return PhaseEnableMotor(bridge.phase, bridge.enable, pwm=True, pin_factory=pin_factory)


def _set_frequency(motor: Any, bridge: TwoInputs | PhaseEnable, frequency: float) -> None:
    match bridge:
        case TwoInputs(enable=None):
            motor.forward_device.frequency = motor.backward_device.frequency = frequency
        case TwoInputs() | PhaseEnable():
            motor.enable_device.frequency = frequency
