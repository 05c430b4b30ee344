"""What a link is: a wire (socket or port) with a channel (the conversation on it). To add a kind of wire: a module
beside udp.py, a line in endpoint.SCHEMES and one in openers.OPENERS.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from typing import Protocol

from link.endpoint import Endpoint
from link.protocol.channel import Channel


class LinkError(Exception):
    """A link cannot be opened; the message is one line that says what, where and what to do."""


ReceiveCallback = Callable[[Sequence[tuple[bytes, Hashable]]], None]
"""Takes what arrived: bytes (a datagram, or any piece of a stream) and the address they came from; none yet from a new
connection."""
DisconnectCallback = Callable[[Hashable], None]
"""Hears that the connection to an address has ended."""


class Transport(Protocol):
    """A socket or port, not blocking. It knows nothing of messages, only of frames that go first (priority_queue.py)."""

    endpoint: Endpoint
    problem: str | None
    """Why it does not work now, in one line, or None."""
    stream: bool
    """Bytes have no datagram borders."""
    fixed_address: Hashable | None
    """The address that the user named, for wires that speak before they are spoken to."""
    capacity: float | None
    """Bytes/s that it takes, where that is known."""

    @property
    def dropped(self) -> int:
        """Frames that it had no room for."""

    def start(self, loop: asyncio.AbstractEventLoop, arrived: ReceiveCallback, gone: DisconnectCallback) -> None:
        """Hand over what arrives, from now on."""

    def send(self, data: bytes, address: Hashable) -> None:
        """Put one frame on the wire (a datagram may hold several), now or soon; neither blocks nor raises."""

    def close(self) -> None:
        """Free the port; safe to call once."""


@dataclass(slots=True)
class Link:
    """A wire and the conversation on it."""

    transport: Transport
    channel: Channel

    @property
    def endpoint(self) -> Endpoint:
        """Where it ends."""
        return self.transport.endpoint

    def close(self) -> None:
        """Free the port."""
        self.transport.close()


TransportFactory = Callable[[Endpoint], Transport]
"""Opens one kind of wire. Raises LinkError with one clear line."""
