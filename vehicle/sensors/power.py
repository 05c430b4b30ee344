"""Battery voltage and current from an INA219 or INA260 on the I2C bus.

Registers are as in Texas Instruments' data sheets (https://www.ti.com/lit/ds/symlink/ina219.pdf, SBOS448G, and
https://www.ti.com/lit/ds/symlink/ina260.pdf, SBOS656C). The calibration register is not used: the current is computed
from the shunt voltage, so a chip that lost its power gives correct values again at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Literal

import msgspec

from vehicle.hardware.i2c import Bus, explain_bus_error, open_bus
from vehicle.motors.settings import chip_name

PERIOD, MAX_AGE = 0.2, 2.0
"""s between readings, and how long one is valid: less than the 5 s after which the battery sensor counts as failed."""


class PowerReading(msgspec.Struct, frozen=True):
    """V and A; positive is out of the battery."""

    voltage: float
    current: float


class PowerSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Type and address of the chip."""

    kind: Literal["ina219", "ina260"]
    bus: Annotated[int, msgspec.Meta(ge=0)] = 1
    address: Annotated[int, msgspec.Meta(ge=0x40, le=0x4F)] = 0x40
    shunt: Annotated[float, msgspec.Meta(gt=0, le=1)] = 0.1
    """Resistance of the shunt of an INA219 in ohm: 0.1 on most boards, for up to 3.2 A. An INA260 has its own."""

    @property
    def taken(self) -> list[str]:
        """The chip by name."""
        return [chip_name(self.bus, self.address)]


class PowerChip(msgspec.Struct, frozen=True):
    """Configuration and conversion of one type of chip."""

    configuration: int
    """Value of register 0: continuous, averaged over tens of ms, because motors draw current in pulses."""
    power: Callable[[int, int, float], PowerReading]
    """Converts registers 1 and 2, with the resistance of the shunt."""


def ina219(shunt_register: int, bus_register: int, shunt: float) -> PowerReading:
    """Convert 10 uV steps over the shunt, signed, and 4 mV steps on the bus, above three flag bits."""
    return PowerReading(voltage=(bus_register >> 3) * 0.004, current=signed(shunt_register) * 10e-6 / shunt)


def ina260(current_register: int, bus_register: int, shunt: float) -> PowerReading:
    """Convert 1.25 mA and 1.25 mV steps; the shunt is inside the chip."""
    return PowerReading(voltage=bus_register * 1.25e-3, current=signed(current_register) * 1.25e-3)


def signed(register: int) -> int:
    """Return 16 bits as a two's complement number."""
    return register - 0x10000 if register & 0x8000 else register


CHIPS: dict[str, PowerChip] = {
    "ina219": PowerChip(0x3FFF, ina219),  # 32 V, 320 mV, 128 samples of both: 68 ms each
    "ina260": PowerChip(0x6527, ina260),  # 16 samples of both, 1.1 ms each
}


class PowerMonitor:
    """Reads the chip. The bus is opened with the first sample, so a chip that is connected later is found."""

    def __init__(self, settings: PowerSettings, *, open_bus: Callable[[int], Bus] = open_bus) -> None:
        self._settings = settings
        self._chip = CHIPS[settings.kind]
        self._open = open_bus
        self._bus: Bus | None = None

    def sample(self) -> PowerReading:
        """Read voltage and current once. Raises OSError, ImportError."""
        try:
            bus = self._ready()
            return self._chip.power(self._register(bus, 1), self._register(bus, 2), self._settings.shunt)
        except OSError as error:
            self.close()
            settings = self._settings
            where = f"{settings.kind} at 0x{settings.address:02x} on I2C bus {settings.bus}"
            raise OSError(f"{where}: {explain_bus_error(error, settings.bus)}") from error

    def close(self) -> None:
        """Close the bus; the next sample opens it again."""
        bus, self._bus = self._bus, None
        if bus is not None:
            bus.close()

    def _ready(self) -> Bus:
        if self._bus is None:
            self._bus = self._open(self._settings.bus)
            self._bus.write_i2c_block_data(self._settings.address, 0, list(self._chip.configuration.to_bytes(2, "big")))
        return self._bus

    def _register(self, bus: Bus, number: int) -> int:
        return int.from_bytes(bytes(bus.read_i2c_block_data(self._settings.address, number, 2)), "big")
