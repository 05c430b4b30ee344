"""VehicleListener: hears vehicles on the usual ports of this machine, without ever sending."""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Hashable, Sequence
from functools import partial

from groundstation.connect.heard import HeardVehicles
from groundstation.views.connect import HeardRow, ListenRow
from link.endpoint import parse_endpoint
from link.protocol.channel import Channel
from link.transport.transport import LinkError
from link.transport.udp import UdpTransport, open_udp

ENDPOINTS = ("udpin:127.0.0.1:14550", "udpin:127.0.0.1:14551")
"""Where vehicles and simulators of this machine usually send to, and where MAVProxy forwards to."""


class VehicleListener:
    """Open sockets while somebody wants to know. `ids` are our system and component id."""

    def __init__(self, ids: tuple[int, int], endpoints: Sequence[str] = ENDPOINTS) -> None:
        self._ids = ids
        self._endpoints = endpoints
        self._heard = HeardVehicles()
        self._open: dict[str, UdpTransport] = {}
        self._problems: dict[str, str] = {}

    def listen(self, taken: Collection[int]) -> None:
        """Listen on every port that no link of ours has (`taken`); a port of another program is tried again."""
        for text in self._endpoints:
            if parse_endpoint(text).port in taken:
                self.release(text)
                self._problems.pop(text, None)
            elif text not in self._open:
                self._try(text)

    def release(self, endpoint: str) -> None:
        """Free a port, so that a link can have it."""
        transport = self._open.pop(endpoint, None)
        if transport is not None:
            transport.close()
        self._heard.forget(endpoint)

    def close(self) -> None:
        """Free all ports."""
        for text in list(self._open):
            self.release(text)
        self._problems.clear()

    def heard(self, now: float) -> tuple[HeardRow, ...]:
        """Return what is heard now."""
        return self._heard.rows(now)

    @property
    def listening(self) -> tuple[ListenRow, ...]:
        """The ports on which it listens, or why it does not."""
        rows = ((text, self._problems.get(text, "")) for text in self._endpoints)
        return tuple(ListenRow(text, problem) for text, problem in rows if problem or text in self._open)

    def _try(self, text: str) -> None:
        try:
            transport = open_udp(parse_endpoint(text))
        except LinkError as error:
            self._problems[text] = str(error).removeprefix(f"{text}: ")
            return
        self._problems.pop(text, None)
        self._open[text] = transport
        channel = Channel(text, 0, system=self._ids[0], component=self._ids[1])
        loop = asyncio.get_running_loop()
        transport.start(loop, partial(self._receive, text, channel), lambda address: None)

    def _receive(self, endpoint: str, channel: Channel, pieces: Sequence[tuple[bytes, Hashable]]) -> None:
        now = asyncio.get_running_loop().time()
        for data, address in pieces:
            messages = channel.receive(data, address, now)
            if messages:
                self._heard.receive(endpoint, messages, len(data), now)
