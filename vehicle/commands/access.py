"""Commands that only the ground station in control may give, and how a refusal is told."""

from __future__ import annotations

import math

from dialects.enums import Command, Result, Severity
from link.services.command.jobs import CommandJob
from link.services.command.server import CommandHandler, CommandRequest, RunCommand
from vehicle.drive.control import Control
from vehicle.navigation.geo import Home
from vehicle.statustext import StatusTextQueue

GLOBAL_FRAMES = (0, 3, 5, 6)
"""MAV_FRAME_GLOBAL, _RELATIVE_ALT and their _INT: frames that a place on the globe may have."""
RELATIVE_FRAMES = (3, 6)
"""... and those whose height is above home. A place of COMMAND_LONG is in MAV_FRAME_GLOBAL, as ArduPilot's home is."""

ALTITUDE_MAX = 1e5
"""m; what is farther above the sea, or below, is no height of a rover."""


class CommandAccess:
    """Knows who is in control, and what to say to the others."""

    def __init__(self, control: Control, texts: StatusTextQueue) -> None:
        self._control = control
        self._texts = texts

    def require_control(self, run: RunCommand) -> CommandHandler:
        """A handler for the ground station in control, or any introduced one where nobody is."""

        def checked(request: CommandRequest, now: float) -> Result | CommandJob:
            refusal = self.denial_reason(request)
            return self.reject(request, refusal, now) if refusal else run(request, now)

        return CommandHandler(checked)

    def denial_reason(self, request: CommandRequest) -> str | None:
        """Why its sender may not command, or None."""
        return self._control.denial_reason(request.system) if request.introduced else "no HEARTBEAT heard"

    def reject(self, request: CommandRequest, why: str, now: float) -> Result:
        """Something must be put right first; the driver reads what."""
        name = Command(request.command).name
        self._texts.send(Severity.WARNING, f"GCS {request.system}: {name} refused: {why}", now)
        return Result.FAILED


def parse_position(request: CommandRequest) -> tuple[float, float] | Result:
    """Latitude and longitude, degrees x 1e7, of parameters 5 and 6; or the answer where they are none."""
    if request.is_int and request.frame not in GLOBAL_FRAMES:
        return Result.UNSUPPORTED_FRAME
    scale = 1.0 if request.is_int else 1e7
    latitude, longitude = request.params[4] * scale, request.params[5] * scale
    return Result.DENIED if is_invalid_position(latitude, longitude) else (latitude, longitude)


def parse_altitude(request: CommandRequest, home: Home | None) -> float | None:
    """m above the sea, of parameter 7; None where it is left out."""
    altitude = request.params[6]
    if math.isnan(altitude):
        return None
    return altitude + (home.altitude if home and request.frame in RELATIVE_FRAMES else 0.0)


def is_invalid_position(latitude: float, longitude: float) -> bool:
    """0/0, INT32_MAX, NaN and what is beyond the poles, in degrees x 1e7."""
    return not (abs(latitude) <= 90e7 and abs(longitude) <= 180e7) or (latitude, longitude) == (0, 0)
