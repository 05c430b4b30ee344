"""PREFLIGHT_CALIBRATION of the gyro: measures its bias while the rover stands. Other sensors are not calibrated.

It takes 3 s, reports progress, and COMMAND_CANCEL ends it (link/services/command/jobs.py). The estimator goes on
learning from the new bias. The bias is not saved: that of a cheap gyro changes with its temperature. MAVProxy's
`gyrocal` sends this command; MAVSDK's Calibration sends it to PX4 only.
"""

from __future__ import annotations

import math

from dialects.enums import Command, Result, Severity
from link.services.command.jobs import CommandJob
from link.services.command.request import CommandRequest
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context

SECONDS = 3.0
"""s without motion: with 0.005 rad/s of noise the mean of 150 readings is accurate to 0.0004 rad/s."""
SPREAD_MAX = 0.1
"""rad/s; largest difference between two readings of a rover that stands."""
GYRO = 1
"""Parameter 1 for the gyro. The other parameters are for other sensors and must be 0 or NaN."""


class CalibrationCommand:
    """Starts the calibration, for the driver while disarmed."""

    def __init__(self, context: Context) -> None:
        self._context = context

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.PREFLIGHT_CALIBRATION, self._calibrate, Access.DRIVER_OR_UNCLAIMED,
                        "disarmed; 1: 1 the gyro, at rest for 3 s, with progress",
                        role=SigningRole.SET_UP),
        )  # fmt: skip

    def _calibrate(self, request: CommandRequest, now: float) -> Result | CommandJob:
        if self._context.safety.armed:
            return Result.TEMPORARILY_REJECTED
        gyro, *others = request.params
        if gyro != GYRO or any(value and not math.isnan(value) for value in others):
            return Result.UNSUPPORTED
        if self._context.navigator.turn_rate is None:
            return self._context.access.reject(request, "there is no gyro", now)
        return GyroCalibration(self._context, now)


class GyroCalibration:
    """A calibration under way: a `link.services.command.jobs.CommandJob`."""

    def __init__(self, context: Context, now: float) -> None:
        self._safety = context.safety
        self._navigator = context.navigator
        self._texts = context.statustext
        self._began = self._at = now
        self._count = 0
        self._sum = 0.0
        self._least, self._most = math.inf, -math.inf
        self._send(f"Gyro calibration: {SECONDS:g} s without moving", now)

    @property
    def percent(self) -> int:
        """Progress of the measurement."""
        return min(99, int(100 * (self._at - self._began) / SECONDS))

    def step(self, now: float) -> Result | None:
        """Handle one reading."""
        self._at = now
        rate = self._navigator.turn_rate
        if self._safety.armed:
            return self._fail("armed", now)
        if rate is None:
            return self._fail("there is no gyro", now)
        self._count, self._sum = self._count + 1, self._sum + rate
        self._least, self._most = min(self._least, rate), max(self._most, rate)
        if self._most - self._least > SPREAD_MAX:
            return self._fail("the rover moves", now)
        return None if now - self._began < SECONDS else self._finish(now)

    def cancel(self, now: float) -> None:
        """Stop; the bias stays as it was."""
        self._send("Gyro calibration cancelled", now)

    def _finish(self, now: float) -> Result:
        bias = self._sum / self._count
        if not self._navigator.set_gyro_bias(bias):
            return self._fail("the rover turns, or the gyro is faulty", now)
        self._send(f"Gyro calibrated: bias {math.degrees(bias):.2f} deg/s", now)
        return Result.ACCEPTED

    def _fail(self, why: str, now: float) -> Result:
        self._send(f"Gyro calibration failed: {why}", now)
        return Result.FAILED

    def _send(self, text: str, now: float) -> None:
        self._texts.send(Severity.INFO, text, now)
