"""Hardware PWM of the Raspberry Pi through /sys/class/pwm: inaudible bridges and servo pulses without jitter.

A chip is found by its device (`fe20c000.pwm`), because its number differs between kernels.
The hardware keeps its last duty when the process is killed: `safe_stop` ends it.
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
"""Header pins with hardware PWM, on every Pi."""


class BridgePwm(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="drives", tag="bridge"):
    """An H-bridge with a PWM and a direction input."""

    device: str
    """Device of the PWM chip, as in its path below /sys/devices."""
    channel: Number
    direction: Pin
    """Low is forward."""
    frequency: Annotated[float, msgspec.Meta(ge=50, le=100_000)] = 20_000.0
    """Hz; 20 kHz is inaudible."""


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
    """Output of servos while disabled: "neutral" pulses, or none ("off"). A bridge is always off then."""

    def __post_init__(self) -> None:
        names = [(output.device, output.channel) for output in self.outputs]
        if len(set(names)) < len(names):
            raise ValueError("a channel is used twice")
        reject_duplicates([pin_name(pin) for pin in self.pins])

    @property
    def pins(self) -> list[int]:
        """The direction pins of bridges."""
        return [output.direction for output in self.outputs if isinstance(output, BridgePwm)]

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(pin) for pin in self.pins]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Pins that the hardware PWM may use; an overlay selects them."""
        return PWM_PINS


class BridgeOutput:
    """One motor on a bridge."""

    def __init__(self, channel: SysfsPwmChannel, direction: Any) -> None:
        self._channel = channel
        self._direction = direction
        self._backward = False

    def set_idle(self) -> None:
        """Set duty 0 and switch the output off."""
        self._channel.stop()
        self._channel.set_period()

    def start(self) -> None:
        """Set duty 0, then switch the output on."""
        self._channel.set_duty(0)
        self._channel.start()

    def set(self, throttle: float) -> None:
        """Set the duty; it is 0 while the direction changes, so that no pulse drives the wrong way."""
        if throttle != 0.0 and (throttle < 0.0) != self._backward:
            self._channel.set_duty(0)
            self._backward = throttle < 0.0
            self._direction.value = self._backward
        self._channel.set_duty(round(abs(throttle) * self._channel.period))

    def close(self) -> None:
        """Release the direction pin."""
        self._direction.close()


class ServoOutput:
    """One ESC or steering servo."""

    def __init__(self, channel: SysfsPwmChannel, pulse: Pulse, idle: Idle) -> None:
        self._channel = channel
        self._pulse = pulse
        self._idle = idle

    def set_idle(self) -> None:
        """Make the output idle according to `idle`; an output without pulses stays without."""
        if self._channel.is_running and self._idle == "neutral":
            self._channel.set_period()
            self.set(0.0)
        else:
            self._channel.stop()
            self._channel.set_period()

    def start(self) -> None:
        """Set neutral, then switch the output on."""
        self.set(0.0)
        self._channel.start()

    def set(self, throttle: float) -> None:
        """Set the pulse width."""
        self._channel.set_duty(round(self._pulse.width(throttle) * 1e9))

    def close(self) -> None:
        """Return: the channel stays exported, so that its permissions stay too."""


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
        """Export the channels and make them idle. Raises MotorError. `root`, `write`, `pin_factory` are for tests."""
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
        """Make every output idle, even if one fails."""
        self.enabled = False
        with _translated(), contextlib.ExitStack() as steps:
            for output in self._outputs:
                steps.callback(output.set_idle)

    def set(self, throttles: Sequence[float]) -> None:
        """Set each output; no effect while disabled."""
        values = check_throttles(throttles, self.count)
        if self.enabled:
            with _translated():
                for output, value in zip(self._outputs, values, strict=True):
                    output.set(value)

    def close(self) -> None:
        """Disable the motors, then release the pins."""
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
