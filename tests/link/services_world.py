"""What the tests of the services share: messages as they arrive, and both halves joined by pipes that lose them."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any, Protocol

from dialects import codec
from dialects.messages import Message
from link.core import Outgoing, Peer, Received

PEER = Peer(0, "there")
OTHER_PEER = Peer(0, "elsewhere")
GCS, GCS_COMPONENT = 255, 190


def through_the_wire(message: Message) -> Message:
    """`message` as the other end decodes it: names cut at 16 bytes, floats as float32, arrays as lists."""
    number = type(message).id
    return codec.decode(number, codec.encode_payload(message))


def from_gcs(
    message: Message, *, system: int = GCS, component: int = GCS_COMPONENT, peer: Peer = PEER, introduced: bool = True
) -> Received:
    """A message as the vehicle gets it."""
    return Received(through_the_wire(message), system, component, 0, peer, introduced)


def from_vehicle(message: Message, *, system: int = 1, component: int = 1) -> Received:
    """A message as a ground station gets it."""
    return Received(through_the_wire(message), system, component, 0, PEER, introduced=True)


def messages(outgoing: list[Outgoing]) -> list[Any]:
    """What is in them, as the other end decodes it."""
    return [through_the_wire(each.message) for each in outgoing]


class Server(Protocol):
    """The vehicle's half of a service."""

    def receive(self, received: Received, now: float) -> list[Outgoing]: ...

    def tick(self, now: float) -> list[Outgoing]: ...


class User(Protocol):
    """What has a client, and passes on to it what it gets."""

    def receive(self, received: Received, now: float) -> None: ...

    def tick(self, now: float) -> None: ...


class Client(User, Protocol):
    """The ground station's half."""

    def messages_to_send(self) -> list[Outgoing]: ...


class Pair:
    """A server and a client in steps of `step` s; each message is lost with probability `loss`."""

    def __init__(
        self,
        server: Server,
        client: Client,
        user: User | None = None,
        *,
        loss: float = 0.0,
        seed: int = 0,
        step: float = 0.02,
        delay: int = 1,
    ) -> None:
        self.server, self.client, self.now = server, client, 100.0
        self.user = user or client
        self.sent_by_client = self.sent_by_server = 0
        self._loss, self._step, self._delay = loss, step, delay
        self._dice = random.Random(seed)
        self._up: list[tuple[float, Message]] = []
        self._down: list[tuple[float, Message]] = []

    def step(self) -> None:
        """One step: what is due arrives, both act."""
        self.now += self._step
        replies: list[Outgoing] = []
        for message in self._arrived(self._up):
            replies += self.server.receive(from_gcs(message), self.now)
        replies += self.server.tick(self.now)
        for message in self._arrived(self._down):
            self.user.receive(from_vehicle(message), self.now)
        self.user.tick(self.now)
        self.sent_by_server += len(replies)
        questions = self.client.messages_to_send()
        self.sent_by_client += len(questions)
        self._send(replies, self._down)
        self._send(questions, self._up)

    def run_until(self, done: Callable[[], object], within: float) -> float:
        """Step until `done`; returns how long it took. AssertionError after `within` s."""
        start = self.now
        while not done():
            assert self.now - start < within, f"not within {within} s"
            self.step()
        return self.now - start

    def _send(self, outgoing: list[Outgoing], pipe: list[tuple[float, Message]]) -> None:
        due = self.now + self._delay * self._step
        pipe += [(due, each.message) for each in outgoing if self._dice.random() >= self._loss]

    def _arrived(self, pipe: list[tuple[float, Message]]) -> list[Message]:
        arrived = [message for due, message in pipe if due <= self.now + 1e-9]
        pipe[:] = [each for each in pipe if each[0] > self.now + 1e-9]
        return arrived
