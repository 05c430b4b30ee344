"""A real station with a simulated rover behind the screen, in virtual time: what keys do to wheels."""

from __future__ import annotations

import socket

from groundstation.intents.session import RenewLease
from groundstation.intents.union import AnyIntent
from groundstation.snapshot import Snapshot, StationOutage
from groundstation.views.base import View
from tests.test_stops import Drive


class LiveStation:
    """The connection of a screen to `drive`. Its time passes in `run` only."""

    def __init__(self, drive: Drive) -> None:
        self.drive = drive
        self.intents: list[AnyIntent] = []
        self.alive = self.open = True
        self.outage = StationOutage()
        self._views: list[View] = []
        self._ours, self._theirs = socket.socketpair()
        self._ours.setblocking(False)

    def send(self, *intents: AnyIntent) -> None:
        """Let the station handle them at once."""
        self.intents += [each for each in intents if not isinstance(each, RenewLease)]
        self.drive.tell(*intents)

    def run(self, seconds: float) -> None:
        """Let time pass, and offer a picture."""
        self.drive.run(seconds)
        self.drive.station.views.send_due(self._take, self.drive.world.now, 0.0)
        self._theirs.send(b".")

    def fileno(self) -> int:
        """Return a descriptor that is readable after `run`."""
        return self._ours.fileno()

    def receive(self) -> Snapshot | None:
        """Return the newest snapshot."""
        try:
            self._ours.recv(1 << 16)
        except BlockingIOError:
            return None
        return self.drive.station.snapshot(self.drive.world.now, 0.0)

    def pop_views(self) -> list[View]:
        """Return the newest views."""
        views, self._views = self._views, []
        return views

    def close(self) -> None:
        """Close both ends."""
        self._ours.close()
        self._theirs.close()

    def _take(self, view: View) -> bool:
        self._views.append(view)
        return True
