"""Performs one action of a verb with a session: for one vehicle, or for all of a group."""

from __future__ import annotations

import argparse
import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING

from groundstation.verbs.common.lazy import LazyModule

if TYPE_CHECKING:
    from groundstation.config.groups import VehicleGroup
    from groundstation.verbs.action import VerbAction
    from groundstation.verbs.common.output import Output
    from groundstation.verbs.session.kept_session import KeptSession
    from groundstation.verbs.session.session import VerbSession

multi_vehicle, stops = LazyModule("multi_vehicle"), LazyModule("control.stops")


async def perform(
    session: VerbSession,
    action: VerbAction,
    options: argparse.Namespace,
    output: Output,
    group: VehicleGroup | None,
    kept: KeptSession,
    found: Callable[[str], None],
) -> int:
    """Do what the action needs before it runs, and run it; return the exit code. `found` gets the vehicle's name."""
    if group is not None:
        return await _perform_for_group(session, action, options, output, group)
    if action.finds:
        await session.find_vehicle(options.wait, options.vehicle, session.where)
    if action.takes_part:
        await session.prove_session()
    if action.shows_neutral:
        await session.show_neutral()
    _keep(session, kept, output)
    if action.finds:
        found(session.vehicle.name)
    return await action.run(session, options, output)


async def _perform_for_group(
    session: VerbSession, action: VerbAction, options: argparse.Namespace, output: Output, group: VehicleGroup
) -> int:
    sending: asyncio.Future[None] | None = None
    if action.stops:
        systems = group.listed or ((0,) if options.all else ())
        sending = asyncio.ensure_future(stops.stop_unheard(session, output.verb, systems))
    try:
        await session.find_vehicle(options.wait, None, session.where)
        code: int = await multi_vehicle.ManyVehicles(session, action, options, group, output).run()
        return code
    finally:
        if sending is not None:
            sending.cancel()


def _keep(session: VerbSession, kept: KeptSession, output: Output) -> None:
    """Prove the session of the verb before if this one follows it, so that the vehicle misses no ground station."""
    if not kept.follows or session.core.chosen is None:
        return
    contact = session.contact
    contact.operator.may_prove = kept.may_prove
    contact.operator.begin(session.now)

    def tell(_: asyncio.Future[None]) -> None:
        output.note(f"{contact.state.name} is controlled by the verb before; this one keeps its session")

    session.core.add_waiter(lambda: contact.in_control).add_done_callback(tell)
