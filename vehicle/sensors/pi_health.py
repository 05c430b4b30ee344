"""Health of the Raspberry Pi: temperature, load, memory and supply voltage, from files of the kernel."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from vehicle.readings import ComputerReadings

PERIOD, MAX_AGE = 1.0, 5.0
"""s between readings, and how long one is valid."""

THERMAL = "sys/class/thermal/thermal_zone0/temp"
THROTTLED = "sys/devices/platform/soc*/soc*:firmware/get_throttled"
"""The output of `vcgencmd get_throttled`, in hexadecimal; only in the kernels of Raspberry Pi. The device tree of a
Pi 5 appends the address to the name `soc`."""
UNDER_VOLTAGE, CAPPED, SLOWED, WARM = 0x1, 0x2, 0x4, 0x8
"""Bits for the present state; shifted by 16 they say whether it occurred since boot."""
VOLTAGE_MONITOR = "rpi_volt"
"""Name of the supply in hwmon, for kernels without the file above."""

T = TypeVar("T")


class PiHealth:
    """Reads the files of the kernel; values that this computer does not provide are None."""

    def __init__(self, root: Path = Path("/")) -> None:
        """`root` is for tests."""
        self._root = root

    def sample(self) -> ComputerReadings:
        """Read all values once. Never raises for a missing or unexpected file."""
        used, total = self._try(self._memory) or (None, None)
        under_voltage, throttled = self._try(self._throttled) or (None, None)
        if under_voltage is None:
            under_voltage = self._try(self._monitor)
        return ComputerReadings(
            temperature=self._try(lambda: int(self._text(THERMAL)) / 1000),
            load=self._try(lambda: float(self._text("proc/loadavg").split()[0]) / (os.cpu_count() or 1)),
            memory_used=used,
            memory_total=total,
            uptime=self._try(lambda: float(self._text("proc/uptime").split()[0])),
            under_voltage=under_voltage,
            throttled=throttled,
        )

    def _text(self, path: str) -> str:
        return (self._root / path).read_text()

    @staticmethod
    def _try(read: Callable[[], T]) -> T | None:
        with contextlib.suppress(OSError, ValueError, IndexError, KeyError):
            return read()
        return None

    def _memory(self) -> tuple[int, int]:
        lines = (line.partition(":") for line in self._text("proc/meminfo").splitlines())
        kilobytes = {name: int(rest.split()[0]) for name, _, rest in lines}
        total = kilobytes["MemTotal"]
        return (total - kilobytes["MemAvailable"]) * 1024, total * 1024

    def _throttled(self) -> tuple[bool, bool]:
        [file] = self._root.glob(THROTTLED)
        bits = int(file.read_text(), 16)
        return bool(bits & UNDER_VOLTAGE), bool(bits & (CAPPED | SLOWED | WARM))

    def _monitor(self) -> bool | None:
        for name in sorted((self._root / "sys/class/hwmon").glob("hwmon*/name")):
            if name.read_text().strip() == VOLTAGE_MONITOR:
                return bool(int((name.parent / "in0_lcrit_alarm").read_text()))
        return None
