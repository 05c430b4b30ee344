"""Intents of the Setup screen: pre-arm checks, motor test, calibration, restart."""

from __future__ import annotations

from typing import TYPE_CHECKING

from groundstation.intents.base import Intent
from groundstation.intents.services import ServiceIntent

if TYPE_CHECKING:
    from groundstation.vehicles.services import VehicleServices

SETUP = "setup"
"""The service of the requests of the Setup screen."""
AUTOPILOT = 1.0
"""Parameter 1 of PREFLIGHT_REBOOT_SHUTDOWN: restart the autopilot, not its computer."""


class RunChecks(ServiceIntent, frozen=True, tag=True):
    """Let the vehicle run its pre-arm checks (MAV_CMD_RUN_PREARM_CHECKS)."""

    log_text = "run the pre-arm checks"
    service, what = SETUP, "pre-arm checks"

    def start(self, services: VehicleServices, now: float) -> None:
        services.commands.send_named(self.request, "RUN_PREARM_CHECKS", (), self.what, now)


class RebootVehicle(ServiceIntent, frozen=True, tag=True):
    """Restart the autopilot; it refuses while armed."""

    log_text = "restart the vehicle"
    service, what = SETUP, "reboot"

    def start(self, services: VehicleServices, now: float) -> None:
        services.commands.send_named(self.request, "PREFLIGHT_REBOOT_SHUTDOWN", (AUTOPILOT,), self.what, now)


class Calibrate(ServiceIntent, frozen=True, tag=True):
    """Begin a calibration; `kind` is one of vehicles/calibration/calibration.py, KINDS."""

    log_text = "calibrate {0.kind}"
    service, what = SETUP, "calibrate"

    kind: str = ""

    def start(self, services: VehicleServices, now: float) -> None:
        services.calibrate(self.request, self.kind, now)


class EndCalibration(ServiceIntent, frozen=True, tag=True):
    """End the calibration of the compass: write its result (`accept`), or cancel it."""

    service, what = SETUP, "end a calibration"

    accept: bool = False

    def start(self, services: VehicleServices, now: float) -> None:
        services.end_calibration(self.request, now, accept=self.accept)


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
