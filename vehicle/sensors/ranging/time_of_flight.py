"""VL53L0X and VL53L1X by the libraries of Adafruit (extra `tof`), which know the settings that ST does not document."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any, NamedTuple

from link.runtime.install_hint import install_command
from vehicle.hardware.i2c import explain_bus_error, open_bus
from vehicle.readings import Scan
from vehicle.sensors.ranging.settings import Beam, I2cSettings, Vl53l0x, Vl53l1x

L0X_BEAM = Beam(width=25.0, near=0.03, far=1.2)
L1X_BEAM = Beam(width=27.0, near=0.04, far=3.0)
READY_WAIT, READY_POLL = 0.3, 0.005
"""s for a measurement, which takes 0.03 to 0.1 s."""
LONG_DISTANCE = 2


class CircuitPythonBus:
    """An I2C bus of smbus2 with the methods that libraries of CircuitPython call."""

    def __init__(self, bus: Any) -> None:
        """`bus`: an smbus2.SMBus."""
        from smbus2 import i2c_msg

        self._bus, self._messages = bus, i2c_msg

    def try_lock(self) -> bool:
        """Return True: the kernel lets nobody in between the messages of one transfer."""
        return True

    def unlock(self) -> None:
        """End what `try_lock` began."""

    def writeto(self, address: int, buffer: bytes, *, start: int = 0, end: int | None = None) -> None:
        """Write a part of `buffer`. Raises OSError."""
        self._bus.i2c_rdwr(self._messages.write(address, bytes(buffer[start:end])))

    def readfrom_into(self, address: int, buffer: bytearray, *, start: int = 0, end: int | None = None) -> None:
        """Fill a part of `buffer`. Raises OSError."""
        message = self._messages.read(address, len(buffer[start:end]))
        self._bus.i2c_rdwr(message)
        buffer[start:end] = bytes(message)


class Chip(NamedTuple):
    """One type of chip."""

    beam: Beam
    start: Callable[[Any, int], Any]
    """Begins to measure; takes bus and address, returns the library's object."""
    read: Callable[[Any], float | None]
    """Returns mm; None if nothing is in range."""


def _start_l0x(bus: Any, address: int) -> Any:
    from adafruit_vl53l0x import VL53L0X

    sensor = VL53L0X(bus, address, READY_WAIT)
    sensor.start_continuous()
    return sensor


def _read_l0x(sensor: Any) -> float | None:
    millimetres: float = sensor.range  # 8190 where nothing comes back
    return millimetres


def _start_l1x(bus: Any, address: int) -> Any:
    from adafruit_vl53l1x import VL53L1X

    sensor = VL53L1X(bus, address)
    sensor.distance_mode = LONG_DISTANCE
    sensor.start_ranging()
    return sensor


def _read_l1x(sensor: Any) -> float | None:
    end = time.monotonic() + READY_WAIT
    while not sensor.data_ready:
        if time.monotonic() > end:
            raise OSError("does not measure; check its power")
        time.sleep(READY_POLL)
    centimetres: float | None = sensor.distance
    sensor.clear_interrupt()
    return None if centimetres is None else 10.0 * centimetres


CHIPS: dict[type[I2cSettings], Chip] = {
    Vl53l0x: Chip(L0X_BEAM, _start_l0x, _read_l0x),
    Vl53l1x: Chip(L1X_BEAM, _start_l1x, _read_l1x),
}


class TimeOfFlight:
    """Sets the chip up with the first sample, and again after an error."""

    def __init__(self, settings: I2cSettings, *, open_bus: Callable[[int], Any] = open_bus) -> None:
        self._settings = settings
        self._chip = CHIPS[type(settings)]
        self._open = open_bus
        self._bus: Any = None
        self._sensor: Any = None

    @property
    def beam(self) -> Beam:
        """What it sees."""
        return self._chip.beam

    def sample(self) -> Scan:
        """Wait for a measurement. Raises OSError and ImportError."""
        try:
            if self._sensor is None:
                self._bus = self._open(self._settings.bus)
                self._sensor = self._chip.start(CircuitPythonBus(self._bus), self._settings.address)
            millimetres = self._chip.read(self._sensor)
        except ModuleNotFoundError as error:
            raise ImportError(f"{error}; install it: {install_command('tof')}") from error
        except (OSError, ValueError, RuntimeError) as error:  # ValueError: no chip there; RuntimeError: another one
            self.close()
            raise OSError(self._explain(error)) from error
        return self._chip.beam.scan(math.inf if millimetres is None else millimetres / 1000)

    def close(self) -> None:
        """Close the bus; the next sample opens it again."""
        bus, self._bus, self._sensor = self._bus, None, None
        if bus is not None:
            bus.close()

    def _explain(self, error: Exception) -> str:
        settings = self._settings
        text = explain_bus_error(error, settings.bus) if isinstance(error, OSError) else f"{error}; check wiring"
        name = type(settings).__name__.lower()
        return f"{name} at 0x{settings.address:02x} on I2C bus {settings.bus}: {text}"
