"""Simulated hardware that outlives the process which drives it, as real hardware does: its state is in a file.

Named on a command line as `tests.vehicle.motors.across_processes:CLASS`.
"""

from __future__ import annotations

import mmap
import os
from pathlib import Path
from typing import Any

from tests.vehicle.motors.fake_pca9685 import FakePca9685
from tests.vehicle.motors.fake_sysfs import FakeSysfs
from vehicle.motors.pca9685 import Pca9685Motors, Pca9685Settings
from vehicle.motors.sysfs_pwm import SysfsPwmMotors, SysfsPwmSettings

NAME = "tests.vehicle.motors.across_processes"


class FiledPca9685(FakePca9685):
    """Its registers are a file; a new one is a chip that has just got its power."""

    def __init__(self, path: Path) -> None:
        self.writes, self.failing, self.closed = [], 0, False
        new = not path.exists()
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        os.ftruncate(descriptor, 256)
        registers: Any = mmap.mmap(descriptor, 256)
        self.registers = registers
        os.close(descriptor)
        if new:
            self.lose_power()


class FiledPca9685Settings(Pca9685Settings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    registers: str


class Pca9685(Pca9685Motors):
    Settings: Any = FiledPca9685Settings

    def __init__(self, settings: FiledPca9685Settings) -> None:
        super().__init__(settings, bus=FiledPca9685(Path(settings.registers)))


class FiledSysfsSettings(SysfsPwmSettings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    root: str


class SysfsPwm(SysfsPwmMotors):
    Settings: Any = FiledSysfsSettings

    def __init__(self, settings: FiledSysfsSettings) -> None:
        super().__init__(settings, root=Path(settings.root), write=reopened(Path(settings.root)).write)


def reopened(root: Path) -> FakeSysfs:
    """The tree that another process made."""
    sysfs = object.__new__(FakeSysfs)
    sysfs.root, sysfs.writes, sysfs.refusing = root, [], ""
    return sysfs
