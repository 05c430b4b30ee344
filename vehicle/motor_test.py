"""Turns one motor, slowly and shortly, to see which wheel it is and which way it goes; nothing but driver and clock."""

from __future__ import annotations

import contextlib
import math
import signal
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from dialects.enums import DriveType
from vehicle.lock import MotorLock
from vehicle.mixer import MIXERS
from vehicle.motors import open_motors
from vehicle.outputs import TRIAL_LARGEST as LARGEST
from vehicle.outputs import TRIAL_LONGEST as LONGEST

PERIOD = 0.02
"""s between writes: that of the control loop, so that controllers with a timeout of their own go on."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class RefusedError(Exception):
    """This test is not made; the text is one line."""


@dataclass(frozen=True, slots=True)
class Wish:
    """Which motor, how fast, how long."""

    index: int
    throttle: float
    time: float


def wish(motor: str, throttle: float, seconds: float, drive_type: float) -> Wish:
    """What was asked for, checked. `motor` is a name of this kind of drive, or a number from 1. Raises RefusedError."""
    names = MIXERS[DriveType(int(drive_type))].motors
    known = {name.replace(" ", "-"): index for index, name in enumerate(names)}
    known |= {str(index + 1): index for index in range(len(names))}
    if motor.lower() not in known:
        raise RefusedError(f"no motor {motor!r}; there are {', '.join(known)}")
    if not (math.isfinite(throttle) and abs(throttle) <= LARGEST):
        raise RefusedError(f"throttle {throttle:g} is not in -{LARGEST:g} to {LARGEST:g}")
    if not (math.isfinite(seconds) and 0.0 < seconds <= LONGEST):
        raise RefusedError(f"time {seconds:g} s is not more than 0 and at most {LONGEST:g}")
    return Wish(known[motor.lower()], throttle, seconds)


def turn(table: Mapping[str, Any], wanted: Wish) -> signal.Signals | None:
    """Turn it; neutral and without power whatever happens. The signal that ended it early, or None. Raises MotorError.

    `table` is [motors] of the settings.
    """
    settings = {key: value for key, value in table.items() if key != "driver"}
    with contextlib.ExitStack() as opened, _held_back(SIGNALS):
        opened.callback(MotorLock(table).close)
        motors = open_motors(table["driver"], settings)
        opened.callback(motors.close)
        if wanted.index >= motors.count:
            raise RefusedError(f"the motor driver has {motors.count} motors only")
        throttles = [0.0] * motors.count
        opened.callback(motors.disable)
        opened.callback(motors.set, tuple(throttles))
        motors.enable()
        throttles[wanted.index] = wanted.throttle
        end = time.monotonic() + wanted.time
        while (left := end - time.monotonic()) > 0:
            motors.set(throttles)
            ended = signal.sigtimedwait(SIGNALS, min(PERIOD, left))
            if ended is not None:
                return signal.Signals(ended.si_signo)
    return None


@contextlib.contextmanager
def _held_back(signals: Sequence[signal.Signals]) -> Any:
    """Signals wait until they are asked for: none may come between a motor that turns and its end."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
