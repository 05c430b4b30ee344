"""The PCA9685 board itself (Adafruit's 16-channel board and its many copies): registers, setup, pulses.

What its channels are for is the matter of who drives them: vehicle/motors/pca9685.py, vehicle/accessories/pca9685.py.
Both may be on one board, where they agree on its frequency. Registers are named as in NXP's data sheet, rev. 4, 7.3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import msgspec

from vehicle.hardware.i2c import Bus, explain_bus_error, open_bus
from vehicle.motors import MotorError
from vehicle.motors.settings import chip_name

MODE1, MODE2, LED0_ON_L, PRE_SCALE = 0x00, 0x01, 0x06, 0xFE
RESTART, AUTO_INCREMENT, SLEEP = 0x80, 0x20, 0x10
AWAKE = AUTO_INCREMENT
"""MODE1 in use: all-call and sub-addresses off, so that nobody else's broadcast moves a motor."""
TOTEM_POLE = 0x04
"""MODE2: outputs drive both ways and change at the end of a transfer, so that a width is never half old."""
FULL_OFF = 0x10
STEPS = 4096
TRIES = 3

Number = Annotated[int, msgspec.Meta(ge=0, le=15)]
"""Of a channel."""


class BoardSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """The board, and how fast it gives pulses."""

    bus: Annotated[int, msgspec.Meta(ge=0)] = 1
    """/dev/i2c-N; 1 is the header's."""
    address: Annotated[int, msgspec.Meta(ge=0x08, le=0x77)] = 0x40
    """On that bus, as its solder bridges have it: 0x40 is 64, 0x41 is 65."""
    frequency: Annotated[float, msgspec.Meta(ge=40, le=400)] = 50.0
    """Hz, for all 16 channels of the board. Analogue servos take 50 only."""
    oscillator: Annotated[float, msgspec.Meta(ge=23e6, le=27e6)] = 25e6
    """Hz; the chip's own varies by some percent: measure a pulse and correct here."""

    @property
    def chip(self) -> str:
        """As vehicle/config/conflicts.py knows it."""
        return chip_name(self.bus, self.address)

    @property
    def shared(self) -> dict[str, str]:
        """What others may have too, who say the same of it: the board."""
        return {self.chip: f"a PCA9685 of {self.frequency:g} Hz with an oscillator of {self.oscillator:g} Hz"}

    @property
    def prescale(self) -> int:
        """PRE_SCALE for `frequency` (data sheet 7.3.5)."""
        return round(self.oscillator / (STEPS * self.frequency)) - 1

    @property
    def step(self) -> float:
        """s, the smallest change of a width: 4.88 us at 50 Hz."""
        return (self.prescale + 1) / self.oscillator


class Pca9685Board:
    """Open until `close`. What it cannot do is an OSError, or a MotorError of `certain`."""

    def __init__(self, settings: BoardSettings, bus: Bus | None = None) -> None:
        """Raises MotorError where there is no such bus."""
        self._settings = settings
        self._bus: Bus | None = bus if bus is not None else _opened(settings.bus)

    @property
    def is_open(self) -> bool:
        """Not closed yet."""
        return self._bus is not None

    def retry(self, step: Callable[[], None]) -> None:
        """Run `step` until it works. Raises MotorError where it does not."""
        for left in reversed(range(TRIES)):
            try:
                return step()
            except OSError as error:
                if not left:
                    raise MotorError(self.describe(error)) from error
        return None

    def describe(self, error: OSError) -> str:
        """One line."""
        settings = self._settings
        return (
            f"PCA9685 at 0x{settings.address:02x} on I2C bus {settings.bus}: {explain_bus_error(error, settings.bus)}"
        )

    def set_up(self) -> None:
        """Mode and frequency, read back. Frequency can only be set asleep, which stops all 16 channels for it."""
        bus, address, prescale = self._open_bus, self._settings.address, self._settings.prescale
        if self.ready:
            return
        bus.write_byte_data(address, MODE1, AWAKE | SLEEP)
        bus.write_byte_data(address, PRE_SCALE, prescale)
        bus.write_byte_data(address, MODE2, TOTEM_POLE)
        bus.write_byte_data(address, MODE1, AWAKE)  # 500 us until the oscillator runs; three reads take longer
        if not self.ready:
            wrote = f"{AWAKE}, {TOTEM_POLE}, {prescale}"
            raise MotorError(f"PCA9685 at 0x{address:02x}: wrote mode and prescale {wrote}, read {self._registers()}")

    @property
    def ready(self) -> bool:
        """It is as it was set up, and has not lost its power since."""
        return self._registers() == (AWAKE, TOTEM_POLE, self._settings.prescale)

    def has_pulse(self, channel: int) -> bool:
        """A channel gives pulses, by this process or one before it."""
        return not self._open_bus.read_byte_data(self._settings.address, _register(channel) + 3) & FULL_OFF

    def set_pulse(self, channel: int, width: float) -> None:
        """Pulses of `width` s. One transfer: on at 0, off at the width, full-off cleared."""
        off = round(width / self._settings.step)
        self._open_bus.write_i2c_block_data(self._settings.address, _register(channel), [0, 0, off & 0xFF, off >> 8])

    def stop(self, channel: int) -> None:
        """No pulses."""
        self._open_bus.write_byte_data(self._settings.address, _register(channel) + 3, FULL_OFF)

    def close(self) -> None:
        """Let go of the bus; the board goes on as it is. May come twice."""
        bus, self._bus = self._bus, None
        if bus is not None:
            bus.close()

    @property
    def _open_bus(self) -> Bus:
        if self._bus is None:
            raise MotorError("PCA9685: closed")
        return self._bus

    def _registers(self) -> tuple[int, int, int]:
        bus, address = self._open_bus, self._settings.address
        mode1 = bus.read_byte_data(address, MODE1) & ~RESTART
        return mode1, bus.read_byte_data(address, MODE2), bus.read_byte_data(address, PRE_SCALE)


def _register(channel: int) -> int:
    """The first of a channel, LEDn_ON_L; ON_H, OFF_L and OFF_H follow."""
    return LED0_ON_L + 4 * channel


def _opened(number: int) -> Bus:
    try:
        return open_bus(number)
    except (OSError, ImportError) as error:
        raise MotorError(f"I2C bus {number}: {error}") from error
