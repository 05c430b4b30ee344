"""A servo at a chip that outlives the process which drives it; motors/across_processes.py has the motors at it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from tests.vehicle.motors.across_processes import FiledPca9685
from vehicle.accessories.pca9685 import Pca9685Servo, Pca9685ServoSettings

NAME = "tests.vehicle.accessories.across_processes"


class FiledServoSettings(Pca9685ServoSettings, frozen=True, forbid_unknown_fields=True, kw_only=True):
    registers: str


class FiledServo(Pca9685Servo):
    Settings: Any = FiledServoSettings

    def __init__(self, settings: FiledServoSettings, value: int) -> None:
        super().__init__(settings, value, bus=FiledPca9685(Path(settings.registers)))
