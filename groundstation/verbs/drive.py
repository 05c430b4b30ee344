"""`groundstation drive`: drive by hand without a screen, for a time or as a script of keys says.

The demands are those of the screen: neutral first, 20 Hz, in the axes of the vehicle, inside the proof of the verb's
session to our vehicle. They end with neutral however the verb ends; when its process is killed or stands still, its
watchdog sends neutral (demand_guard.py).
"""

from __future__ import annotations

import argparse
import asyncio
import os

from dialects.axes import NEUTRAL, Axes
from dialects.enums import Autopilot
from dialects.modes import DRIVABLE_MODES, STANDING_MODES, Mode
from groundstation.config.effective import build_keymap, load_config, merge
from groundstation.input.sticks import Sticks
from groundstation.input.style import HIGHEST_LIMIT, LOWEST_LIMIT, Style
from groundstation.intents.base import Intent
from groundstation.intents.driving import EmergencyStop
from groundstation.intents.vehicle import Disarm, SetMode
from groundstation.station.emergency import EmergencyLock
from groundstation.station.operator import NEUTRAL_LEAD
from groundstation.vehicles.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.verbs.arguments import LONGEST_HOLD, finite
from groundstation.verbs.arm import arm
from groundstation.verbs.control import ask_for_control
from groundstation.verbs.exit_codes import ExitCode, VerbError, code_of
from groundstation.verbs.key_script import KeyScript, SteadyDemand, parse_script
from groundstation.verbs.local_file import read_text
from groundstation.verbs.output import Output
from groundstation.verbs.reports import finish
from groundstation.verbs.session import TOLD_WITHIN, VerbSession
from groundstation.verbs.stop_jobs import EmergencyJob, disarm_job
from groundstation.verbs.stops import run_job

LOOK_PERIOD = 0.01
"""s between two looks whether a line of the script is due, and whether the vehicle still takes demands."""
DISARM_WITHIN = 10.0
"""s for which the disarming at the end is repeated."""
FRAME_PARAMETER = "CA_AIRFRAME"
"""What decides on the axes of PX4."""


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


def check(options: argparse.Namespace) -> None:
    """Read the script, or what to demand and how long. Raises VerbError, FileFormatError, ConfigError."""
    steady = [options.throttle, options.steering, options.seconds]
    if options.script is not None:
        if any(each is not None for each in steady):
            raise VerbError(ExitCode.USAGE, "--script goes without --throttle, --steering and --for")
        options.course = _load(options)
        return
    if options.seconds is None or not (options.throttle or options.steering):
        raise VerbError(ExitCode.USAGE, "write --throttle PERCENT --for S, --steering likewise, or --script FILE")
    if options.seconds > LONGEST_HOLD:
        raise VerbError(ExitCode.USAGE, f"--for: {LONGEST_HOLD:g} s at most; --script drives longer")
    axes = Axes((options.throttle or 0.0) / 100, (options.steering or 0.0) / 100)
    options.course = SteadyDemand(axes, options.seconds)


