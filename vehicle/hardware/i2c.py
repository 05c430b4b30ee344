"""The I2C bus for motor drivers and sensors: smbus2 in production, a fake in tests."""

from __future__ import annotations

import contextlib
import errno
import fcntl
from typing import Protocol

from link.runtime.install_hint import install_command

I2C_TIMEOUT = 0x0702
"""Number of the ioctl that sets the timeout, in units of 10 ms (linux/i2c-dev.h)."""
I2C_TIMEOUT_TICKS = 2
"""20 ms: a device that holds the clock low must not block the control loop for the kernel's default of 1 s."""

NO_RESPONSE_ERRNOS = (errno.EREMOTEIO, errno.ENXIO, errno.ETIMEDOUT)
"""Errors of the kernel for a chip that does not respond."""


class Bus(Protocol):
    """The methods of smbus2.SMBus in use. All raise OSError if the device does not respond."""

    def read_byte_data(self, i2c_addr: int, register: int) -> int:
        """Read one register."""

    def read_i2c_block_data(self, i2c_addr: int, register: int, length: int) -> list[int]:
        """Read `length` bytes, starting at `register`."""

    def write_byte_data(self, i2c_addr: int, register: int, value: int) -> None:
        """Write one register."""

    def write_i2c_block_data(self, i2c_addr: int, register: int, data: list[int]) -> None:
        """Write bytes, starting at `register`."""

    def close(self) -> None:
        """Close the bus."""


def open_bus(number: int) -> Bus:
    """Open /dev/i2c-`number`. Raises OSError, and ImportError without smbus2."""
    try:
        from smbus2 import SMBus
    except ImportError as error:
        raise ImportError(f"{error}; install it: {install_command('pi')}") from error
    try:
        bus = SMBus(number)
    except FileNotFoundError as error:
        hint = "no such bus; on a Pi `sudo raspi-config nonint do_i2c 0` enables bus 1"
        raise OSError(error.errno, f"{error.strerror}: {hint}", error.filename) from error
    except PermissionError as error:
        hint = "add yourself to its group: sudo usermod -aG i2c $USER, log in again"
        raise OSError(error.errno, f"{error.strerror}: {hint}", error.filename) from error
    with contextlib.suppress(OSError):  # not every adapter supports this
        fcntl.ioctl(bus.fd or -1, I2C_TIMEOUT, I2C_TIMEOUT_TICKS)
    return bus


def explain_bus_error(error: OSError, bus: int) -> str:
    """Return the error of a chip on this bus, and what to do."""
    text = error.strerror or str(error)
    if error.errno in NO_RESPONSE_ERRNOS:
        return f"{text}: no response; check wiring, power and address; `i2cdetect -y {bus}` lists the devices"
    return text
