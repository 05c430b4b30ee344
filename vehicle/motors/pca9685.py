"""ESCs and servos on a PCA9685 board over I2C (Adafruit's 16-channel board and its many copies).

The chip goes on with its last pulses when nobody speaks to it: it has no timeout. What ends them after the daemon is
`safe_stop`, or a timer at its OE pin that `safety.heartbeat_pin` keeps awake.
Registers are named as in NXP's data sheet, rev. 4, 7.3.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from typing import Annotated

import msgspec

from vehicle.i2c import Bus, in_words, open_bus
from vehicle.motors import MotorError, checked
from vehicle.motors.patience import Patience
from vehicle.motors.pulses import Idle, Pulse
from vehicle.motors.settings import chip_name, refuse_doubles

MODE1, MODE2, LED0_ON_L, PRE_SCALE = 0x00, 0x01, 0x06, 0xFE
RESTART, AUTO_INCREMENT, SLEEP = 0x80, 0x20, 0x10
AWAKE = AUTO_INCREMENT
"""MODE1 in use: all-call and sub-addresses off, so that nobody else's broadcast moves a motor."""
TOTEM_POLE = 0x04
"""MODE2: outputs drive both ways and change at the end of a transfer, so that a width is never half old."""
FULL_OFF = 0x10
STEPS = 4096
TRIES = 3


class Channel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One output of the board."""

    channel: Annotated[int, msgspec.Meta(ge=0, le=15)]
    pulse: Pulse = Pulse()

    @property
    def register(self) -> int:
        """Its first register, LEDn_ON_L; ON_H, OFF_L and OFF_H follow."""
        return LED0_ON_L + 4 * self.channel


class Pca9685Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Channels in motor order."""

    channels: Annotated[tuple[Channel, ...], msgspec.Meta(min_length=1, max_length=8)]
    bus: Annotated[int, msgspec.Meta(ge=0)] = 1
    """/dev/i2c-N; 1 is the header's."""
    address: Annotated[int, msgspec.Meta(ge=0x08, le=0x77)] = 0x40
    frequency: Annotated[float, msgspec.Meta(ge=40, le=400)] = 50.0
    """Hz, for all 16 channels of the board. Analogue servos take 50 only."""
    oscillator: Annotated[float, msgspec.Meta(ge=23e6, le=27e6)] = 25e6
    """Hz; the chip's own varies by some percent: measure a pulse and correct here."""
    idle: Idle = "neutral"

    def __post_init__(self) -> None:
        refuse_doubles([channel.channel for channel in self.channels])
        for channel in self.channels:
            channel.pulse.must_fit(self.frequency)

    @property
    def taken(self) -> list[str]:
        """The board."""
        return [chip_name(self.bus, self.address)]

    @property
    def prescale(self) -> int:
        """PRE_SCALE for `frequency` (data sheet 7.3.5)."""
        return round(self.oscillator / (STEPS * self.frequency)) - 1

    @property
    def step(self) -> float:
        """s, the smallest change of a width: 4.88 us at 50 Hz."""
        return (self.prescale + 1) / self.oscillator


