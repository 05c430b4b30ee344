"""PREFLIGHT_CALIBRATION of the gyro: its bias, measured while the rover stands. Other sensors are not calibrated.

It takes a few seconds, is told as progress, and COMMAND_CANCEL ends it (link/services/command/jobs.py). The estimator
goes on to learn from there, and nothing is kept over a restart: the bias of a cheap gyro changes with its temperature.
MAVProxy's `gyrocal` asks for it; MAVSDK's Calibration asks nobody but PX4.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects.enums import Result, Severity
from link.services.command.jobs import CommandJob
from link.services.command.server import CommandRequest
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.access import CommandAccess
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

SECONDS = 3.0
"""Of standing still: with 0.005 rad/s of noise the mean of 150 readings is good to 0.0004."""
SPREAD_MAX = 0.1
"""rad/s between the largest and the smallest reading of a rover that stands."""
GYRO = 1
"""Parameter 1, which is the gyro's; the others are those of other sensors: 0, or NaN for none."""


class CalibrationCommand:
    """Begins it, for the driver while disarmed."""

    def __init__(self, safety: Safety, navigator: Navigator, asking: CommandAccess, texts: StatusTextQueue) -> None:
        self._safety = safety
        self._navigator = navigator
        self._asking = asking
        self._texts = texts

    def handle_command(self, request: CommandRequest, now: float) -> Result | CommandJob:
        """A job where it can be done."""
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        gyro, *others = request.params
        if gyro != GYRO or any(value and not math.isnan(value) for value in others):
            return Result.UNSUPPORTED
        if self._navigator.turn_rate is None:
            return self._asking.reject(request, "there is no gyro", now)
        self._say(f"Gyro calibration: {SECONDS:g} s without moving", now)
        return GyroCalibration(self._safety, self._navigator, self._say, now)

    def _say(self, text: str, now: float) -> None:
        self._texts.send(Severity.INFO, text, now)


class GyroCalibration:
    """One under way: a `link.services.command.jobs.Job`."""

    def __init__(self, safety: Safety, navigator: Navigator, say: Callable[[str, float], None], now: float) -> None:
        self._safety = safety
        self._navigator = navigator
        self._say = say
        self._began = self._at = now
        self._count = 0
        self._sum = 0.0
        self._least, self._most = math.inf, -math.inf

    @property
    def percent(self) -> int:
        """How far it is."""
        return min(99, int(100 * (self._at - self._began) / SECONDS))

    def step(self, now: float) -> Result | None:
        """Measure once more."""
        self._at = now
        rate = self._navigator.turn_rate
        if self._safety.armed:
            return self._fail("armed", now)
        if rate is None:
            return self._fail("there is no gyro", now)
        self._count, self._sum = self._count + 1, self._sum + rate
        self._least, self._most = min(self._least, rate), max(self._most, rate)
        if self._most - self._least > SPREAD_MAX:
            return self._fail("it moves", now)
        return None if now - self._began < SECONDS else self._finish(now)

    def cancel(self, now: float) -> None:
        """The bias stays what it was."""
        self._say("Gyro calibration cancelled", now)

    def _finish(self, now: float) -> Result:
        bias = self._sum / self._count
        if not self._navigator.set_gyro_bias(bias):
            return self._fail("it turns, or the gyro is broken", now)
        self._say(f"Gyro calibrated: it is off by {math.degrees(bias):.2f} deg/s", now)
        return Result.ACCEPTED

    def _fail(self, why: str, now: float) -> Result:
        self._say(f"Gyro calibration failed: {why}", now)
        return Result.FAILED
