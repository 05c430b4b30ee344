"""The PCA9685 board (Adafruit's 16-channel board and its copies): registers, setup and pulses.

Its users are the drivers in vehicle/motors/pca9685.py and vehicle/accessories/pca9685.py, which may share one board
with the same frequency. Registers are named as in NXP's data sheet, rev. 4, section 7.3:
https://www.nxp.com/docs/en/data-sheet/PCA9685.pdf
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
"""MODE1 in use: all-call and sub-addresses off, so that a broadcast on the bus moves no motor."""
TOTEM_POLE = 0x04
"""MODE2: totem-pole outputs that change at the end of a transfer, so that no pulse mixes an old and a new width."""
FULL_OFF = 0x10
STEPS = 4096
TRIES = 3

Number = Annotated[int, msgspec.Meta(ge=0, le=15)]
"""Number of a channel."""


class BoardSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Address and frequency of a PCA9685 board."""

    bus: Annotated[int, msgspec.Meta(ge=0)] = 1
    """Number N of /dev/i2c-N; 1 is the bus of the header."""
    address: Annotated[int, msgspec.Meta(ge=0x08, le=0x77)] = 0x40
    """I2C address, set by the solder bridges of the board: 0x40 is 64, 0x41 is 65."""
    frequency: Annotated[float, msgspec.Meta(ge=40, le=400)] = 50.0
    """Hz, for all 16 channels of the board. Analogue servos accept 50 only."""
    oscillator: Annotated[float, msgspec.Meta(ge=23e6, le=27e6)] = 25e6
    """Hz; the frequency of the chip's oscillator varies by some percent: measure a pulse and correct it here."""

    @property
    def chip(self) -> str:
        """Name of the board in vehicle/config/conflicts.py."""
        return chip_name(self.bus, self.address)

    @property
    def shared(self) -> dict[str, str]:
        """What several parts of a file may use with the same settings: the board."""
        return {self.chip: f"a PCA9685 of {self.frequency:g} Hz with an oscillator of {self.oscillator:g} Hz"}

    @property
    def prescale(self) -> int:
        """Value of PRE_SCALE for `frequency` (data sheet, section 7.3.5)."""
        return round(self.oscillator / (STEPS * self.frequency)) - 1

    @property
    def step(self) -> float:
        """Resolution of a pulse width in s: 4.88 us at 50 Hz."""
        return (self.prescale + 1) / self.oscillator


class Pca9685Board:
    """An open board. Its methods raise OSError if the chip does not respond; `retry` raises MotorError instead."""

    def __init__(self, settings: BoardSettings, bus: Bus | None = None) -> None:
        """Open the bus. Raises MotorError."""
        self._settings = settings
        self._bus: Bus | None = bus if bus is not None else _open_bus_number(settings.bus)

    @property
    def is_open(self) -> bool:
        """Whether the board is not closed yet."""
        return self._bus is not None

    def retry(self, step: Callable[[], None]) -> None:
        """Run `step`, up to TRIES times. Raises MotorError if it fails every time."""
        for left in reversed(range(TRIES)):
            try:
                return step()
            except OSError as error:
                if not left:
                    raise MotorError(self.describe(error)) from error
        return None

    def describe(self, error: OSError) -> str:
        """Return an error of the chip as one line."""
        settings = self._settings
        return (
            f"PCA9685 at 0x{settings.address:02x} on I2C bus {settings.bus}: {explain_bus_error(error, settings.bus)}"
        )

    def set_up(self) -> None:
        """Set mode and frequency, and read them back. Setting the frequency stops all 16 channels briefly."""
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
        """Whether mode and frequency are set: the chip has not lost its power since `set_up`."""
        return self._registers() == (AWAKE, TOTEM_POLE, self._settings.prescale)

    def has_pulse(self, channel: int) -> bool:
        """Return whether a channel outputs pulses, from this or an earlier process."""
        return not self._open_bus.read_byte_data(self._settings.address, _register(channel) + 3) & FULL_OFF

    def set_pulse(self, channel: int, width: float) -> None:
        """Output pulses of `width` s. One transfer sets on at 0, off at the width, and clears full-off."""
        off = round(width / self._settings.step)
        self._open_bus.write_i2c_block_data(self._settings.address, _register(channel), [0, 0, off & 0xFF, off >> 8])

    def stop(self, channel: int) -> None:
        """Stop the pulses of a channel."""
        self._open_bus.write_byte_data(self._settings.address, _register(channel) + 3, FULL_OFF)

    def close(self) -> None:
        """Close the bus; the board keeps its outputs. May be called twice."""
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
    """Return the first register of a channel, LEDn_ON_L; ON_H, OFF_L and OFF_H follow."""
    return LED0_ON_L + 4 * channel


def _open_bus_number(number: int) -> Bus:
    try:
        return open_bus(number)
    except (OSError, ImportError) as error:
        raise MotorError(f"I2C bus {number}: {error}") from error
