"""`groundstation disarm`, `stop` and `estop`: repeated until the vehicle reports that it is so. They need no control.

Without --vehicle they go to every vehicle that is heard: a stop must not fail because there are two.
"""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Awaitable, Callable

from dialects.enums import Command
from groundstation.station.arming import CONFIRM_WITHIN
from groundstation.station.emergency import DANGEROUS, EmergencyLock
from groundstation.vehicles.requests import RequestReport, RequestState
from groundstation.verbs.arguments import is_chosen
from groundstation.verbs.contact import Job, VehicleContact
from groundstation.verbs.core import ALONE_AFTER
from groundstation.verbs.exit_codes import ExitCode
from groundstation.verbs.output import Output
from groundstation.verbs.reports import finish
from groundstation.verbs.session import VerbSession
from groundstation.verbs.stop_jobs import EmergencyJob, disarm_job, hold_job

REPEAT_FOR = 30.0
"""s for which a stop is repeated, unless --timeout says otherwise: a radio link may be cut for some seconds."""

BuildJob = Callable[[int, VehicleContact, float, float], Job]
"""Takes the number of the request, the vehicle, the time, and until when to repeat."""
Run = Callable[[VerbSession, argparse.Namespace, Output], Awaitable[int]]


def _stop_all(what: str, done: str, build: BuildJob) -> Run:
    """Return the action that stops all vehicles that are heard, or the one of --vehicle."""

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        within = options.timeout or REPEAT_FOR
        codes: dict[int, asyncio.Task[int]] = {}
        while True:
            for each in session.of_others():
                system = each.vehicle.system
                if system not in codes and is_chosen(options.vehicle, system, each.vehicle.fleet_name):
                    codes[system] = asyncio.ensure_future(_stop(each, within, output))
            known = len(session.core.contacts)
            if options.vehicle or not await session.look_for(
                _more_than(session, known), 0.0 if session.core.has_heard_all else ALONE_AFTER
            ):
                break
        return _join(await asyncio.gather(*codes.values()))

    async def _stop(session: VerbSession, within: float, output: Output) -> int:
        report = await run_job(session, what, lambda number, now: build(number, session.contact, now, now + within))
        return finish(session, report, output, done)

    return run


def _more_than(session: VerbSession, known: int) -> Callable[[], bool]:
    return lambda: len(session.core.contacts) > known


def _join(codes: list[int]) -> int:
    """Return the code of all vehicles together."""
    if len(set(codes)) == 1:
        return codes[0]
    return ExitCode.PARTLY if ExitCode.DONE in codes else max(codes)


async def run_job(session: VerbSession, what: str, build: Callable[[int, float], Job]) -> RequestReport:
    """Run a job as a request."""
    contact = session.contact

    def start(number: int, now: float) -> None:
        if contact.services.book.begin(number, what):
            contact.start(build(number, now), now)

    return await session.request(start)


disarm = _stop_all(
    "disarm", "is disarmed", lambda number, contact, now, until: disarm_job(number, contact.state, until)
)
stop = _stop_all(
    "stop", "holds", lambda number, contact, now, until: hold_job(number, contact.state, contact.services, until)
)
_emergency_stop = _stop_all(
    "emergency stop",
    "has stopped",
    lambda number, contact, now, until: EmergencyJob(number, EmergencyLock(contact.state, now), until),
)


async def estop(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Stop the motors and lock them, or release the lock with --clear."""
    if not options.clear:
        return await _emergency_stop(session, options, output)
    await session.need_only_vehicle(options.vehicle)
    await session.take_part()
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(
            number, Command.DO_SET_SAFETY_SWITCH_STATE, (DANGEROUS,), "release the emergency stop", now
        )
    )
    is_clear = await session.wait_for(lambda: not session.vehicle.emergency_stop, CONFIRM_WITHIN)
    if report.state is RequestState.ACCEPTED and not is_clear:
        output.error(f"{session.vehicle.name}: accepted, but it still reports the emergency stop")
        output.result(False, session.vehicle.system, detail="accepted, but it still reports the emergency stop")
        return ExitCode.REFUSED
    return finish(session, report, output, "has released the emergency stop")
