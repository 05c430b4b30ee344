"""`mavhelm takeoff` and `land`: what keys fly takes off and hovers, by neutral demands, or lands where it is."""

from __future__ import annotations

import argparse
import asyncio

from dialects import messages as m
from dialects.enums import Command
from groundstation.intents.vehicle import HIGHEST_TAKE_OFF, LOWEST_TAKE_OFF
from groundstation.vehicles.demand.repeated_stop import StopTimes, mode_stop
from groundstation.vehicles.demand.take_off import find_fence_refusal, find_refusal, take_off_params
from groundstation.verbs.common.arguments import finite
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.arm import arm_first
from groundstation.verbs.control.driving import begin_driving, leave, need_accepted, need_control
from groundstation.verbs.control.stop_jobs import StopJob
from groundstation.verbs.control.stops import REPEAT_FOR, run_job
from groundstation.verbs.session.rates import request_interval
from groundstation.verbs.session.reports import finish, need_driven
from groundstation.verbs.session.session import VerbSession

PERIOD = 0.05
"""s between looks at the altitude."""
REPORTS = 4.0
"""Hz of EXTENDED_SYS_STATE, which says whether it is on the ground."""
LANDED_WITHIN = 3.0
"""s for the first such report."""
NEAR = 0.4
"""m from the altitude within which the take-off has ended."""
SLOWEST, SPIN_UP = 0.3, 10.0
"""m/s and s: a take-off that takes longer has failed."""


def altitude(text: str) -> float:
    """Parse an altitude of a take-off. Raises ArgumentTypeError."""
    value = finite(text)
    if not LOWEST_TAKE_OFF <= value <= HIGHEST_TAKE_OFF:
        raise argparse.ArgumentTypeError(f"{text!r} is not from {LOWEST_TAKE_OFF:g} to {HIGHEST_TAKE_OFF:g} m")
    return value


async def take_off(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Take off; done when the altitude is reached. Neutral demands go out until then."""
    await session.need_only_vehicle(options.vehicle)
    state = session.vehicle
    _need_flight(session)
    need_control(session)
    if not state.armed and (failed := await arm_first(session, options, output, "`takeoff --arm` arms it")):
        return finish(session, failed, output)
    try:
        await _take_off(session, options.altitude)
    finally:
        await leave(session, disarm=False)
    height = session.vehicle.build_view(session.now).altitude
    output.note(f"{state.name} hovers at {height:.1f} m{_afterwards(session)}")
    output.result(True, state.system, altitude=height)
    return ExitCode.DONE


async def land(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Land here, repeated until the heartbeat reports it."""
    await session.need_only_vehicle(options.vehicle)
    state = session.vehicle
    _need_flight(session)
    landing = mode_stop(state, state.model.land, StopTimes(session.now, session.sure_at, session.now + REPEAT_FOR))
    assert landing is not None
    report = await run_job(session, "land", lambda number, now: StopJob(number, landing))
    return finish(session, report, output, "lands", mode=state.model.land)


def _need_flight(session: VerbSession) -> None:
    """Raise VerbError for what does not fly."""
    state = session.vehicle
    need_driven(state)
    if not state.model.flies:
        raise VerbError(ExitCode.REFUSED, f"{state.name}: a {state.model.word} does not fly")


async def _take_off(session: VerbSession, height: float) -> None:
    state, commands = session.vehicle, session.services.commands
    await request_interval(session, m.ExtendedSysState, 1e6 / REPORTS)
    await begin_driving(session)
    await session.wait_for(lambda: not find_refusal(state, "", session.now), LANDED_WITHIN)
    fence = session.contact.contact.altitude_fence
    if why := find_refusal(state, "", session.now) or find_fence_refusal(height, fence):
        raise VerbError(ExitCode.REFUSED, f"{state.name}: take-off: {why}")
    where = take_off_params(state, height)
    need_accepted(
        await session.request(lambda number, now: commands.send(number, Command.NAV_TAKEOFF, where, "take-off", now)),
        session,
    )
    await _climb(session, height)


async def _climb(session: VerbSession, height: float) -> None:
    """Wait until it has climbed. Raises VerbError when it does not, or when nobody can tell."""
    state, until = session.vehicle, session.now + SPIN_UP + height / SLOWEST
    reached = 0.0
    while abs(height - reached) > NEAR or state.drives_itself:  # PX4 hovers once its mode for take-off has ended
        await asyncio.sleep(PERIOD)
        need_control(session)
        reached = state.build_view(session.now).altitude or 0.0
        if not state.monitor.is_alive(session.now):
            raise VerbError(
                ExitCode.NO_ANSWER, f"{state.name}: link lost at {reached:.1f} m; its own failsafe flies it"
            )
        if not state.armed:
            raise VerbError(ExitCode.REFUSED, f"{state.name} has disarmed at {reached:.1f} m")
        if state.mode in (state.model.land, state.model.home):
            raise VerbError(ExitCode.REFUSED, f"{state.name} has changed to {state.mode} at {reached:.1f} m")
        if session.now > until:
            raise VerbError(
                ExitCode.NO_ANSWER, f"{state.name} has not climbed to {height:g} m: it is at {reached:.1f} m"
            )


def _afterwards(session: VerbSession) -> str:
    """Say what follows when this program ends."""
    return (
        ""
        if session.goes_on
        else "; nobody flies it when this verb ends, and its own failsafe lands it or flies it home"
    )
