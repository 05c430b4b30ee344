"""`mavhelm motor`: turn one motor of a disarmed vehicle for a moment."""

from __future__ import annotations

import argparse
import math

from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.setup import StopMotorTest, TurnMotor
from groundstation.station.driving.motor_test import LONGEST, THROTTLE_MAX
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.doctor_session import DoctorSession

KNOWN_WITHIN = 5.0
"""s to learn which motors the vehicle has."""


def percent(text: str) -> float:
    """Parse a throttle. Raises ArgumentTypeError."""
    try:
        value = float(text.removesuffix("%"))
    except ValueError:
        value = math.nan
    if not 0 < abs(value) <= THROTTLE_MAX * 100:
        limit = f"{THROTTLE_MAX:.0%}".removesuffix("%")
        raise argparse.ArgumentTypeError(f"{text!r} is not a throttle from -{limit} to {limit} %")
    return value


def duration(text: str) -> float:
    """Parse how long a motor turns. Raises ArgumentTypeError."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value <= LONGEST:
        raise argparse.ArgumentTypeError(f"{text!r} is not a time above 0 and up to {LONGEST:g} s")
    return value


async def run(session: DoctorSession, options: argparse.Namespace, output: Output) -> int:
    """Turn a motor; done when the vehicle has accepted and the time is over."""
    if not await session.find_vehicle(options.wait, options.vehicle):
        raise VerbError(ExitCode.NO_VEHICLE, f"no vehicle within {options.wait:g} s{session.describe_links()}")
    await session.until(lambda: bool(session.doctor.motors), KNOWN_WITHIN)
    view = session.doctor
    if not view.motors:
        raise VerbError(ExitCode.DIFFERS, f"{view.name}: it is not known which motors this vehicle has")
    number, there = options.number, ", ".join(f"{row.number} {row.name}" for row in view.motors)
    if not 1 <= number <= len(view.motors):
        raise VerbError(ExitCode.USAGE, f"there is no motor {number}; there are: {there}")
    output.note(f"{view.motors[number - 1].name} of {view.name} at {options.throttle:g} % for {options.seconds:g} s")
    session.do(ReportKeyReleases(), TurnMotor(view.system, number, options.throttle / 100))
    try:
        await session.until(lambda: not _turns(session), options.seconds)
    finally:  # also after Ctrl-C
        session.do(StopMotorTest())
        await session.until(lambda: _text(session) != "stands", 0.3)  # the stops are sent three times
    return _finish(session, number, output)


def _turns(session: DoctorSession) -> bool:
    test = session.doctor.test
    return test is not None and test.turning


def _text(session: DoctorSession) -> str:
    test = session.doctor.test
    return test.text if test is not None else ""


def _finish(session: DoctorSession, number: int, output: Output) -> int:
    view, text = session.doctor, _text(session)
    turned = any(row.number == number and row.tested for row in view.motors)
    refused = text.startswith(("refused", "not turned"))
    output.result(turned and not refused, view.system, motor=number, text=text)
    if refused:
        output.error(f"{view.name}: {text}")
        return ExitCode.REFUSED
    if not turned:
        output.error(f"{view.name}: no answer to the motor test")
        return ExitCode.NO_ANSWER
    return ExitCode.DONE
