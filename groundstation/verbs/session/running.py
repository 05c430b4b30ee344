"""Runs a verb in its own process, over links that it opens, and ends it in order."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from typing import TYPE_CHECKING

from groundstation.vehicles.state.places import PLACES
from groundstation.verbs.session.station_seat import END_WITHIN
from link.core import Core
from link.endpoint import Side
from link.links import open_links
from link.protocol.log_tap import LogTap
from link.runner import Runner
from link.transport.transport import PortInUseError

if TYPE_CHECKING:
    from groundstation.station.driving.driven import WatchdogTarget
    from groundstation.verbs.session.demand_guard import DemandGuard
    from link.link_signing import LinkSigning

PERIOD = 0.02
"""s between two ticks: twice the shortest round trip of a radio."""
PORT_WITHIN = 2.0
"""s to wait for a port in use: the watchdog of a program that was killed has it for 1.3 s, to disarm."""
RETRY_PERIOD = 0.1


async def run_when_port_free(run: Callable[[], Awaitable[int]]) -> int:
    """Run a verb over links of its own; try again for PORT_WITHIN s while one of its ports is in use.

    Raises what `run` raises, PortInUseError too.
    """
    loop = asyncio.get_running_loop()
    until = loop.time() + PORT_WITHIN
    while True:
        try:
            return await run()
        except PortInUseError:
            if loop.time() > until:
                raise
        await asyncio.sleep(RETRY_PERIOD)


async def run_over(
    endpoints: Sequence[str],
    core: Core,
    script: Callable[[Runner], Awaitable[int]],
    *,
    ids: tuple[int, int],
    signing: LinkSigning | None = None,
    log_tap: LogTap | None = None,
    guard: DemandGuard | None = None,
    driven: Callable[[], Sequence[WatchdogTarget]] = tuple,
) -> int:
    """Open links and run the script with a core; return its exit code. Raises EndpointError, LinkError, VerbError.

    `ids` are our system and component id; `driven` returns what the guard must know. A script that is interrupted gets
    END_WITHIN to end in order, over links that still work.
    """
    links = open_links(endpoints, system=ids[0], component=ids[1], side=Side.GROUND_STATION, places=PLACES)
    sent = guard.record_sent if guard is not None else None
    runner = Runner(core, links, period=PERIOD, route=False, log_tap=log_tap, sent=sent, signing=signing)
    running = [asyncio.ensure_future(runner.run())]
    await asyncio.sleep(0)  # run() begins
    if guard is not None:
        running.append(asyncio.ensure_future(guard.run(driven)))
    verb = asyncio.ensure_future(script(runner))
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
