"""What a link is: a transport (socket or serial port) and the channel that speaks MAVLink over it.

To add a link type, write a module beside udp.py and add its row to link.endpoint.SCHEMES.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable, Sequence
from typing import Any, NamedTuple, Protocol, runtime_checkable

import msgspec

from link.endpoint import Endpoint
from link.protocol.channel import Channel


class LinkError(Exception):
    """A link cannot be opened; the message is one line that names the endpoint, the error and the remedy."""


class PortInUseError(LinkError):
    """Another program listens on the port of the endpoint."""


ReceiveCallback = Callable[[Sequence[tuple[bytes, Hashable]]], None]
"""Takes what arrived: bytes (a datagram, or any piece of a stream) and the address they came from.

A new connection is reported with empty bytes.
"""
DisconnectCallback = Callable[[Hashable], None]
"""Takes the address of a connection that has ended."""


class Outlet(NamedTuple):
    """Where the bytes for one address leave, for another process that gets a copy of the descriptor."""

    descriptor: int
    destination: Any
    """The address for sendto(); None where the descriptor leads to one other end: write() sends."""
    opened: object
    """The socket or port of the descriptor: the next one that is opened may get the same number."""


class Transport(Protocol):
    """A non-blocking socket or serial port. Of messages it knows only which go first (priority_queue.py)."""

    endpoint: Endpoint
    stream: bool
    """Bytes have no datagram boundaries."""
    fixed_address: Hashable | None
    """The address that the user named, for transports that send first."""
    capacity: float | None
    """Bytes/s that the transport carries, or None where that is not known."""

    @property
    def problem(self) -> str | None:
        """Why the transport does not work now, in one line, or None."""

    @property
    def dropped(self) -> int:
        """Frames dropped because there was no room."""

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start to receive, and to connect where the link type does so."""

    def send(self, data: bytes, address: Hashable) -> None:
        """Send one frame, now or soon (a datagram may hold several). Neither blocks nor raises."""

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return where the bytes for `address` leave now; None while they cannot."""

    def close(self) -> None:
        """Free the socket or port. Called once."""


@runtime_checkable
class RoleTransport(Protocol):
    """A transport that knows what this program may send."""

    def refusal(self, data: bytes) -> str | None:
        """Return why a frame may not be sent, in one line for the user; None if it may."""


@runtime_checkable
class SelectiveTransport(Protocol):
    """A transport whose vehicles send less to a ground station that does not look at them."""

    def set_interest(self, systems: frozenset[int] | None) -> None:
        """Set the system ids whose whole telemetry is needed; None: that of all vehicles, as at the start."""


class Link(msgspec.Struct):
    """A transport and the channel on it."""

    transport: Transport
    channel: Channel
    watch_only: bool = False
    """Nothing is ever sent on it."""
    frames_sent: int = 0
    bytes_sent: int = 0
    refusal: Callable[[bytes], str | None] | None = None
    """That of a RoleTransport, for a core that wants to know."""
    set_interest: Callable[[frozenset[int] | None], None] | None = None
    """That of a SelectiveTransport, for a core that says what it looks at."""

    def send(self, data: bytes, address: Hashable) -> str | None:
        """Send one frame and count it. Return None, or why it may not be sent."""
        if self.watch_only:
            return "this link only watches"
        if self.refusal is not None and (why := self.refusal(data)):
            return why
        self.frames_sent += 1
        self.bytes_sent += len(data)
        self.transport.send(data, address)
        return None

    @property
    def endpoint(self) -> Endpoint:
        """The transport's endpoint."""
        return self.transport.endpoint

    def close(self) -> None:
        """Free the socket or port."""
        self.transport.close()


TransportFactory = Callable[[Endpoint], Transport]
"""Opens one link type. Raises LinkError."""
