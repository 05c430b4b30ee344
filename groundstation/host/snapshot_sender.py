"""SlotTimer and SnapshotSender: when a station has its turns for screens, and what it sends to them.

SnapshotSender builds the snapshots of a station when they are due, counts them, and sends them to its screens.
"""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable

import msgspec

from groundstation.host.screens import ScreenSet
from groundstation.host.snapshot_pace import SLOT, SnapshotPace
from groundstation.snapshot import Snapshot
from groundstation.station.process.crash_neutral import crash_snapshot
from groundstation.station.process.lasting_alerts import LastingAlerts
from groundstation.station.station import Station
from link.runtime.multiples import next_multiple
from link.transport.local_addresses import LocalAddresses

log = logging.getLogger(__name__)


class SlotTimer:
    """Calls `work` with the time, in slots that all programs of this machine share (next_multiple).

    `choose_period` is called after it and returns the s between slots.
    """

    def __init__(self, work: Callable[[float], None], choose_period: Callable[[float], float]) -> None:
        self._work, self._choose_period = work, choose_period
        self._next: asyncio.Handle | None = None
        self._period = SLOT
        self._called_at = 0.0
        self._ended = False

    def start(self) -> None:
        """Begin at the next turn of the loop, which runs."""
        self._next = asyncio.get_running_loop().call_soon(self._run)

    def end(self) -> None:
        """Call `work` no more; also `resume_full_rate` has no effect from now on."""
        self._ended = True
        if self._next is not None:
            self._next.cancel()

    def resume_full_rate(self) -> None:
        """Schedule the next slot at the full rate; end an idle period at once."""
        if self._next is not None and self._period > SLOT and not self._ended:
            self._next.cancel()
            self._period = SLOT
            self._next = asyncio.get_running_loop().call_at(self._called_at + SLOT, self._run)

    def _run(self) -> None:
        if self._ended:
            return
        loop = asyncio.get_running_loop()
        self._called_at = loop.time()
        self._work(self._called_at)  # an exception ends the station: no slot follows
        now = loop.time()
        self._period = self._choose_period(now)
        self._next = loop.call_at(next_multiple(self._period, now), self._run)


class SnapshotSender:
    """Alerts of a snapshot that last go to the log file, too."""

    def __init__(self, station: Station, screens: ScreenSet) -> None:
        self._station = station
        self._screens = screens
        self.pace = SnapshotPace()
        self._last = Snapshot()
        self._addresses = LocalAddresses()
        self._lasting_alerts = LastingAlerts()

    def send_due(self, now: float) -> None:
        """Send what the screens do not have yet: a snapshot, if one is due, and the views that have changed."""
        if self.pace.is_due(now, rests=self._station.rests, urgent_state=self._station.urgent_state(now)):
            self.send(now)
        self._screens.send_views(now)

    def call_period(self, now: float) -> float:
        """Return the s until the next call of `send_due`."""
        return self.pace.call_period(now, rests=self._station.rests)

    def send(self, now: float) -> None:
        """Send a snapshot."""
        self._station.station_info.addresses = self._addresses.find(now)
        wall = time.time() - (asyncio.get_running_loop().time() - now)  # of the same moment as `now`
        shown = self._station.snapshot(now, wall)
        self._last = msgspec.structs.replace(shown, number=self._last.number + 1)
        for text in self._lasting_alerts.new_in(self._last):
            log.warning(text)
        self._screens.show(self._last, now)

    def send_crash(self, what: str, now: float) -> None:
        """Send the last snapshot again, with the reason why no other follows."""
        self._screens.show(crash_snapshot(self._last, what, time.time()), now)
