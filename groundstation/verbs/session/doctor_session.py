"""An OperatorCore with the doctor, for the verbs `doctor` and `motor`: it never drives."""

from __future__ import annotations

import argparse
import asyncio
import time
from collections.abc import Callable, Sequence

from dialects import messages as m
from groundstation.intents.base import Intent
from groundstation.intents.session import RenewLease
from groundstation.intents.vehicle import SelectVehicle
from groundstation.snapshot import Snapshot
from groundstation.station.core_parts import CoreParts
from groundstation.station.doctor_feed import DoctorFeed
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.proofs import SessionProofs
from groundstation.station.operator_core import OperatorCore
from groundstation.station.verbs.running_verbs import Purpose, VerbMessage
from groundstation.verbs.common.arguments import is_chosen
from groundstation.verbs.common.channel import CompanionChannel
from groundstation.verbs.common.files import Files
from groundstation.verbs.session.link_reasons import describe_silence
from groundstation.views.doctor import DoctorRequest, DoctorView

LEASE_PERIOD = 0.1
"""s between renewals of the lease, as of the screen; each also looks whether something has changed."""


PURPOSES: dict[type[m.Message], Purpose] = {
    m.Heartbeat: Purpose.PRESENCE,
    m.RoverOperatorPresence: Purpose.PROOF,
    m.ManualControl: Purpose.NEUTRAL,
}
"""What its core sends these for; it does not drive."""


class DoctorSession:
    """What a verb does with its core. The key gate stays closed: no demand but neutral is ever sent."""

    def __init__(
        self, ids: tuple[int, int], proofs: SessionProofs, endpoints: Sequence[str], options: argparse.Namespace
    ) -> None:
        """`ids` are our system and component id, `proofs` are those of our session; for the vehicle of `options`."""
        parts = CoreParts(endpoints, system=ids[0], component=ids[1], proofs=proofs, now=self._now)
        self._feed = DoctorFeed(parts)
        self.core = OperatorCore(parts, self._feed)
        """For links, or for a seat in a station."""
        self.core.intents.add(self._feed.handlers)
        self.files = Files()
        """The files of whoever typed the verb."""
        self.companion = CompanionChannel()
        """As of a VerbSession."""
        self.program = ""
        """As of a VerbSession, like the next one."""
        self.silence: Callable[[float], float] = lambda now: 0.0
        self.observe: Callable[[], None] = lambda: None
        """Gets the newest reports of links of its own; those of a station come by themselves."""
        self._request = DoctorRequest(station=getattr(options, "driver", 0))
        self.flush: Callable[[], None] = lambda: None
        """Sends the messages of the core."""

    @property
    def station(self) -> OperatorCore:
        """The core, which has vehicles of its own."""
        return self.core

    def speak(self) -> list[VerbMessage]:
        """Return the messages to send now, and remove them: demands of its core are neutral."""
        found = [each.message for each in self.core.messages_to_send()]
        return [VerbMessage(message, PURPOSES.get(type(message), Purpose.OTHER)) for message in found]

    def driven(self) -> tuple[WatchdogTarget, ...]:
        """Return nothing: it never drives."""
        return ()

    def do(self, *intents: Intent) -> None:
        """Carry out intents now."""
        for intent in intents:
            self.core.handle_intent(intent, self._now)
        self.flush()

    @property
    def snapshot(self) -> Snapshot:
        """The state now."""
        return self._feed.snapshot(self._now, time.time())

    @property
    def doctor(self) -> DoctorView:
        """The chain now."""
        return self._feed.doctor.build(self._request, self._now, time.time())

    async def until(self, condition: Callable[[], bool], within: float) -> bool:
        """Wait until a condition holds, `within` s at most, and renew the lease meanwhile; return whether it does."""
        end = self._now + within
        while True:
            self.do(RenewLease())
            if condition() or self._now >= end:
                return condition()
            await asyncio.sleep(LEASE_PERIOD)

    async def find_vehicle(self, wait: float, wanted: int | str | None) -> bool:
        """Wait for a vehicle and select it; return whether it is there."""
        found = await self.until(lambda: self._find(wanted) is not None, wait)
        system = self._find(wanted)
        if found and wanted is not None and system is not None:
            self.do(SelectVehicle(system))
        return found

    def describe_links(self) -> str:
        """Return why no vehicle is heard, behind ": "; "" if nothing is known."""
        self.observe()
        return describe_silence(self.snapshot.links)

    def _find(self, wanted: int | str | None) -> int | None:
        states = (contact.state for contact in self.core.fleet)
        return next((each.system for each in states if is_chosen(wanted, each.system, each.fleet_name)), None)

    @property
    def _now(self) -> float:
        return asyncio.get_running_loop().time()
