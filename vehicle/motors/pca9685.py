"""ESCs and servos on a PCA9685 board over I2C; the registers are in vehicle/motors/pca9685_board.py.

The chip has no timeout: it repeats its last pulses when the process is killed. `safe_stop` ends them, or an external
timer at the OE pin that `safety.heartbeat_pin` retriggers.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from typing import Annotated

import msgspec

from vehicle.hardware.i2c import Bus
from vehicle.motors import MotorError, check_throttles
from vehicle.motors.error_budget import ErrorBudget
from vehicle.motors.pca9685_board import BoardSettings, Number, Pca9685Board
from vehicle.motors.pulses import Idle, Pulse
from vehicle.motors.settings import channel_name, i2c_pins, reject_duplicates


class Pca9685Channel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One channel of the board."""

    channel: Number
    pulse: Pulse = Pulse()


class Pca9685Settings(BoardSettings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Channels in motor order."""

    channels: Annotated[tuple[Pca9685Channel, ...], msgspec.Meta(min_length=1, max_length=8)]
    idle: Idle = "neutral"
    """Output while disabled: "neutral" pulses, or none ("off")."""

    def __post_init__(self) -> None:
        reject_duplicates([f"channel {each.channel}" for each in self.channels])
        for channel in self.channels:
            channel.pulse.check_period(self.frequency)

    @property
    def taken(self) -> list[str]:
        """The channels by name."""
        return [channel_name(channel.channel, self.chip) for channel in self.channels]

    @property
    def pins_nearby(self) -> tuple[int, ...]:
        """Pins of the I2C bus."""
        return i2c_pins(self.bus)


class Pca9685Motors:
    """Fits `vehicle.motors.Motors`. Opening the driver never starts pulses on a channel without any."""

    Settings = Pca9685Settings

    def __init__(
        self, settings: Pca9685Settings, *, bus: Bus | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Set up the board and make the channels idle. Raises MotorError."""
        self.count = len(settings.channels)
        self.enabled = False
        self._settings = settings
        self._clock = clock
        self._error_budget = ErrorBudget()
        self._board = Pca9685Board(settings, bus)
        try:
            self._board.retry(self._set_idle)
            self._board.retry(self._board.set_up)
        except MotorError:
            self._board.close()
            raise

    def enable(self) -> None:
        """Start neutral pulses. Raises MotorError if the chip cannot be set up."""
        if not self.enabled:
            self._board.retry(self._board.set_up)  # after a loss of power the registers have their defaults
            self._board.retry(self._all_neutral)
            self._error_budget.reset()
            self.enabled = True

    def disable(self) -> None:
        """Output neutral pulses or none, according to `idle`."""
        self.enabled = False
        if self._board.is_open:
            self._board.retry(self._set_idle)

    def set(self, throttles: Sequence[float]) -> None:
        """Set the pulse width of each channel; no effect while disabled."""
        values = check_throttles(throttles, self.count)
        if not self.enabled:
            return
        try:
            for channel, value in zip(self._settings.channels, values, strict=True):
                self._board.set_pulse(channel.channel, channel.pulse.width(value))
        except OSError as error:
            self._error_budget.add_failure(self._board.describe(error), self._clock())
        else:
            self._error_budget.reset()

    def close(self) -> None:
        """Disable the motors, then close the bus."""
        with contextlib.ExitStack() as steps:
            steps.callback(self._board.close)
            self.disable()

    def _set_idle(self) -> None:
        """Make each channel idle according to `idle`; a channel without pulses stays without.

        A board that was set up differently, for example before `frequency` was changed, would output another width for
        neutral: its pulses are stopped.
        """
        neutral = self._settings.idle == "neutral" and self._board.ready
        for channel in self._settings.channels:
            if neutral and self._board.has_pulse(channel.channel):
                self._board.set_pulse(channel.channel, channel.pulse.width(0.0))
            else:
                self._board.stop(channel.channel)

    def _all_neutral(self) -> None:
        for channel in self._settings.channels:
            self._board.set_pulse(channel.channel, channel.pulse.width(0.0))
