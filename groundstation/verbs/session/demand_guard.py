"""The watchdog of a verb that sends demands: it sends neutral when the verb's process is killed or stands still."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable, Sequence

from dialects.messages import Message
from groundstation.station.driving.driven import WatchdogTarget
from groundstation.station.driving.stall import Standstill
from groundstation.watchdog.feed import WatchdogFeed
from link.signing.signing import Signing
from link.transport.transport import Link

REPORT_PERIOD = 0.1
"""s between two reports, as of the station; after 0.3 s without one the watchdog sends neutral."""


class DemandGuard:
    """The watchdog process (groundstation/watchdog/). Start it before any link is open."""

    def __init__(self, ids: tuple[int, int], signing: Signing | None = None) -> None:
        """Start the process, which signs as this one does. Raises OSError."""
        self._feed = WatchdogFeed.start(None, None, ids, signing)
        self.standstill = Standstill()
        """After one the watchdog may have sent neutral, and no demand may follow."""

    def record_sent(self, link: Link, address: Hashable, message: Message, sequence: int, now: float) -> None:
        """Record a frame that was sent."""
        self._feed.record_sent(link, address, message, sequence, now)

    async def run(self, driven: Callable[[], Sequence[WatchdogTarget]]) -> None:
        """Report what is driven until cancelled."""
        loop = asyncio.get_running_loop()
        while True:
            now = loop.time()
            self.standstill.record_report(now)
            self._feed.report(driven(), now)
            await asyncio.sleep(REPORT_PERIOD)

    def close(self) -> None:
        """End the process: the last demands were neutral."""
        self._feed.close()
