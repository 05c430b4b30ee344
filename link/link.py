"""What a link is to the runner: a shell around a socket or a port. To add a kind: a module beside udp.py, a line in
endpoint.SCHEMES and one in runner.OPENERS."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Hashable, Sequence
from typing import Protocol

from link.channel import Channel
from link.endpoint import Endpoint


class LinkError(Exception):
    """A link cannot be opened; the message is one line that says what, where and what to do."""


class Link(Protocol):
    """A socket or port, open and not blocking."""

    endpoint: Endpoint
    channel: Channel
    problem: str | None
    """Why it does not work now, in one line, or None."""

    def start(self, loop: asyncio.AbstractEventLoop, deliver: Datagrams) -> None:
        """Hand what arrives to `deliver`."""

    def send(self, data: bytes, address: Hashable) -> None:
        """Put one frame on the wire, now or never; neither blocks nor raises."""

    def close(self) -> None:
        """Free the port; safe to call once."""


Datagrams = Callable[[Link, Sequence[tuple[bytes, Hashable]]], None]


class Opener(Protocol):
    """Opens one kind of link."""

    def __call__(
        self, endpoint: Endpoint, index: int, *, system: int, component: int, wanted: frozenset[int] | None
    ) -> Link:
        """Raises LinkError with one clear line."""
