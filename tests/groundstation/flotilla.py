"""One station and any number of scripted vehicles on one link, in virtual time, with the views that it sends."""

from __future__ import annotations

from typing import TypeVar

from groundstation.intents.session import RenewLease, SetKeyGate
from groundstation.intents.watch import Watch
from groundstation.station.process.crash_neutral import CrashNeutral
from groundstation.station.station import Station
from groundstation.vehicles.state.places import PLACES
from groundstation.views.base import View, ViewRequest
from link.protocol.channel import Channel
from tests.fakes.vehicle import FakeVehicle
from tests.world import Host

STEP = 0.02
SESSION = 77
ViewT = TypeVar("ViewT", bound=View)


class Flotilla:
    """One station and `count` vehicles on one link; further hosts may join them."""

    def __init__(self, count: int) -> None:
        self.now = 100.0
        self.station = Station(["udpin:127.0.0.1:14550"], session=SESSION, now=self.now)
        self.near = Host(CrashNeutral(self.station), Channel("near", 0, system=255, component=190, places=PLACES), STEP)
        self.vehicles = {system: FakeVehicle(system=system) for system in range(1, count + 1)}
        self.far: dict[str, Host] = {}
        for system, vehicle in self.vehicles.items():
            self.join(vehicle, system, 1)
        self.views: list[tuple[float, View]] = []
        self._lease_due = 0.0
        self.station.handle_intent(SetKeyGate(open=True), self.now)

    def join(self, core: FakeVehicle, system: int, component: int) -> None:
        """Add a host with its own address."""
        channel = Channel("far", 0, system=system, component=component, target="station")
        self.far[f"10.0.0.{len(self.far) + 1}:14550"] = Host(core, channel, STEP)

    def run(self, seconds: float) -> None:
        """Advance the time; views are sent ten times a second, as the process does."""
        for step in range(round(seconds / STEP)):
            self.now += STEP
            if self.now >= self._lease_due:
                self._lease_due = self.now + 0.1
                self.station.handle_intent(RenewLease(), self.now)
            self._exchange()
            if step % 5 == 0:
                self.station.views.send_due(self._take, self.now, self.now)

    def _take(self, view: View) -> bool:
        self.views.append((self.now, view))
        return True

    def _exchange(self) -> None:
        self.near.advance(self.now)
        for outgoing in self.near.core.messages_to_send():
            for data, address, sequence in self.near.channel.send(outgoing):
                self.station.handle_sent(outgoing.message, sequence, self.now)
                self.far[str(address)].receive(data, "station", self.now)
        for address, host in self.far.items():
            host.advance(self.now)
            for data in host.pop_frames(self.now, "station"):
                self.near.receive(data, address, self.now)

    def watch(self, *requests: ViewRequest) -> None:
        """Open or close the screen."""
        self.station.handle_intent(Watch(requests), self.now)

    def all(self, kind: type[ViewT]) -> list[ViewT]:
        """The views of one kind."""
        return [view for _, view in self.views if isinstance(view, kind)]

    def newest(self, kind: type[ViewT]) -> ViewT:
        """The newest one, half a second from now."""
        self.run(0.7)
        return self.all(kind)[-1]