def _load(options: argparse.Namespace) -> KeyScript:
    settings = merge(load_config(options.config, os.environ), os.environ, {}).settings
    keymap = build_keymap(settings)
    lines = parse_script(read_text(options.script), options.script, keymap)
    return KeyScript(lines, keymap, Sticks(Style.HOLD, options.speed or settings.speed))


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Drive; done when the time is over or the script has ended, and neutral was sent."""
    await session.need_only_vehicle(options.vehicle)
    state, armed_here = session.vehicle, False
    _need_control(session)
    if not state.armed:
        if not options.arm:
            raise VerbError(ExitCode.REFUSED, f"{state.name} is disarmed: `drive --arm` arms it, and disarms it again")
        armed = await arm(session, options.wait, output)
        if armed.state is not RequestState.ACCEPTED:
            return finish(session, armed, output)
        armed_here = not options.stay_armed
    try:
        driven = await _drive(session, options.course)
    finally:
        report = await _leave(session, disarm=armed_here)
    if report is not None and report.state is not RequestState.ACCEPTED:
        return finish(session, report, output)
    output.note(f"{state.name} was driven for {driven:.1f} s, then neutral{', and is disarmed' if armed_here else ''}")
    output.result(True, state.system, seconds=round(driven, 3), armed=state.armed)
    return ExitCode.DONE


async def _drive(session: VerbSession, course: KeyScript | SteadyDemand) -> float:
    """Drive, and return for how many s. Raises VerbError when the vehicle takes no demands any more."""
    await _prepare(session)
    operator = session.contact.operator

    def demand(now: float) -> Axes:
        return NEUTRAL if _stall(session, now) is not None else course.axes(now)

    operator.record_input(session.now)
    course.begin(began := session.now)
    operator.demand = demand
    while not course.finished:
        await asyncio.sleep(max(0.0, min(LOOK_PERIOD, course.due - session.now)))
        _check(session, course.axes(session.now), began)
        while (intents := course.play(session.vehicle.armed, session.now)) is not None:
            operator.record_input(session.now)
            for intent in intents:
                await _carry_out(session, intent)
    return session.now - began


async def _prepare(session: VerbSession) -> None:
    """Take control, change HOLD to MANUAL, and show neutral. Raises VerbError."""
    contact, state = session.contact, session.vehicle
    if state.drives_itself:
        raise VerbError(ExitCode.REFUSED, f"{state.name} drives itself ({state.mode}); `groundstation stop` stops it")
    if state.has_rover_dialect and not state.driver:
        _need(await ask_for_control(session), session)
    if state.mode in STANDING_MODES:
        modes = session.services.modes
        _need(await session.request(lambda number, now: modes.set(number, Mode.MANUAL.name, now)), session)
    await _learn_frame(session)
    contact.operator.demanding = True
    if state.has_rover_dialect:
        await session.wait_for(lambda: contact.in_control, TOLD_WITHIN)
    await asyncio.sleep(NEUTRAL_LEAD)
    _need_control(session)


async def _learn_frame(session: VerbSession) -> None:
    """Find out which axes turn the nose: in reverse they differ by how the vehicle steers."""
    state, params = session.vehicle, session.services.params
    if state.drive_info is not None and state.mode != Mode.ACRO.name:
        session.contact.operator.frame = int(state.drive_info.drive_type)
    if state.autopilot == Autopilot.PX4:
        await session.request(lambda number, now: params.read(number, FRAME_PARAMETER, now))
        known = params.client.params.get(FRAME_PARAMETER)
        session.contact.operator.frame = None if known is None else int(known.value)


def _stall(session: VerbSession, now: float) -> float | None:
    return session.core.guard.stood_still(now) if session.core.guard else None


def _need_control(session: VerbSession) -> None:
    contact = session.contact
    if contact.other_driver is not None and not contact.state.control.silent:
        text = f"GCS {contact.other_driver} is in control of {contact.state.name}"
        raise VerbError(ExitCode.NOT_IN_CONTROL, f"{text}; `groundstation control request` asks for it")


def _check(session: VerbSession, axes: Axes, began: float) -> None:
    """Raise VerbError if this program stood still, or if a demand is not neutral and the vehicle does not take it."""
    state, now = session.vehicle, session.now
    stood = _stall(session, now)
    if stood is not None:
        raise VerbError(ExitCode.BROKEN, f"this program stood still for {stood:.1f} s: the demand has ended")
    if axes.neutral:
        return
    after = f"after {now - began:.1f} s"
    if not state.monitor.is_alive(now):
        raise VerbError(ExitCode.NO_ANSWER, f"{state.name}: link lost {after}; neutral")
    _need_control(session)
    fault = _fault(session)
    if fault is not None:
        raise VerbError(ExitCode.REFUSED, f"{state.name} {fault} {after}; neutral")


def _fault(session: VerbSession) -> str | None:
    """Return why the vehicle takes no demands now, or None."""
    state = session.vehicle
    if state.emergency_stop:
        return "is in the emergency stop"
    if not state.armed:
        return "is disarmed"
    return None if state.mode in DRIVABLE_MODES else f"takes no demands in {state.mode}"


async def _carry_out(session: VerbSession, intent: Intent) -> None:
    """Do what a key requests of the vehicle; the sticks are neutral meanwhile. Raises VerbError."""
    contact, until = session.contact, session.now + DISARM_WITHIN
    if isinstance(intent, SetMode):
        modes, mode = session.services.modes, intent.mode
        report = await session.request(lambda number, now: modes.set(number, mode, now))
    elif isinstance(intent, Disarm):
        report = await _disarm(session)
    else:
        assert isinstance(intent, EmergencyStop)
        report = await run_job(
            session,
            "emergency stop",
            lambda number, now: EmergencyJob(number, EmergencyLock(contact.state, now), until),
        )
    _need(report, session)


def _need(report: RequestReport, session: VerbSession) -> None:
    if report.state is not RequestState.ACCEPTED:
        raise VerbError(code_of(report, session.contact.other_driver), f"{session.vehicle.name}: {report.text}")


async def _disarm(session: VerbSession) -> RequestReport:
    state, until = session.vehicle, session.now + DISARM_WITHIN
    return await run_job(session, "disarm", lambda number, now: disarm_job(number, state, until))


async def _leave(session: VerbSession, *, disarm: bool) -> RequestReport | None:
    """Send the final neutrals, then disarm; return how that ended."""
    operator = session.contact.operator
    operator.demand = lambda _: NEUTRAL
    operator.demanding = False
    await session.wait_for(lambda: operator.finished, 2 * FINAL_NEUTRALS * DRIVING_PERIOD)
    return await _disarm(session) if disarm and session.vehicle.armed else None
