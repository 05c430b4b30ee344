"""A real station with a simulated rover behind the screen, in virtual time: what keys do to wheels."""

from __future__ import annotations

from msgspec.structs import replace

from groundstation.intents.union import AnyIntent
from tests.groundstation.ui.examples import Recorder
from tests.test_stops import Drive


class LiveStation:
    """A station behind `screen`, in the world of `drive`. Its time passes in `run` only."""

    def __init__(self, drive: Drive) -> None:
        self.drive = drive
        self.screen = Recorder(self.handle)
        self._offered = 0

    def handle(self, *intents: AnyIntent) -> None:
        """Let the station handle them at once."""
        self.drive.tell(*intents)

    def run(self, seconds: float) -> None:
        """Let time pass, and offer a picture."""
        self.drive.run(seconds)
        now = self.drive.world.now
        self.drive.station.views.send_due(self.screen.offer_view, now, 0.0)
        self._offered += 1
        self.screen.offer(replace(self.drive.station.snapshot(now, 0.0), number=self._offered))
