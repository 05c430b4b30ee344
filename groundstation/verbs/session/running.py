"""Runs a verb in its own process: over links that it opens, or through a station, and ends it in order."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Coroutine, Sequence
from typing import TYPE_CHECKING

import msgspec

from groundstation.vehicles.state.places import PLACES
from groundstation.verbs.client.station_choice import StationLink
from groundstation.verbs.session.core import OwnCore
from groundstation.verbs.session.station_link import StationRunner
from link.core import Core
from link.protocol.log_tap import LogTap

if TYPE_CHECKING:
    from groundstation.verbs.session.demand_guard import DemandGuard
    from link.link_signing import LinkSigning
    from link.runner import Runner

PERIOD = 0.02
"""s between two ticks: twice the shortest round trip of a radio."""
END_WITHIN = 1.0
"""s for an interrupted verb to send its last messages: final neutrals take 0.25 s."""


class VerbLinks(msgspec.Struct, frozen=True):
    """How a verb reaches its vehicle."""

    endpoints: Sequence[str]
    ids: tuple[int, int]
    """Our system and component id."""
    session: int
    """Number of our session."""
    station: StationLink | None = None
    """Then there are no links: the verb goes through it."""
    patience: float = math.inf
    """s without an answer after which the station is lost."""
    signing: LinkSigning | None = None
    log_tap: LogTap | None = None
    guard: DemandGuard | None = None

    def open(self, core: Core) -> Runner | StationRunner:
        """Open the links, or take the station. Raises EndpointError, LinkError."""
        if self.station is not None:
            return StationRunner(core, self.station, PERIOD, self.log_tap, self.patience)
        from link.endpoint import Side
        from link.links import open_links
        from link.runner import Runner  # a verb through a station does without

        system, component = self.ids
        opened = open_links(self.endpoints, system=system, component=component, side=Side.GROUND_STATION, places=PLACES)
        sent = self.guard.record_sent if self.guard else None
        return Runner(core, opened, period=PERIOD, route=False, log_tap=self.log_tap, sent=sent, signing=self.signing)


async def run_over(links: VerbLinks, core: Core, script: Callable[[Runner | StationRunner], Awaitable[int]]) -> int:
    """Run the script with a core, and return its exit code. Raises EndpointError, LinkError, VerbError."""
    runner = links.open(core)
    reporting = []
    if links.guard is not None and isinstance(core, OwnCore):
        core.standstill = links.guard.standstill
        reporting.append(links.guard.run(core.driven))
    return await run_beside(runner, lambda: script(runner), *reporting)


async def run_beside(
    runner: Runner | StationRunner, script: Callable[[], Awaitable[int]], *beside: Coroutine[None, None, None]
) -> int:
    """Run the script while the runner and the others run; return its exit code. Raises what any of them raises.

    A script that is interrupted gets END_WITHIN to end in order, over links that still work.
    """
    running = [asyncio.ensure_future(runner.run())]
    await asyncio.sleep(0)  # run() begins
    running += [asyncio.ensure_future(each) for each in beside]
    verb = asyncio.ensure_future(script())
    try:
        await asyncio.wait({*running, verb}, return_when=asyncio.FIRST_COMPLETED)
        for each in running:
            if each.done():
                each.result()
        return await verb
    finally:
        if verb.cancel():
            await asyncio.wait({verb}, timeout=END_WITHIN)
        for each in running[1:]:
            each.cancel()
        runner.stop()
        await running[0]
