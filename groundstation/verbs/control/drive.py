"""`mavhelm drive`: drive by hand without a screen, for a time or as a script of keys says.

The demands are those of the screen: neutral first, 20 Hz, in the axes of the vehicle, inside the proof of the verb's
session to our vehicle. They end with neutral however the verb ends; when its process is killed or stands still, its
watchdog sends neutral (demand_guard.py).
"""

from __future__ import annotations

import argparse
import asyncio
import os

import msgspec

from dialects.axes import NEUTRAL, Axes
from dialects.kinds import VehicleKind
from groundstation.input.keymap import Keymap
from groundstation.input.sticks import Sticks
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from groundstation.intents.base import Intent
from groundstation.intents.driving import EmergencyStop
from groundstation.intents.vehicle import Disarm, SetMode
from groundstation.vehicles.demand.repeated_stop import StopTimes
from groundstation.vehicles.requests.requests import RequestState
from groundstation.verbs.common.arguments import LONGEST_HOLD, finite
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.arm import arm_first
from groundstation.verbs.control.driving import (
    DISARM_WITHIN,
    begin_driving,
    check_driving,
    disarm_vehicle,
    leave,
    need_accepted,
    need_control,
)
from groundstation.verbs.control.key_script import KeyLine, KeyScript, SteadyDemand, can_play
from groundstation.verbs.control.stop_jobs import emergency_job
from groundstation.verbs.control.stops import run_job
from groundstation.verbs.session.reports import finish, need_driven
from groundstation.verbs.session.session import VerbSession

LOOK_PERIOD = 0.01
"""s between two looks whether a line of the script is due, and whether the vehicle still takes demands."""


def percent(text: str) -> float:
    """Parse a demand. Raises ArgumentTypeError."""
    value = finite(text.removesuffix("%"))
    if abs(value) > 100:
        raise argparse.ArgumentTypeError(f"{text!r} is not from -100 to 100 %")
    return value


def limit(text: str) -> float:
    """Parse the limit of the keys. Raises ArgumentTypeError."""
    value = finite(text)
    if not LOWEST_LIMIT <= value <= HIGHEST_LIMIT:
        raise argparse.ArgumentTypeError(f"{text!r} is not from {LOWEST_LIMIT} to {HIGHEST_LIMIT:g}")
    return value


class GivenCourse(msgspec.Struct, frozen=True):
    """What to demand, for how long, or the script of keys and the key map of the user."""

    axes: Axes = NEUTRAL
    seconds: float = 0.0
    lines: tuple[KeyLine, ...] = ()
    keymap: Keymap = Keymap("none")
    speed: float = 0.0

    def build(self, model: VehicleKind) -> KeyScript | SteadyDemand:
        """Return what plays it on a vehicle of this kind. Raises VerbError for what it cannot do."""
        if not self.lines:
            if (self.axes.side or self.axes.climb) and not model.flies:
                raise VerbError(ExitCode.REFUSED, f"a {model.word} does not move sideways and does not climb")
            return SteadyDemand(self.axes, self.seconds)
        keymap = self.keymap.in_flight() if model.flies else self.keymap
        wrong = next((each for each in self.lines if not can_play(keymap.get_action(each.event.key))), None)
        if wrong is not None:
            text = f"line {wrong.number} of the script: {wrong.event.key} is no key that moves a {model.word}"
            raise VerbError(ExitCode.REFUSED, text)
        return KeyScript(self.lines, keymap, Sticks(Style.HOLD, self.speed))


def prepare(options: argparse.Namespace) -> object:
    """Return a GivenCourse in plain values. Raises VerbError, FileFormatError, ConfigError."""
    return msgspec.to_builtins(_read_course(options))


def _read_course(options: argparse.Namespace) -> GivenCourse:
    demands = (options.throttle, options.steering, options.side, options.climb)
    steady = [*demands, options.seconds]
    if options.script is not None:
        if any(each is not None for each in steady):
            raise VerbError(ExitCode.USAGE, "--script cannot be combined with a demand or --for")
        return _read_script(options)
    if options.seconds is None or not any(demands):
        raise VerbError(ExitCode.USAGE, "write --throttle or --steering PERCENT with --for S, or --script FILE")
    if options.seconds > LONGEST_HOLD:
        raise VerbError(ExitCode.USAGE, f"--for: {LONGEST_HOLD:g} s at most; --script drives longer")
    return GivenCourse(Axes(*((each or 0.0) / 100 for each in demands)), options.seconds)


def _read_script(options: argparse.Namespace) -> GivenCourse:
    from groundstation.config.effective import build_keymap, load_config, merge  # a steady demand does without
    from groundstation.verbs.common.local_file import read_text
    from groundstation.verbs.control.key_script_file import parse_script

    settings = merge(load_config(options.config, os.environ), os.environ, {}).settings
    keymap = build_keymap(settings)
    lines = parse_script(read_text(options.script), options.script, keymap)
    return GivenCourse(lines=lines, keymap=keymap, speed=options.speed or settings.speed)


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive; done when the time is over or the script has ended, and neutral was sent."""
    await session.need_only_vehicle(options.vehicle)
    state, armed_here = session.vehicle, False
    need_driven(state)
    course = msgspec.convert(options.given, GivenCourse).build(state.model)
    need_control(session)
    if not state.armed:
        failed = await arm_first(session, options, output, "`drive --arm` arms it, and disarms it again")
        if failed is not None:
            return finish(session, failed, output)
        armed_here = not options.stay_armed
    try:
        driven = await _drive(session, course)
    finally:
        report = await leave(session, disarm=armed_here)
    if report is not None and report.state is not RequestState.ACCEPTED:
        return finish(session, report, output)
    output.note(f"{state.name} was driven for {driven:.1f} s, then neutral{', and is disarmed' if armed_here else ''}")
    output.result(True, state.system, seconds=round(driven, 3), armed=state.armed)
    return ExitCode.DONE


async def _drive(session: VerbSession, course: KeyScript | SteadyDemand) -> float:
    """Drive, and return for how many s. Raises VerbError when the vehicle takes no demands any more."""
    await begin_driving(session)
    operator = session.contact.operator

    def demand(now: float) -> Axes:
        return NEUTRAL if session.core.standstill.last(now) is not None else course.axes(now)

    operator.inputs.add(session.now)
    course.begin(began := session.now)
    operator.demand = demand
    while not course.finished:
        await asyncio.sleep(max(0.0, min(LOOK_PERIOD, course.due - session.now)))
        check_driving(session, course.axes(session.now), began)
        while (intents := course.play(session.vehicle.armed, session.now)) is not None:
            operator.inputs.add(session.now)
            for intent in intents:
                await _carry_out(session, intent)
    return session.now - began


async def _carry_out(session: VerbSession, intent: Intent) -> None:
    """Do what a key requests of the vehicle; the sticks are neutral meanwhile. Raises VerbError."""
    contact, until = session.contact, session.now + DISARM_WITHIN
    if isinstance(intent, SetMode):
        modes, mode = session.services.modes, intent.mode
        report = await session.request(lambda number, now: modes.set(number, mode, now))
    elif isinstance(intent, Disarm):
        report = await disarm_vehicle(session)
    else:
        assert isinstance(intent, EmergencyStop)
        report = await run_job(
            session,
            "emergency stop",
            lambda number, now: emergency_job(number, contact.state, StopTimes(now, session.sure_at, until)),
        )
    need_accepted(report, session)
