"""Performs one action of a verb with a session, wherever it runs: for one vehicle, or for all of a group."""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from groundstation.verbs.common.lazy import LazyModule
from groundstation.verbs.common.loading import load
from groundstation.verbs.session.session import VerbSession

if TYPE_CHECKING:
    from groundstation.config.groups import VehicleGroup
    from groundstation.station.driving.proofs import SessionProofs
    from groundstation.verbs.action import VerbAction
    from groundstation.verbs.common.output import Output
    from groundstation.verbs.session.core import VerbCore
    from groundstation.verbs.session.doctor_session import DoctorSession

multi_vehicle, stops = LazyModule("multi_vehicle"), LazyModule("control.stops")
doctor_session = LazyModule("session.doctor_session")

MayProve = Callable[[float], bool]
"""Takes the time; returns whether this program may prove the session of the verb before."""


def build_session(
    action: VerbAction,
    options: argparse.Namespace,
    output: Output,
    endpoints: Sequence[str],
    build_core: Callable[[], VerbCore],
    identity: tuple[tuple[int, int], SessionProofs],
) -> VerbSession | DoctorSession:
    """Return the session of a verb, whose core is not joined to anything yet. `identity`: our ids and session."""
    if action.examines:
        examining: DoctorSession = doctor_session.DoctorSession(*identity, endpoints, options)
        return examining
    session = VerbSession(build_core(), lambda: None, output.progress)
    session.where = " ".join(endpoints)
    return session


async def perform(
    session: VerbSession | DoctorSession,
    action: VerbAction,
    options: argparse.Namespace,
    output: Output,
    group: VehicleGroup | None,
    may_prove: MayProve | None,
    found: Callable[[str], None],
) -> int:
    """Do what the action needs before it runs, and run it; return the exit code. `found` gets the vehicle's name.

    With `may_prove` the verb keeps the session of the verb before.
    """
    if not isinstance(session, VerbSession):
        return await action.run(session, options, output)
    if group is not None:
        return await _perform_for_group(session, action, options, output, group)
    loading = asyncio.ensure_future(load(action.run))  # meanwhile the vehicle answers
    try:
        if action.finds:
            await session.find_vehicle(options.wait, options.vehicle)
        if action.needs_session:
            await session.prove_session()
        if action.shows_neutral:
            await session.show_neutral()
        if may_prove is not None and session.core.chosen is not None:
            _keep(session, may_prove, output)
        if action.finds:
            found(session.vehicle.name)
    finally:
        await loading
    return await action.run(session, options, output)


async def _perform_for_group(
    session: VerbSession, action: VerbAction, options: argparse.Namespace, output: Output, group: VehicleGroup
) -> int:
    sending: asyncio.Future[None] | None = None
    if action.stops:
        systems = group.listed or ((0,) if options.all else ())
        sending = asyncio.ensure_future(stops.stop_unheard(session, output.verb, options, systems))
    try:
        await session.find_vehicle(options.wait, None)
        code: int = await multi_vehicle.ManyVehicles(session, action, options, group, output).run()
        return code
    finally:
        if sending is not None:
            sending.cancel()


def _keep(session: VerbSession, may_prove: MayProve, output: Output) -> None:
    """Prove the session of the verb before, so that the vehicle misses no ground station."""
    contact = session.contact
    contact.operator.may_prove = may_prove
    contact.begin(session.now)

    def tell(_: asyncio.Future[None]) -> None:
        output.note(f"{contact.state.name} is controlled by the verb before; this one keeps its session")

    session.core.add_waiter(lambda: contact.in_control).add_done_callback(tell)
