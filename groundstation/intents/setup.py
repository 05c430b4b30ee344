"""Intents of the Setup screen: pre-arm checks, motor test, calibration, restart."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.intents.services import ServiceIntent


class RunChecks(ServiceIntent, frozen=True, tag=True):
    """Let the vehicle run its pre-arm checks (MAV_CMD_RUN_PREARM_CHECKS)."""


class RebootVehicle(ServiceIntent, frozen=True, tag=True):
    """Restart the autopilot; it refuses while armed."""


class Calibrate(ServiceIntent, frozen=True, tag=True):
    """Begin a calibration; `kind` is one of vehicles/calibration.py, KINDS."""

    kind: str = ""


class TurnMotor(Intent, frozen=True):
    """The key of a motor went down, or repeats: turn the motor while it is held, 2 s at most."""

    system: int
    """The vehicle that the operator saw."""
    motor: int
    """Number of the MotorRow."""
    throttle: float
    """-1..1; more than the limit of a motor test is refused."""
    repeat: bool = False
    """The terminal reports an auto-repeat: it begins nothing."""


class StopMotorTest(Intent, frozen=True):
    """The key of the motor went up, another key was pressed, or the screen is left."""

    valid_when_late = True


class ConfirmPosition(Intent, frozen=True):
    """The vehicle lies as the calibration of the accelerometers asks."""

    system: int


class EndCalibration(Intent, frozen=True):
    """End the calibration of the compass: accept and write its result, or cancel it."""

    system: int
    accept: bool = False


SETUP_INTENTS: tuple[type[Intent], ...] = (TurnMotor, StopMotorTest, ConfirmPosition, EndCalibration)
"""Those that station/doctor_desk.py carries out; the others are requests to services."""
