"""Hardware PWM of the Raspberry Pi through /sys/class/pwm: bridges without noise, and servo pulses without jitter.

A chip is found by its device (`fe20c000.pwm`), because its number moves between kernels.
The hardware goes on with its last duty when the process is killed: `safe_stop` is what ends it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any

import msgspec

from vehicle.motors import MotorError, check_throttles, pwm_channel
from vehicle.motors.pulses import Idle, Pulse
from vehicle.motors.pwm_channel import SysfsPwmChannel, export_channel
from vehicle.motors.settings import Pin, pin_name, reject_duplicates

Number = Annotated[int, msgspec.Meta(ge=0, le=7)]
PWM_PINS = (12, 13, 18, 19)
"""Of the header, on every Pi."""


class BridgePwm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="drives", tag="bridge"):
    """An H-bridge with a PWM and a direction input."""

    device: str
    """Of the chip, as in its path below /sys/devices."""
    channel: Number
    direction: Pin
    """Low is forward."""
    frequency: Annotated[float, msgspec.Meta(ge=50, le=100_000)] = 20_000.0
    """Hz; 20 kHz cannot be heard."""


class ServoPwm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="drives", tag="servo"):
    """An ESC or a servo."""

    device: str
    channel: Number
    pulse: Pulse = Pulse()
    frequency: Annotated[float, msgspec.Meta(ge=40, le=400)] = 50.0

    def __post_init__(self) -> None:
        self.pulse.check_period(self.frequency)


Output = BridgePwm | ServoPwm


class SysfsPwmSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Outputs in motor order."""

    outputs: Annotated[tuple[Output, ...], msgspec.Meta(min_length=1, max_length=4)]
    idle: Idle = "neutral"
    """For servo outputs; a bridge without duty is always off."""

    def __post_init__(self) -> None:
        names = [(output.device, output.channel) for output in self.outputs]
        if len(set(names)) < len(names):
            raise ValueError("a channel is used twice")
        reject_duplicates(self.pins)

    @property
    def pins(self) -> list[int]:
        """Directions of bridges."""
        return [output.direction for output in self.outputs if isinstance(output, BridgePwm)]

    @property
    def taken(self) -> list[str]:
        """Pins."""
        return [pin_name(pin) for pin in self.pins]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Where the hardware PWM may come out: which of them is an overlay's matter."""
        return PWM_PINS


class BridgeOutput:
    """One motor on a bridge."""

    def __init__(self, channel: SysfsPwmChannel, direction: Any) -> None:
        self._channel = channel
        self._direction = direction
        self._backward = False

    def set_idle(self) -> None:
        """No duty, output off."""
        self._channel.stop()
        self._channel.set_period()

    def start(self) -> None:
        """Duty 0, then on."""
        self._channel.set_duty(0)
        self._channel.start()

    def set(self, throttle: float) -> None:
        """The duty is 0 while the direction changes, so that no full pulse goes the wrong way."""
        if throttle != 0.0 and (throttle < 0.0) != self._backward:
            self._channel.set_duty(0)
            self._backward = throttle < 0.0
            self._direction.value = self._backward
        self._channel.set_duty(round(abs(throttle) * self._channel.period))

    def close(self) -> None:
        """Let go of the pin."""
        self._direction.close()


class ServoOutput:
    """One motor behind an ESC, or a steering servo."""

    def __init__(self, channel: SysfsPwmChannel, pulse: Pulse, idle: Idle) -> None:
        self._channel = channel
        self._pulse = pulse
        self._idle = idle

    def set_idle(self) -> None:
        """What `idle` says where there are pulses; where there are none, none."""
        if self._channel.is_running and self._idle == "neutral":
            self._channel.set_period()
            self.set(0.0)
        else:
            self._channel.stop()
            self._channel.set_period()

    def start(self) -> None:
        """Neutral, then on."""
        self.set(0.0)
        self._channel.start()

    def set(self, throttle: float) -> None:
        """The width of the pulse."""
        self._channel.set_duty(round(self._pulse.width(throttle) * 1e9))

    def close(self) -> None:
        """Nothing to let go of: the channel stays exported, so that its permissions stay too."""


class SysfsPwmMotors:
    """Fits `vehicle.motors.Motors`."""

    Settings = SysfsPwmSettings

    def __init__(
        self,
        settings: SysfsPwmSettings,
        *,
        root: Path | None = None,
        write: Callable[[Path, str], None] | None = None,
        pin_factory: Any = None,
    ) -> None:
        """`root`, `write` and `pin_factory` are for tests. Raises MotorError."""
        root, write = root or pwm_channel.ROOT, write or pwm_channel.write_file
        self.count = len(settings.outputs)
        self.enabled = False
        self._outputs: list[BridgeOutput | ServoOutput] = []
        with contextlib.ExitStack() as opened, _translated():
            for wanted in settings.outputs:
                channel = SysfsPwmChannel(
                    export_channel(root, wanted.device, wanted.channel, write), wanted.frequency, write
                )
                output = _output(wanted, channel, settings.idle, pin_factory)
                opened.callback(output.close)
                output.set_idle()
                self._outputs.append(output)
            opened.pop_all()

    def enable(self) -> None:
        """Let the motors turn, from neutral."""
        if not self.enabled:
            with _translated():
                for output in self._outputs:
                    output.start()
            self.enabled = True

    def disable(self) -> None:
        """Every output calm, also where one fails."""
        self.enabled = False
        with _translated(), contextlib.ExitStack() as steps:
            for output in self._outputs:
                steps.callback(output.set_idle)

    def set(self, throttles: Sequence[float]) -> None:
        """Set each output; nothing while disabled."""
        values = check_throttles(throttles, self.count)
        if self.enabled:
            with _translated():
                for output, value in zip(self._outputs, values, strict=True):
                    output.set(value)

    def close(self) -> None:
        """As disabled, then the pins are let go."""
        with contextlib.ExitStack() as steps:
            for output in self._outputs:
                steps.callback(output.close)
            self.disable()
            self._outputs = []


@contextlib.contextmanager
def _translated() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise MotorError(f"hardware PWM: {error.filename or 'sysfs'}: {error.strerror or error}") from error


def _output(wanted: Output, channel: SysfsPwmChannel, idle: Idle, pin_factory: Any) -> BridgeOutput | ServoOutput:
    match wanted:
        case ServoPwm():
            return ServoOutput(channel, wanted.pulse, idle)
        case BridgePwm():
            from vehicle.motors.pins import DigitalOutputDevice, translated

            with translated("direction pin"):
                return BridgeOutput(channel, DigitalOutputDevice(wanted.direction, pin_factory=pin_factory))
