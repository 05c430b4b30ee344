"""One channel of a PWM chip in /sys/class/pwm: found, exported, and written to in an order the kernel takes."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Callable
from pathlib import Path

from vehicle.motors import MotorError

ROOT = Path("/sys/class/pwm")
RULES_WAIT = 1.0
"""s that udev may take after an export until its rule lets the group `gpio` write."""


def write_file(path: Path, text: str) -> None:
    """How sysfs takes a value: in one write."""
    path.write_text(text)


class SysfsPwmChannel:
    """One exported channel. Every order of writes below is one the kernel takes: duty is never more than period."""

    def __init__(self, directory: Path, frequency: float, write: Callable[[Path, str], None]) -> None:
        self.period = round(1e9 / frequency)
        """ns"""
        self._directory = directory
        self._write = write

    @property
    def is_running(self) -> bool:
        """The output is enabled, by us or by a process before us."""
        return self._read("enable") == 1

    def set_period(self) -> None:
        """Ours, in place of another; without a pulse in between."""
        if self._read("period") != self.period:
            self.set_duty(0)
            self._write_value("period", self.period)

    def set_duty(self, nanoseconds: int) -> None:
        """Length of the pulse."""
        self._write_value("duty_cycle", nanoseconds)

    def start(self) -> None:
        """Let the duty out."""
        self._write_value("enable", 1)

    def stop(self) -> None:
        """Duty 0 first: some drivers leave the pin at the level it had."""
        with contextlib.ExitStack() as steps:
            steps.callback(self._write_value, "enable", 0)
            self.set_duty(0)

    def _read(self, name: str) -> int:
        return int((self._directory / name).read_text())

    def _write_value(self, name: str, value: int) -> None:
        self._write(self._directory / name, str(value))


def export_channel(root: Path, device: str, channel: int, write: Callable[[Path, str], None]) -> Path:
    """The channel's directory. Raises MotorError, OSError."""
    chip = _chip(root, device)
    channels = int((chip / "npwm").read_text())
    if channel >= channels:
        raise MotorError(f"hardware PWM: {device} has {channels} channels, 0 to {channels - 1}")
    directory = chip / f"pwm{channel}"
    if not directory.exists():
        write(chip / "export", str(channel))
        _await_rules(directory / "enable")
    return directory


def _chip(root: Path, device: str) -> Path:
    chips = {chip: chip.resolve() for chip in sorted(root.glob("pwmchip*"))}
    for chip, real in chips.items():
        if device in real.parts:
            return chip
    there = ", ".join(real.parent.parent.name for real in chips.values()) or "none (dtoverlay=pwm-2chan is missing?)"
    raise MotorError(f"hardware PWM: no device {device!r}; there is {there}")


def _await_rules(path: Path) -> None:
    """Before the control loop runs; a write that is still not allowed then says so."""
    never, waited = threading.Event(), 0.0
    while waited < RULES_WAIT and not os.access(path, os.W_OK):
        never.wait(0.02)
        waited += 0.02
