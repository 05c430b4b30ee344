"""An OperatorCore with the doctor, for the verbs `doctor` and `motor`: it never drives."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable

from groundstation.intents.base import Intent
from groundstation.intents.session import RenewLease
from groundstation.intents.vehicle import SelectVehicle
from groundstation.snapshot import Snapshot
from groundstation.station.core_parts import CoreParts
from groundstation.station.doctor_feed import DoctorFeed
from groundstation.station.operator_core import OperatorCore
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.session.core import Waiters
from groundstation.verbs.session.link_reasons import describe_silence
from groundstation.verbs.session.running import VerbLinks, run_beside
from groundstation.verbs.session.station_link import StationRunner
from groundstation.views.doctor import DoctorRequest, DoctorView
from link.runner import Runner

LEASE_PERIOD = 0.1
"""s between renewals of the lease, as of the screen; each also looks whether something has changed."""


class DoctorSession:
    """What a verb does with its core. The key gate stays closed: no demand but neutral is ever sent."""

    def __init__(
        self, core: OperatorCore, feed: DoctorFeed, request: DoctorRequest, runner: Runner | StationRunner
    ) -> None:
        self._core, self._feed, self._request, self._runner = core, feed, request, runner
        self._numbers = 0
        self._waiters = Waiters()

    def take_number(self) -> int:
        """Return the number of the next request."""
        self._numbers += 1
        return self._numbers

    def do(self, *intents: Intent) -> None:
        """Carry out intents now."""
        for intent in intents:
            self._core.handle_intent(intent, self._now)
        self._runner.flush()

    @property
    def snapshot(self) -> Snapshot:
        """The state now."""
        return self._feed.snapshot(self._now, time.time())

    @property
    def doctor(self) -> DoctorView:
        """The chain now."""
        return self._feed.doctor.build(self._request, self._now, time.time())

    async def until(self, condition: Callable[[], bool], within: float) -> bool:
        """Wait until a condition holds, `within` s at most; return whether it does."""
        found = self._waiters.add(condition)
        self.look()
        try:
            async with asyncio.timeout(within):
                await found
        except TimeoutError:
            return False
        return True

    def look(self) -> None:
        """Check what the verb waits for."""
        self._waiters.check()

    async def find_vehicle(self, wait: float, wanted: int | str | None) -> bool:
        """Wait for a vehicle and select it; return whether it is there."""
        found = await self.until(lambda: self._find(wanted) is not None, wait)
        system = self._find(wanted)
        if found and wanted is not None and system is not None:
            self.do(SelectVehicle(system))
        return found

    def describe_links(self) -> str:
        """Return why no vehicle is heard, behind ": "; "" if nothing is known."""
        self._runner.observe()
        return describe_silence(self.snapshot.links)

    def _find(self, wanted: int | str | None) -> int | None:
        states = (contact.state for contact in self._core.fleet)
        return next((each.system for each in states if is_chosen(wanted, each.system, each.fleet_name)), None)

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()


async def run_doctor(links: VerbLinks, driver: int, script: Callable[[DoctorSession], Awaitable[int]]) -> int:
    """Run the script, and return its exit code. `driver` is the system id of the ground station that will drive.

    0 is this one. Raises EndpointError, LinkError, VerbError.
    """
    system, component = links.ids
    now = asyncio.get_running_loop().time()
    parts = CoreParts(links.endpoints, system=system, component=component, session=links.session, now=now)
    feed = DoctorFeed(parts)
    core = OperatorCore(parts, feed)
    core.intents.add(feed.handlers)
    runner = links.open(core)
    session = DoctorSession(core, feed, DoctorRequest(station=driver), runner)
    return await run_beside(runner, lambda: script(session), _renew(core, session))


async def _renew(core: OperatorCore, session: DoctorSession) -> None:
    while True:
        core.handle_intent(RenewLease(), asyncio.get_running_loop().time())
        session.look()
        await asyncio.sleep(LEASE_PERIOD)
