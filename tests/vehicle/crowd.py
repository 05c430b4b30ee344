"""A rover with several ground stations on several links, in virtual time: who is told what, and when."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from typing import TypeVar

from dialects import codec
from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command
from link.core import LinkReport, Outgoing, Peer, Received
from link.services.pacing import MAVLINK2_OVERHEAD
from tests.vehicle.bench import BEAT, CYCLE, EVERYTHING
from vehicle.params import Params
from vehicle.rover import Rover
from vehicle.storage.logbook import LogRecorder

M = TypeVar("M", bound=m.Message)
REPORT = 1.0
"""s between two reports of the links, as link/runner.py has it."""


class Crowd:
    """`peers` speak as system 255, 254 and so on, after their HEARTBEAT; `capacity` is of each link, bytes/s."""

    def __init__(
        self, *peers: Peer, capacity: dict[int, float] | None = None, recording: LogRecorder | None = None
    ) -> None:
        self.now = 100.0
        self.rover = Rover(Params({}), now=self.now, recording=recording)
        self.capacity = capacity or {}
        self.peers: list[Peer] = []
        self.outgoing: list[Outgoing] = []
        self.told: dict[Peer, list[tuple[float, m.Message]]] = defaultdict(list)
        self._sequence = 0
        self._report_due = self._tick_due = self.now
        for peer in peers:
            self.join(peer)

    def join(self, peer: Peer) -> None:
        """A ground station shows its HEARTBEAT."""
        self.peers.append(peer)
        self.say(peer, BEAT)

    def leave(self, peer: Peer) -> None:
        """The link has forgotten it."""
        self.peers.remove(peer)

    def say(self, peer: Peer, message: m.Message, *, introduced: bool = True) -> None:
        """A message of a peer, and what the rover sends at once."""
        self._sequence = (self._sequence + 1) & 0xFF
        system = 255 - self.peers.index(peer) if peer in self.peers else 200
        self.rover.receive(Received(message, system, 190, self._sequence, peer, introduced), self.now)
        self._collect()

    def command(self, peer: Peer, command: int, *params: float, introduced: bool = True) -> int:
        """The result of a command."""
        full = (*params, *(0.0,) * (7 - len(params)))
        self.say(peer, m.CommandLong(1, 1, command, 0, *full), introduced=introduced)
        return int(self.all(peer, m.CommandAck)[-1].result)

    def ask_rate(self, peer: Peer, kind: type[m.Message], rate: float) -> int:
        """SET_MESSAGE_INTERVAL in Hz."""
        return self.command(peer, Command.SET_MESSAGE_INTERVAL, kind.id, 1e6 / rate)

    def interval(self, peer: Peer, kind: type[m.Message]) -> int:
        """What MESSAGE_INTERVAL tells this peer, us."""
        self.command(peer, Command.GET_MESSAGE_INTERVAL, kind.id)
        return int(self.all(peer, m.MessageInterval)[-1].interval_us)

    def wait(self, seconds: float, driver: Peer | None = None) -> None:
        """Let time pass; a `driver` changes the demand ten times a second."""
        end, demand = self.now + seconds, 0
        while self._tick_due <= end + 1e-9:
            self.now = self._tick_due
            if self.now >= self._report_due - 1e-9:
                self._report_due += REPORT
                self.rover.observe(self.reports(), self.now)
            self.rover.sense(EVERYTHING, self.now)
            self.rover.tick(self.now)
            self._collect()
            demand += 1
            if driver is not None and demand % 5 == 0:
                self.say(driver, build_manual_control(Axes(throttle=0.1 * (demand % 7)), 1))
            self._tick_due += CYCLE
        self.now = end

    def reports(self) -> list[LinkReport]:
        """What the links say."""
        links = {*self.capacity, *(peer.link for peer in self.peers)}
        return [
            LinkReport(
                f"link {link}",
                index=link,
                capacity=self.capacity.get(link),
                audience=tuple(peer for peer in self.peers if peer.link == link),
            )
            for link in sorted(links)
        ]

    def all(self, peer: Peer, kind: type[M]) -> list[M]:
        """Everything of a kind that this peer was told."""
        return [message for _, message in self.told[peer] if isinstance(message, kind)]

    def kinds(self, peer: Peer) -> set[type[m.Message]]:
        """What kinds this peer was told."""
        return {type(message) for _, message in self.told[peer]}

    def rates(self, peer: Peer, seconds: float, driver: Peer | None = None) -> Counter[type[m.Message]]:
        """How often this peer is told each message in the next `seconds`."""
        before = len(self.told[peer])
        self.wait(seconds, driver)
        return Counter(type(message) for _, message in self.told[peer][before:])

    def forget(self) -> None:
        """What was told so far."""
        self.told.clear()
        self.outgoing.clear()

    def _collect(self) -> None:
        for outgoing in self.rover.messages_to_send():
            self.outgoing.append(outgoing)
            for peer in self._recipients(outgoing):
                self.told[peer].append((self.now, outgoing.message))

    def _recipients(self, outgoing: Outgoing) -> Sequence[Peer]:
        if outgoing.peer is not None:
            return [outgoing.peer]
        return self.peers if outgoing.among is None else outgoing.among


def weight(messages: Sequence[tuple[float, m.Message]]) -> int:
    """Bytes on the wire."""
    return sum(len(codec.encode_payload(message)) + MAVLINK2_OVERHEAD for _, message in messages)
