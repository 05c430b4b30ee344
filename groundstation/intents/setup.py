"""Intents of the Setup screen: pre-arm checks, motor test, calibration, restart."""

from __future__ import annotations

from groundstation.intents.base import Intent
from groundstation.intents.services import ServiceIntent


class RunChecks(ServiceIntent, frozen=True, tag=True):
    """Let the vehicle run its pre-arm checks (MAV_CMD_RUN_PREARM_CHECKS)."""


class RebootVehicle(ServiceIntent, frozen=True, tag=True):
    """Restart the autopilot; it refuses while armed."""


class Calibrate(ServiceIntent, frozen=True, tag=True):
    """Begin a calibration; `kind` is one of vehicles/calibration/calibration.py, KINDS."""

    kind: str = ""


class EndCalibration(ServiceIntent, frozen=True, tag=True):
    """End the calibration of the compass: write its result (`accept`), or cancel it."""

    accept: bool = False


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

    valid_when_late = open_to_all = True


class ConfirmPosition(Intent, frozen=True):
    """The vehicle lies as the calibration of the accelerometers asks."""

    system: int


class WatchSticks(Intent, frozen=True):
    """Begin the calibration of the RC sticks, or end it: the values are the screen's matter then."""

    system: int
    on: bool = True


SETUP_INTENTS: tuple[type[Intent], ...] = (TurnMotor, StopMotorTest, ConfirmPosition, WatchSticks)
"""Those that station/doctor/diagnostics.py carries out; the others are requests to services."""
