"""`mavhelm ping`: round trips to a vehicle by TIMESYNC."""

from __future__ import annotations

import argparse
import asyncio
from statistics import fmean

from groundstation.verbs.common.exit_codes import ExitCode, VerbError
from groundstation.verbs.common.output import Output
from groundstation.verbs.session.session import VerbSession
from link.core import Received
from link.services.timesync import TimesyncClient

ANSWER_WITHIN = 2.0
"""s after which a round trip counts as lost."""


async def ping(session: VerbSession, options: argparse.Namespace, output: Output) -> int:
    """Measure round trips, one after the other, and print them."""
    trips: list[float] = []
    for number in range(1, options.count + 1):
        began = session.now
        trip = await _measure(session, options.system)
        words = "no answer" if trip is None else f"{1000 * trip:.1f} ms"
        output.line(f"{session.vehicle.name} {number}/{options.count}: {words}")
        output.record(vehicle=session.vehicle.system, number=number, round_trip=trip)
        output.flush()
        trips += [] if trip is None else [trip]
        if number < options.count:
            await asyncio.sleep(max(0.0, options.interval - (session.now - began)))
    if not trips:
        raise VerbError(ExitCode.NO_ANSWER, f"{session.vehicle.name}: no answer to {options.count} TIMESYNC")
    low, mean, high = (1000 * each for each in (min(trips), fmean(trips), max(trips)))
    lost = options.count - len(trips)
    output.note(f"{len(trips)} of {options.count} answered; {low:.1f} / {mean:.1f} / {high:.1f} ms least, mean, most")
    return ExitCode.PARTLY if lost else ExitCode.DONE


async def _measure(session: VerbSession, system: int) -> float | None:
    """Return the round trip of one request, or None."""
    client = TimesyncClient(system)

    def tap(received: Received, now: float) -> None:
        if received.system == session.vehicle.system:
            client.receive(received, now)

    session.core.taps.append(tap)
    client.tick(session.now)
    session.core.outbox.commands += client.messages_to_send()
    session.flush()
    try:
        await session.wait_for(lambda: client.round_trip is not None, ANSWER_WITHIN)
    finally:
        session.core.taps.remove(tap)
    return client.round_trip
