"""The I2C bus as drivers and sensors need it; smbus2 is one, and the tests bring their own. No device is known here."""

from __future__ import annotations

import contextlib
import errno
import fcntl
from typing import Protocol

from vehicle.hardware.install_hints import INSTALL_HINT

I2C_TIMEOUT = 0x0702
"""ioctl, in units of 10 ms (linux/i2c-dev.h)."""
I2C_TIMEOUT_TICKS = 2
"""20 ms: a device that holds the clock low must not hold the control loop for the kernel's whole second."""

NO_RESPONSE_ERRNOS = (errno.EREMOTEIO, errno.ENXIO, errno.ETIMEDOUT)
"""What the kernel says where a chip does not."""


class Bus(Protocol):
    """What smbus2.SMBus does. All raise OSError where the device does not answer."""

    def read_byte_data(self, i2c_addr: int, register: int) -> int:
        """One register."""

    def read_i2c_block_data(self, i2c_addr: int, register: int, length: int) -> list[int]:
        """`length` bytes from `register` on."""

    def write_byte_data(self, i2c_addr: int, register: int, value: int) -> None:
        """One register."""

    def write_i2c_block_data(self, i2c_addr: int, register: int, data: list[int]) -> None:
        """Bytes from `register` on."""

    def close(self) -> None:
        """Let go of the bus."""


def open_bus(number: int) -> Bus:
    """/dev/i2c-`number`. Raises OSError, and ImportError without smbus2."""
    try:
        from smbus2 import SMBus
    except ImportError as error:
        raise ImportError(f"{error}; {INSTALL_HINT}") from error
    try:
        bus = SMBus(number)
    except FileNotFoundError as error:
        hint = "no such bus; on a Pi `sudo raspi-config nonint do_i2c 0` makes bus 1"
        raise OSError(error.errno, f"{error.strerror}: {hint}", error.filename) from error
    except PermissionError as error:
        hint = "add yourself to its group: sudo usermod -aG i2c $USER, log in again"
        raise OSError(error.errno, f"{error.strerror}: {hint}", error.filename) from error
    with contextlib.suppress(OSError):  # an adapter that cannot set it keeps its own
        fcntl.ioctl(bus.fd or -1, I2C_TIMEOUT, I2C_TIMEOUT_TICKS)
    return bus


def explain_bus_error(error: OSError, bus: int) -> str:
    """What is wrong with a chip on this bus, and what to do."""
    words = error.strerror or str(error)
    if error.errno in NO_RESPONSE_ERRNOS:
        return f"{words}: nothing answers there; its wires, power and address? `i2cdetect -y {bus}` lists who does"
    return words
