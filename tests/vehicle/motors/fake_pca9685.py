"""A PCA9685 on an I2C bus, register by register, as its data sheet has it; what it puts on its outputs can be asked."""

from __future__ import annotations

from errno import EREMOTEIO

ADDRESS = 0x40
OSCILLATOR = 25e6
PRE_SCALE, MODE1, MODE2 = 0xFE, 0x00, 0x01
SLEEP, AUTO_INCREMENT, RESTART, FULL = 0x10, 0x20, 0x80, 0x10


class FakePca9685:
    """Behaves to the driver as smbus2.SMBus does, and as the chip behind it."""

    def __init__(self) -> None:
        self.registers = bytearray(256)
        self.writes: list[tuple[int, list[int]]] = []
        self.failing = 0
        """So many of the next transfers are not acknowledged."""
        self.closed = False
        self.lose_power()

    def lose_power(self) -> None:
        """Power-on defaults: asleep, all-call on, every output full off."""
        self.registers[:] = bytes(256)
        self.registers[MODE1], self.registers[MODE2], self.registers[PRE_SCALE] = 0x11, 0x04, 0x1E
        for channel in range(16):
            self.registers[9 + 4 * channel] = FULL

    def read_byte_data(self, i2c_addr: int, register: int) -> int:
        self._acknowledge(i2c_addr)
        return self.registers[register]

    def read_i2c_block_data(self, i2c_addr: int, register: int, length: int) -> list[int]:
        return [self.read_byte_data(i2c_addr, register + offset) for offset in range(length)]

    def write_byte_data(self, i2c_addr: int, register: int, value: int) -> None:
        self._acknowledge(i2c_addr)
        self._write(register, value)
        self.writes.append((register, [value]))

    def write_i2c_block_data(self, i2c_addr: int, register: int, data: list[int]) -> None:
        self._acknowledge(i2c_addr)
        increment = bool(self.registers[MODE1] & AUTO_INCREMENT)
        for offset, value in enumerate(data):
            self._write(register + offset * increment, value)
        self.writes.append((register, list(data)))

    def close(self) -> None:
        self.closed = True

    def pulse(self, channel: int) -> float | None:
        """s that the output is high in each period; None for no pulses at all."""
        on, off = self._word(channel, 0), self._word(channel, 2)
        if self.registers[MODE1] & SLEEP or off & 0x1000:
            return None
        return ((off - on) % 4096) * (self.registers[PRE_SCALE] + 1) / OSCILLATOR

    @property
    def frequency(self) -> float:
        """Hz of all outputs."""
        return OSCILLATOR / (4096 * (self.registers[PRE_SCALE] + 1))

    def _word(self, channel: int, offset: int) -> int:
        at = 6 + 4 * channel + offset
        return self.registers[at] | self.registers[at + 1] << 8

    def _write(self, register: int, value: int) -> None:
        if register == PRE_SCALE and not self.registers[MODE1] & SLEEP:
            return  # the chip takes it asleep only
        if register == MODE1:
            value &= ~RESTART
        self.registers[register] = value

    def _acknowledge(self, address: int) -> None:
        if self.closed or address != ADDRESS:
            raise OSError(EREMOTEIO, "Remote I/O error")
        if self.failing:
            self.failing -= 1
            raise OSError(EREMOTEIO, "Remote I/O error")
