"""One channel of a PWM chip in /sys/class/pwm: finding it, exporting it, and writing its values.

Interface: https://docs.kernel.org/driver-api/pwm.html
"""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable
from pathlib import Path

from vehicle.motors import MotorError

ROOT = Path("/sys/class/pwm")
RULES_WAIT = 1.0
"""s to wait after an export until a udev rule lets the group `gpio` write."""


def write_file(path: Path, text: str) -> None:
    """Write a value in one write, as sysfs requires."""
    path.write_text(text)


class SysfsPwmChannel:
    """One exported channel. The order of writes suits the kernel: the duty never exceeds the period."""

    def __init__(self, directory: Path, frequency: float, write: Callable[[Path, str], None]) -> None:
        self.period = round(1e9 / frequency)
        """Period in ns."""
        self._directory = directory
        self._write = write

    @property
    def is_running(self) -> bool:
        """Whether the output is enabled, by this or an earlier process."""
        return self._read("enable") == 1

    def set_period(self) -> None:
        """Set the period if it differs, without a pulse in between."""
        if self._read("period") != self.period:
            self.set_duty(0)
            self._write_value("period", self.period)

    def set_duty(self, nanoseconds: int) -> None:
        """Set the pulse width in ns."""
        self._write_value("duty_cycle", nanoseconds)

    def start(self) -> None:
        """Enable the output."""
        self._write_value("enable", 1)

    def stop(self) -> None:
        """Set duty 0, then disable the output: some kernel drivers leave the pin at its last level."""
        with contextlib.ExitStack() as steps:
            steps.callback(self._write_value, "enable", 0)
            self.set_duty(0)

    def _read(self, name: str) -> int:
        return int((self._directory / name).read_text())

    def _write_value(self, name: str, value: int) -> None:
        self._write(self._directory / name, str(value))


def export_channel(root: Path, device: str, channel: int, write: Callable[[Path, str], None]) -> Path:
    """Export a channel if needed and return its directory. Raises MotorError, OSError."""
    chip = _chip(root, device)
    channels = int((chip / "npwm").read_text())
    if channel >= channels:
        raise MotorError(f"hardware PWM: {device} has {channels} channels, 0 to {channels - 1}")
    directory = chip / f"pwm{channel}"
    if not directory.exists():
        write(chip / "export", str(channel))
        _wait_for_udev(directory / "enable")
    return directory


def _chip(root: Path, device: str) -> Path:
    chips = {chip: chip.resolve() for chip in sorted(root.glob("pwmchip*"))}
    for chip, real in chips.items():
        if device in real.parts:
            return chip
    found = ", ".join(real.parent.parent.name for real in chips.values()) or "none (dtoverlay=pwm-2chan is missing?)"
    raise MotorError(f"hardware PWM: no device {device!r}; there is {found}")


def _wait_for_udev(path: Path) -> None:
    """Wait until `path` is writable, at most RULES_WAIT s. Blocks, before the control loop runs."""
    never, waited = threading.Event(), 0.0
    while waited < RULES_WAIT and not os.access(path, os.W_OK):
        never.wait(0.02)
        waited += 0.02