class Pca9685Motors:
    """Fits `vehicle.motors.Motors`. Opening never starts pulses that were not there."""

    Settings = Pca9685Settings

    def __init__(
        self, settings: Pca9685Settings, *, bus: Bus | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Raises MotorError."""
        self.count = len(settings.channels)
        self.enabled = False
        self._settings = settings
        self._clock = clock
        self._patience = Patience()
        self._bus: Bus | None = bus if bus is not None else _opened(settings.bus)
        try:
            self._certain(self._calm)
            self._certain(self._set_up)
        except MotorError:
            self._bus.close()
            raise

    def enable(self) -> None:
        """Neutral pulses from now on. Raises MotorError where the chip is not as it was set up."""
        if not self.enabled:
            self._certain(self._set_up)  # a chip that lost its power meanwhile has forgotten everything
            self._certain(self._all_neutral)
            self._patience.worked()
            self.enabled = True

    def disable(self) -> None:
        """Neutral pulses or none, as `idle` says."""
        self.enabled = False
        if self._bus is not None:
            self._certain(self._calm)

    def set(self, throttles: Sequence[float]) -> None:
        """A width for each channel; nothing while disabled."""
        values = checked(throttles, self.count)
        if not self.enabled:
            return
        try:
            for channel, value in zip(self._settings.channels, values, strict=True):
                self._give(channel, channel.pulse.width(value))
        except OSError as error:
            self._patience.failed(self._said(error), self._clock())
        else:
            self._patience.worked()

    def close(self) -> None:
        """As disabled, then the bus is let go."""
        bus = self._bus
        if bus is not None:
            with contextlib.ExitStack() as steps:
                steps.callback(self._forget)
                steps.callback(bus.close)
                self.disable()

    def _forget(self) -> None:
        self._bus = None

    @property
    def _wire(self) -> Bus:
        if self._bus is None:
            raise MotorError("PCA9685: closed")
        return self._bus

    def _certain(self, step: Callable[[], None]) -> None:
        """Run `step` until it works. Raises MotorError where it does not."""
        for left in reversed(range(TRIES)):
            try:
                return step()
            except OSError as error:
                if not left:
                    raise MotorError(self._said(error)) from error
        return None

    def _said(self, error: OSError) -> str:
        settings = self._settings
        return f"PCA9685 at 0x{settings.address:02x} on I2C bus {settings.bus}: {in_words(error, settings.bus)}"

    def _set_up(self) -> None:
        """Mode and frequency, read back. Frequency can only be set asleep, which stops all 16 channels for it."""
        bus, address, prescale = self._wire, self._settings.address, self._settings.prescale
        if self._registers() == (AWAKE, TOTEM_POLE, prescale):
            return
        bus.write_byte_data(address, MODE1, AWAKE | SLEEP)
        bus.write_byte_data(address, PRE_SCALE, prescale)
        bus.write_byte_data(address, MODE2, TOTEM_POLE)
        bus.write_byte_data(address, MODE1, AWAKE)  # 500 us until the oscillator runs; three reads take longer
        found = self._registers()
        if found != (AWAKE, TOTEM_POLE, prescale):
            raise MotorError(
                f"PCA9685 at 0x{address:02x}: wrote mode and prescale {AWAKE}, {TOTEM_POLE}, {prescale}, read {found}"
            )

    def _registers(self) -> tuple[int, int, int]:
        bus, address = self._wire, self._settings.address
        mode1 = bus.read_byte_data(address, MODE1) & ~RESTART
        return mode1, bus.read_byte_data(address, MODE2), bus.read_byte_data(address, PRE_SCALE)

    def _calm(self) -> None:
        """What `idle` says, on every channel that gives pulses; one that gives none is left so."""
        for channel in self._settings.channels:
            pulsing = not self._wire.read_byte_data(self._settings.address, channel.register + 3) & FULL_OFF
            if pulsing and self._settings.idle == "neutral":
                self._give(channel, channel.pulse.width(0.0))
            else:
                self._wire.write_byte_data(self._settings.address, channel.register + 3, FULL_OFF)

    def _all_neutral(self) -> None:
        for channel in self._settings.channels:
            self._give(channel, channel.pulse.width(0.0))

    def _give(self, channel: Channel, width: float) -> None:
        """One transfer: on at 0, off at the width, full-off cleared."""
        off = round(width / self._settings.step)
        self._wire.write_i2c_block_data(self._settings.address, channel.register, [0, 0, off & 0xFF, off >> 8])


def _opened(number: int) -> Bus:
    try:
        return open_bus(number)
    except (OSError, ImportError) as error:
        raise MotorError(f"I2C bus {number}: {error}") from error
