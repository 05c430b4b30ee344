"""By which address of this machine the frames of a peer leave: two links with one address share a network."""

from __future__ import annotations

import math
import socket
from collections.abc import Mapping, Sequence

from link.core import AddressPair, Peer
from link.endpoint import Endpoint
from link.transport.device import bind_to_device
from link.transport.transport import LinkError, Outlet, Transport

MAX_PEERS = 4
"""Peers of a link whose route is looked up: a flood of invented ones must cost nothing."""
MAX_KNOWN = 64
"""Routes that are remembered."""
PERIOD, RETRY = 10.0, 1.0
"""s for which a route counts, and the lack of one: a network may come or go, and what follows is a note of doctor."""


class Routes:
    """The routes of the peers of all links, each looked up now and then. Times in s."""

    def __init__(self) -> None:
        self._known: dict[Peer, tuple[object, AddressPair | None, float]] = {}
        """Peer -> the socket, its route, and until when that counts."""

    def find(self, transport: Transport, peers: Sequence[Peer], now: float) -> Mapping[Peer, AddressPair]:
        """Return the routes of the first peers. Never blocks; a new one takes 0.05 ms."""
        found = {peer: self._find(transport, peer, now) for peer in peers[:MAX_PEERS]}
        return {peer: route for peer, route in found.items() if route is not None}

    def _find(self, transport: Transport, peer: Peer, now: float) -> AddressPair | None:
        outlet = transport.outlet(peer.address)
        opened, route, until = self._known.get(peer, (None, None, -math.inf))
        if outlet is None or (opened is outlet.opened and now < until):
            return None if outlet is None else route
        if len(self._known) >= MAX_KNOWN:
            self._known.clear()
        route = _find_route(transport.endpoint, outlet)
        self._known[peer] = (outlet.opened, route, now + (PERIOD if route is not None else RETRY))
        return route


def _find_route(endpoint: Endpoint, outlet: Outlet) -> AddressPair | None:
    """Return the route of an outlet; None if it is no socket, or leads nowhere."""
    sock = outlet.opened
    if not isinstance(sock, socket.socket) or sock.family not in (socket.AF_INET, socket.AF_INET6):
        return None
    try:
        if outlet.destination is None:
            return AddressPair(_host(sock.getsockname()), _host(sock.getpeername()))
        with socket.socket(sock.family, socket.SOCK_DGRAM) as probe:
            bind_to_device(probe, endpoint)
            _bind_as(sock, probe)
            probe.connect(outlet.destination)  # of UDP: it sends nothing, and selects a route
            return AddressPair(_host(probe.getsockname()), _host(outlet.destination))
    except (OSError, LinkError, TypeError, IndexError):
        return None


def _bind_as(sock: socket.socket, probe: socket.socket) -> None:
    """Let the probe leave by the address of a socket that listens on one only."""
    local = _host(sock.getsockname())
    if local not in ("0.0.0.0", "::"):
        probe.bind((local, 0))


def _host(address: tuple[object, ...]) -> str:
    """Return the address without port; an IPv4 address that an IPv6 socket shows as IPv4."""
    return str(address[0]).removeprefix("::ffff:")
