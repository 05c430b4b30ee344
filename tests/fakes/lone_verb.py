"""A verb with an OperatorCore of its own, as in its own process, without links: for tests that are its network."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Autopilot, VehicleType
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.verbs.session.core import VerbCore
from groundstation.verbs.session.station_seat import StationSeat
from link.core import Outgoing, Peer, Received


def heard_contact(now: float) -> Contact:
    """Return a vehicle of which one HEARTBEAT was heard."""
    beat = m.Heartbeat(VehicleType.GROUND_ROVER, Autopilot.GENERIC, 81, 0, 4, 3)
    contact = Fleet(MessageLog(), 255, 190).get_or_add(Received(beat, 1, 1, 0, Peer(0, "vehicle"), True), now)
    assert contact is not None
    return contact


class LoneVerb:
    """Takes what VerbCore.alone takes. `core` is that of the verb; messages and time go through its OperatorCore."""

    def __init__(self, ids: tuple[int, int], wanted: int | str | None, session: int) -> None:
        self.core = VerbCore.alone(ids, wanted, session)
        self.station = self.core.station
        self.seat = StationSeat(self.station, self.core, "a verb", lambda: None, alone=True)
        self.now = 0.0
        self.seat.join(self.now)

    def receive(self, received: Received, now: float) -> None:
        self.now = now
        self.station.receive(received, now)

    def tick(self, now: float) -> None:
        self.now = now
        self.station.tick(now)

    def messages_to_send(self) -> list[Outgoing]:
        self.seat.pass_on(self.now)
        return self.station.messages_to_send()
