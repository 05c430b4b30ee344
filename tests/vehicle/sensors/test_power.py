from __future__ import annotations

from errno import EREMOTEIO

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.sensors.power import PowerMonitor, PowerReading, PowerSettings, ina219, ina260, signed


class FakeMonitor:
    """An INA219 or INA260 on a bus: 16-bit registers, the high byte first."""

    def __init__(self, address: int = 0x40) -> None:
        self.registers = {0: 0x399F, 1: 0, 2: 0}
        self.failing = False
        self.opened = 0
        self.closed = 0
        self._address = address

    def open(self, number: int) -> FakeMonitor:
        assert number == 1
        self.opened += 1
        return self

    def read_byte_data(self, i2c_addr: int, register: int) -> int:
        return self.read_i2c_block_data(i2c_addr, register, 1)[0]

    def read_i2c_block_data(self, i2c_addr: int, register: int, length: int) -> list[int]:
        self._acknowledge(i2c_addr)
        return list(self.registers[register].to_bytes(2, "big")[:length])

    def write_byte_data(self, i2c_addr: int, register: int, value: int) -> None:
        raise AssertionError("its registers have two bytes")

    def write_i2c_block_data(self, i2c_addr: int, register: int, data: list[int]) -> None:
        self._acknowledge(i2c_addr)
        self.registers[register] = int.from_bytes(bytes(data), "big")

    def close(self) -> None:
        self.closed += 1

    def _acknowledge(self, address: int) -> None:
        if self.failing or address != self._address:
            raise OSError(EREMOTEIO, "Remote I/O error")


@pytest.mark.parametrize(
    ("shunt_register", "bus_register", "shunt", "power"),
    [
        (0x0000, 0x0000, 0.1, PowerReading(0.0, 0.0)),
        (0x0FA0, 0x5D98 & ~7 | 2, 0.1, PowerReading(11.98, 0.4)),  # data sheet, figure 27: 40 mV, 12 V range
        (0xF060, 0x5D98 & ~7 | 2, 0.1, PowerReading(11.98, -0.4)),
        (0x7D00, 0x1F40, 0.01, PowerReading(4.0, 32.0)),
    ],
)
def test_an_ina219(shunt_register: int, bus_register: int, shunt: float, power: PowerReading) -> None:
    measured = ina219(shunt_register, bus_register, shunt)
    assert measured.voltage == pytest.approx(power.voltage)
    assert measured.current == pytest.approx(power.current)


@pytest.mark.parametrize(
    ("current_register", "bus_register", "power"),
    [
        (0x2710, 0x2570, PowerReading(11.98, 12.5)),
        (0xD8F0, 0x2570, PowerReading(11.98, -12.5)),
        (0, 0, PowerReading(0.0, 0.0)),
    ],
)
def test_an_ina260(current_register: int, bus_register: int, power: PowerReading) -> None:
    measured = ina260(current_register, bus_register, 0.0)
    assert measured.voltage == pytest.approx(power.voltage)
    assert measured.current == pytest.approx(power.current)


@given(st.integers(-0x8000, 0x7FFF))
def test_registers_are_twos_complement(value: int) -> None:
    assert signed(value & 0xFFFF) == value


@pytest.mark.parametrize(("kind", "configuration"), [("ina219", 0x3FFF), ("ina260", 0x6527)])
def test_the_chip_averages_over_the_pulses_of_motors(kind: str, configuration: int) -> None:
    chip = FakeMonitor()
    PowerMonitor(PowerSettings(kind=kind), open_bus=chip.open).sample()  # type: ignore[arg-type]
    assert chip.registers[0] == configuration


def test_a_chip_that_fails_is_set_up_again() -> None:
    chip = FakeMonitor()
    monitor = PowerMonitor(PowerSettings(kind="ina260"), open_bus=chip.open)
    chip.registers.update({1: 80, 2: 9600})
    assert monitor.sample() == PowerReading(12.0, 0.1)
    chip.failing = True
    for _ in range(2):
        with pytest.raises(OSError, match="ina260 at 0x40 on I2C bus 1: Remote I/O error: no response; check wiring"):
            monitor.sample()
    chip.failing = False
    chip.registers[0] = 0x6127
    assert monitor.sample() == PowerReading(12.0, 0.1)
    assert chip.registers[0] == 0x6527
    assert chip.opened == chip.closed + 1


def test_a_bus_that_is_not_there_is_an_os_error() -> None:
    with pytest.raises(OSError, match="ina219 at 0x40 on I2C bus 99: No such file"):
        PowerMonitor(PowerSettings(kind="ina219", bus=99)).sample()
