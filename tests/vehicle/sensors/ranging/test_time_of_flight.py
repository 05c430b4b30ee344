"""VL53L0X and VL53L1X: the libraries of Adafruit and the messages of smbus2, with chips that have registers."""

from __future__ import annotations

from errno import EREMOTEIO
from typing import Any

import pytest

from vehicle.sensors.ranging.settings import Vl53l0x, Vl53l1x
from vehicle.sensors.ranging.time_of_flight import TimeOfFlight

READ = 1
"""I2C_M_RD of linux/i2c.h."""


class Chip:
    """A chip at 0x29 on bus 1. `width`: bytes of a register's number."""

    width = 1

    def __init__(self) -> None:
        self.registers: dict[int, int] = {}
        self.pointer = 0
        self.connected = True
        self.millimetres = 500
        self.opened = self.closed = 0

    def open(self, number: int) -> Chip:
        assert number == 1
        self.opened += 1
        return self

    def close(self) -> None:
        self.closed += 1

    def i2c_rdwr(self, *messages: Any) -> None:
        for message in messages:
            if not self.connected or message.addr != 0x29:
                raise OSError(EREMOTEIO, "Remote I/O error")
            if message.flags & READ:
                for index in range(message.len):
                    message.buf[index] = bytes([self.read(self.pointer + index)])
            elif message.len:
                data = bytes(message)
                self.pointer = int.from_bytes(data[: self.width], "big")
                for index, value in enumerate(data[self.width :]):
                    self.write(self.pointer + index, value)

    def read(self, register: int) -> int:
        return self.registers.get(register, 0)

    def write(self, register: int, value: int) -> None:
        self.registers[register] = value


class L0x(Chip):
    """Measures while continuous ranging is on; calibrations end at once. Registers have banks (0xFF)."""

    ready = False
    continuous = False

    def read(self, register: int) -> int:
        if register in (0xC0, 0xC1, 0xC2):
            return {0xC0: 0xEE, 0xC1: 0xAA, 0xC2: 0x10}[register]
        match register:
            case 0x13:
                return 4 if self.ready or self.continuous else 0
            case 0x1E | 0x1F:
                return self.millimetres.to_bytes(2, "big")[register - 0x1E]
            case 0x00:
                return 0  # a start bit clears itself
            case 0x83:
                return 0x10
            case 0x92:
                return 5  # reference SPADs
        return 0xFF if 0xB0 <= register <= 0xB5 else super().read(register)

    def write(self, register: int, value: int) -> None:
        if register == 0x00 and not self.registers.get(0xFF):
            self.ready, self.continuous = bool(value & 1), value == 2
        super().write(register, value)


class L1x(Chip):
    """Has a measurement whenever ranging is on, until the interrupt is cleared."""

    width = 2
    status = 9

    def read(self, register: int) -> int:
        match register:
            case 0x10F | 0x110 | 0x111:
                return (0xEA, 0xCC, 0x10)[register - 0x10F]
            case 0x31:
                return int(self.registers.get(0x87) == 0x40)
            case 0x89:
                return self.status
            case 0x96 | 0x97:
                return self.millimetres.to_bytes(2, "big")[register - 0x96]
        return super().read(register)


def distance(sensor: TimeOfFlight) -> float | None:
    [cone] = sensor.sample()
    return cone.distance


def test_a_vl53l0x_measures() -> None:
    chip = L0x()
    sensor = TimeOfFlight(Vl53l0x(1), open_bus=chip.open)
    assert distance(sensor) == 0.5
    assert chip.continuous
    chip.millimetres = 20
    assert distance(sensor) == 0.0
    chip.millimetres = 8190
    assert distance(sensor) == sensor.beam.far
    assert chip.opened == 1


def test_a_vl53l1x_measures_to_its_long_distance() -> None:
    chip = L1x()
    sensor = TimeOfFlight(Vl53l1x(1), open_bus=chip.open)
    chip.millimetres = 2500
    assert distance(sensor) == 2.5
    assert chip.registers[0x4B] == 0x0A  # long distance
    chip.status = 4  # no signal: nothing is there
    assert distance(sensor) == sensor.beam.far
    chip.registers[0x87] = 0
    with pytest.raises(OSError, match="vl53l1x at 0x29 on I2C bus 1: does not measure"):
        sensor.sample()


@pytest.mark.parametrize(("kind", "make"), [(Vl53l0x, L0x), (Vl53l1x, L1x)])
def test_a_chip_that_was_away_is_set_up_again(kind: Any, make: type[Chip]) -> None:
    chip = make()
    sensor = TimeOfFlight(kind(1), open_bus=chip.open)
    assert distance(sensor) == 0.5
    chip.connected = False
    for _ in range(2):
        with pytest.raises(OSError, match=f"{kind.__name__.lower()} at 0x29 on I2C bus 1"):
            sensor.sample()
    chip.connected = True
    chip.registers.clear()
    assert distance(sensor) == 0.5
    assert chip.opened == chip.closed + 1


def test_another_chip_at_its_address_is_named() -> None:
    with pytest.raises(OSError, match=r"vl53l0x at 0x29 on I2C bus 1: .*check wiring"):
        TimeOfFlight(Vl53l0x(1), open_bus=Chip().open).sample()
