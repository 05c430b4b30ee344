"""`mavhelm disarm`, `stop` and `estop`: repeated until the vehicle reports that it is so. They need no control.

Without --vehicle they go to every vehicle: a stop must not fail because there are two. They are sent from the first
moment, also to a vehicle that is not heard, which may have no place for us (vehicles/demand/blind_stop.py).
"""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Awaitable, Callable, Coroutine, Iterable

from dialects import messages as m
from dialects.enums import Command
from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.vehicles.demand.blind_stop import BlindStop
from groundstation.vehicles.demand.repeated_stop import StopTimes
from groundstation.vehicles.demand.stop_commands import DANGEROUS, STOP_VERBS, StopKind
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.requests.requests import RequestReport, RequestState
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.common.exit_codes import ExitCode
from groundstation.verbs.common.output import Output
from groundstation.verbs.control.stop_jobs import cut_job, disarm_job, emergency_job, hold_job
from groundstation.verbs.session.contact import Job
from groundstation.verbs.session.reports import finish
from groundstation.verbs.session.session import VerbSession

REPEAT_FOR = 30.0
"""s for which a stop is repeated, unless --timeout says otherwise: a radio link may be cut for some seconds."""
LOOK_PERIOD = 0.05
"""s between looks whether a blind stop is due, which it is every 0.25 s."""

BuildJob = Callable[[int, VehicleState, StopTimes], Job]
"""Takes the number of the request, the vehicle, and the times of the stop."""
Run = Callable[[VerbSession, argparse.Namespace, Output], Awaitable[int]]


def _stop_all(kind: StopKind, done: str, build: BuildJob) -> Run:
    """Return the action that stops all vehicles that are heard, or the one of --vehicle.

    It sends at once, to vehicles that are not heard as well.
    """

    async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
        within = options.timeout or REPEAT_FOR
        known = session.known
        blind = None if known or isinstance(options.vehicle, str) else _begin_blind(session, kind, options.vehicle)
        sending = asyncio.ensure_future(_send_blind(session, blind, options.vehicle)) if blind else None
        codes: dict[int, asyncio.Task[int]] = {}
        try:
            while await _begin(session, options, codes, lambda each: _stop(each, within, output)):
                pass
            return _join(await asyncio.gather(*codes.values())) if codes else _tell_unheard(session, blind, output)
        finally:
            if sending is not None:
                sending.cancel()

    async def _stop(session: VerbSession, within: float, output: Output) -> int:
        state, sure = session.vehicle, session.sure_at
        report = await run_job(
            session, kind.value, lambda number, now: build(number, state, StopTimes(now, sure, now + within))
        )
        return finish(session, report, output, done)

    return run


async def _begin(
    session: VerbSession,
    options: argparse.Namespace,
    codes: dict[int, asyncio.Task[int]],
    stop: Callable[[VerbSession], Coroutine[None, None, int]],
) -> bool:
    """Stop the vehicles that were heard since the last call; return whether to wait for more of them."""
    chosen = [each for each in session.of_others() if is_chosen(options.vehicle, *each.names)]
    for each in chosen:
        if each.vehicle.system not in codes:
            codes[each.vehicle.system] = asyncio.ensure_future(stop(each))
    if codes and options.vehicle:
        return False
    count = len(session.core.contacts)
    if codes:
        more = session.next_within()
    else:
        more = max(0.0, session.began + min(options.wait, options.timeout or REPEAT_FOR) - session.now)
    return await session.wait_until_true(lambda: len(session.core.contacts) > count, more)


def _begin_blind(session: VerbSession, kind: StopKind, vehicle: int | None) -> BlindStop:
    blind = BlindStop(kind, vehicle or 0, session.core.ids, session.now)
    session.core.taps.append(lambda received, now: blind.receive(received))
    return blind


async def _send_blind(session: VerbSession, blind: BlindStop, vehicle: int | None) -> None:
    """Send the stop to vehicles that are not heard, until this is cancelled or the one that is meant is heard."""
    while vehicle is None or vehicle not in session.core.contacts:
        session.core.send(*blind.tick(session.now, heard=bool(session.core.contacts)))
        session.flush()
        await asyncio.sleep(LOOK_PERIOD)


async def stop_unheard(session: VerbSession, verb: str, options: argparse.Namespace, systems: Iterable[int]) -> None:
    """Send the stop of --all (system 0) or --group to vehicles that are not heard, until this is cancelled."""
    kind = StopKind.CUT if verb == "estop" and options.cut else STOP_VERBS[verb]
    blind = [_begin_blind(session, kind, system) for system in systems]
    await asyncio.gather(*(_send_blind(session, each, each.system or None) for each in blind))


def _tell_unheard(session: VerbSession, blind: BlindStop | None, output: Output) -> int:
    """Say what is known of a stop of which no vehicle was heard; return the exit code."""
    wait = session.now - session.began
    heard = ", ".join(str(system) for system in sorted(session.core.contacts))
    text = f"no such vehicle on {session.where} within {wait:.0f} s" + (f", but {heard}" if heard else "")
    if blind is not None:
        why = session.describe_links()
        silent = not session.core.frames_sent and not session.core.has_heard_all
        nobody = "; nobody was heard there, so there is no address to send to" if silent else f"; {blind.describe()}"
        text = f"no heartbeat of a vehicle on {session.where} within {wait:.0f} s{why}{nobody}"
    output.error(text)
    output.result(False, blind.system if blind else 0, detail=text)
    return ExitCode.NO_ANSWER if blind is not None and blind.answers else ExitCode.NO_VEHICLE


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
    STOP_VERBS["disarm"],
    "is disarmed",
    disarm_job,
)
stop = _stop_all(STOP_VERBS["stop"], "holds", hold_job)
_emergency_stop = _stop_all(
    STOP_VERBS["estop"],
    "has stopped",
    emergency_job,
)
_cut = _stop_all(
    StopKind.CUT,
    "has stopped",
    cut_job,
)


async def estop(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Stop the motors and lock them, or release the lock with --clear. What flies lands, or falls with --cut."""
    if options.cut:
        return await _cut(session, options, output)
    if not options.clear:
        return await _emergency_stop(session, options, output)
    await session.find_vehicle(options.wait, options.vehicle)
    await session.need_only_vehicle(options.vehicle)
    await session.prove_session()
    commands = session.services.commands
    report = await session.request(
        lambda number, now: commands.send(
            number, Command.DO_SET_SAFETY_SWITCH_STATE, (DANGEROUS,), "release the emergency stop", now
        )
    )
    if report.state is not RequestState.ACCEPTED:
        return finish(session, report, output, "")
    if session.vehicle.autopilot in FOREIGN_AUTOPILOTS:
        return finish(session, report, output, "has accepted the release; it does not report whether it is locked")
    if doubt := await _wait_for_release(session):
        output.error(f"{session.vehicle.name}: accepted, but {doubt}")
        output.result(False, session.vehicle.system, detail=f"accepted, but {doubt}")
        return ExitCode.REFUSED
    return finish(session, report, output, "has released the emergency stop")


async def _wait_for_release(session: VerbSession) -> str:
    """Wait until each sender of its id has reported that it is not locked; return who has not, "" if all have."""
    state, accepted_at = session.vehicle, session.now

    def find_doubt() -> str:
        if session.heard_at(m.Heartbeat) <= accepted_at:
            return "no heartbeat has come since then"
        doubt = state.senders.find_doubt(session.now, lambda sender: not sender.locked)
        return doubt or ("it still reports the emergency stop" if state.emergency_stop else "")

    await session.wait_for(lambda: not find_doubt(), CONFIRM_WITHIN)
    return find_doubt()
