"""`mavhelm send`: send any message, once or at a rate. A demand begins and ends with neutral.

Neutral is also sent when the verb is interrupted by a signal. When the process is killed or stands still, its watchdog
sends it (demand_guard.py), or the station in which the verb runs (station/verbs/running_verbs.py).
"""

from __future__ import annotations

import argparse
import asyncio
import math
from collections.abc import Callable

from dialects import messages as m
from dialects.traits import SECRET
from groundstation.station.driving.operator import NEUTRAL_LEAD
from groundstation.vehicles.demand.demand_neutrals import DEMANDS
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.messages.demands import build_demand, check_demand
from groundstation.verbs.messages.message_builder import build, parse_fields
from groundstation.verbs.messages.message_values import find_message
from groundstation.verbs.session.reports import need_driven
from groundstation.verbs.session.session import VerbSession

TARGETS = {"target": 0, "target_system": 0, "target_component": 1}
"""Fields that name the vehicle, and which of its ids they are."""


def check(options: argparse.Namespace) -> None:
    """Find the message and read its fields. Raises VerbError."""
    options.kind = find_message(options.name)
    if options.kind.id in SECRET:
        raise VerbError(ExitCode.USAGE, "every user can read the command line: use `mavhelm sign setup` for a key")
    options.values = parse_fields(options.kind, options.fields)
    check_demand(options.kind, options.values, confirmed=options.yes)
    if (options.rate is None) != (options.seconds is None):
        raise VerbError(ExitCode.USAGE, "--rate and --for go together")
    build(options.kind, options.values)


def is_demand(options: argparse.Namespace) -> bool:
    """Return whether the message is a demand."""
    return options.kind in DEMANDS


async def run(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Send the message."""
    await session.need_only_vehicle(options.vehicle)
    for name, index in TARGETS.items():
        if name in options.kind.fieldnames:
            options.values.setdefault(name, (session.vehicle.system, session.vehicle.component)[index])
    if is_demand(options):
        need_driven(session.vehicle)
        _warn_of_no_effect(session, output)
        count = await _send_demand(session, options)
        ending = ", then neutral"
    else:
        message, ending = build(options.kind, options.values), ""
        count = await _repeat(session, lambda now: session.core.send(message), options.rate, options.seconds)
        session.need_sent()
    name = options.kind.msgname
    output.note(f"{name} sent {'once' if count == 1 else f'{count} times'} to {session.vehicle.name}{ending}")
    output.result(True, session.vehicle.system, name=name, count=count)
    return ExitCode.DONE


def _warn_of_no_effect(session: VerbSession, output: Output) -> None:
    state = session.vehicle
    if not state.armed:
        output.note(f"{state.name} is disarmed, and ignores demands")
    elif state.mode in state.model.standing:
        output.note(f"{state.name} ignores demands in {state.mode}")


async def _send_demand(session: VerbSession, options: argparse.Namespace) -> int:
    """Send neutral, the demand, and neutral in any case."""
    await session.prove_session()
    contact, state = session.contact, session.vehicle
    if contact.other_driver is not None and not contact.state.control.silent:
        raise VerbError(ExitCode.NOT_IN_CONTROL, f"GCS {contact.other_driver} is in control of {state.name}")
    neutrals = DEMANDS[options.kind]
    demand = build_demand(options.kind, options.values, neutrals(state, options.values, session.now)[0])
    demand = demand or build(options.kind, options.values)
    try:
        first, *more = neutrals(state, options.values, session.now)
        lead = _sender(session, first, moves=bool(more))
        await _repeat(session, lead, 1 / DRIVING_PERIOD, NEUTRAL_LEAD)
        driving = _until_standstill(session, _sender(session, demand, moves=True))
        return await _repeat(session, driving, options.rate, options.seconds)
    finally:
        ends = neutrals(state, options.values, session.now)
        for message in ends:
            ending = _sender(session, message, moves=message is not ends[-1])
            await _repeat(session, ending, 1 / DRIVING_PERIOD, FINAL_NEUTRALS * DRIVING_PERIOD)


def _sender(session: VerbSession, message: m.Message, *, moves: bool) -> Callable[[float], None]:
    """Return what sends a demand: to our vehicle inside the proof of the session. `moves`: a neutral must follow it."""
    if isinstance(message, m.ManualControl):
        demand = message
        return lambda now: session.contact.operator.send_demand(demand, now, moves=moves)
    return lambda now: session.core.demand(message, moves=moves)


def _until_standstill(session: VerbSession, send: Callable[[float], None]) -> Callable[[float], None]:
    """Return what sends unless this process stood still: the vehicle has stopped, and must not drive on.

    It raises VerbError then.
    """

    def send_checked(now: float) -> None:
        stood = session.core.standstill.last(now)
        if stood is not None:
            raise VerbError(ExitCode.BROKEN, f"this program stood still for {stood:.1f} s: the demand has ended")
        send(now)

    return send_checked


async def _repeat(
    session: VerbSession, send: Callable[[float], None], rate: float | None, seconds: float | None
) -> int:
    """Send once, or at a rate for some time; return how often."""
    period = 1 / rate if rate else math.inf
    due = session.now
    end = due + (seconds or 0.0)
    count = 0
    while True:
        now = session.now
        send(now)
        session.flush()
        count, due = count + 1, max(due + period, now)
        await asyncio.sleep(max(0.0, min(due, end) - session.now))
        if due >= end:
            return count
