"""`mavhelm vehicle motor-test`: turn one motor slowly and briefly, to identify its wheel and direction."""

from __future__ import annotations

import contextlib
import math
import signal
import time
from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from dialects.enums import DriveType
from vehicle.drive.gate import MOTOR_TEST_THROTTLE_MAX as LARGEST
from vehicle.drive.gate import MOTOR_TEST_TIME_MAX as LONGEST
from vehicle.drive.mixer import MIXERS
from vehicle.drive.output_scaling import build_output_scaling, scale_outputs
from vehicle.motors.drivers import open_motors
from vehicle.params import Params
from vehicle.runtime.lock import MotorLock

PERIOD = 0.02
"""s between writes: as in the control loop, so that controllers with a timeout of their own continue."""
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


class RefusedError(Exception):
    """The test is rejected; the text is one line."""


class MotorTestOptions(msgspec.Struct, frozen=True):
    """Throttle of each motor, and duration in s."""

    throttles: tuple[float, ...]
    time: float


def build_options(motor: str, throttle: float, seconds: float, params: Params) -> MotorTestOptions:
    """Check the request. `motor` is a name of this drive type, or a number from 1. Raises RefusedError."""
    mixer = MIXERS[DriveType(int(params["DRIVE_TYPE"]))]
    names = mixer.motors
    known = {name.replace(" ", "-"): index for index, name in enumerate(names)}
    known |= {str(index + 1): index for index in range(len(names))}
    if motor.lower() not in known:
        raise RefusedError(f"no motor {motor!r}; known: {', '.join(known)}")
    if not (math.isfinite(throttle) and abs(throttle) <= LARGEST):
        raise RefusedError(f"throttle {throttle:g} is not in -{LARGEST:g} to {LARGEST:g}")
    if not (math.isfinite(seconds) and 0.0 < seconds <= LONGEST):
        raise RefusedError(f"time {seconds:g} s must be more than 0 and at most {LONGEST:g}")
    wheels = [0.0] * len(names)
    wheels[known[motor.lower()]] = throttle
    return MotorTestOptions(scale_outputs(wheels, mixer.driven_count, build_output_scaling(params)), seconds)


def run_motor_test(table: Mapping[str, Any], wanted: MotorTestOptions) -> signal.Signals | None:
    """Run the test on the motors of the table [motors]. Returns the signal that ended the test early, or None.

    The motors are neutral and disabled at the end, whatever happens. Raises MotorError, RefusedError.
    """
    settings = {key: value for key, value in table.items() if key != "driver"}
    with contextlib.ExitStack() as opened, _signals_blocked(SIGNALS):
        opened.callback(MotorLock(table).close)
        motors = open_motors(table["driver"], settings)
        opened.callback(motors.close)
        if len(wanted.throttles) != motors.count:
            raise RefusedError(f"the driver has {motors.count} motors, DRIVE_TYPE needs {len(wanted.throttles)}")
        opened.callback(motors.disable)
        opened.callback(motors.set, (0.0,) * motors.count)
        motors.enable()
        end = time.monotonic() + wanted.time
        while (left := end - time.monotonic()) > 0:
            motors.set(wanted.throttles)
            if (ended := _wait_for_signal(min(PERIOD, left))) is not None:
                return ended
    return None


def _wait_for_signal(seconds: float) -> signal.Signals | None:
    """Return the first of SIGNALS, which are blocked; None if there is none in that time."""
    if hasattr(signal, "sigtimedwait"):
        ended = signal.sigtimedwait(SIGNALS, seconds)
        return None if ended is None else signal.Signals(ended.si_signo)
    if not signal.sigpending().intersection(SIGNALS):  # macOS cannot wait for both
        time.sleep(seconds)
    return signal.Signals(signal.sigwait(SIGNALS)) if signal.sigpending().intersection(SIGNALS) else None


@contextlib.contextmanager
def _signals_blocked(signals: Sequence[signal.Signals]) -> Any:
    """Block signals until they are polled, so that none interrupts the program while a motor turns."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
