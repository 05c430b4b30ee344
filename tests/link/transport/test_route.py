"""By which address frames leave: of connected and of listening sockets, and of what has no address."""

from __future__ import annotations

import socket

from link.core import AddressPair, Peer
from link.endpoint import parse_endpoint
from link.transport.route import MAX_PEERS, find_routes
from link.transport.transport import Outlet
from link.transport.udp import open_udp
from tests.ports import free_port

HERE = AddressPair("127.0.0.1", "127.0.0.1")


def test_a_listening_and_a_connected_socket_have_routes() -> None:
    listening = open_udp(parse_endpoint(f"udpin:0.0.0.0:{free_port()}"))
    named = open_udp(parse_endpoint("udpout:127.0.0.1:9"))
    try:
        peer = Peer(0, ("127.0.0.1", 5555))
        assert find_routes(listening, [peer]) == {peer: HERE}
        assert find_routes(named, [Peer(1, named.fixed_address)]) == {Peer(1, named.fixed_address): HERE}
        nowhere = Peer(0, ("no address", 1))
        assert find_routes(listening, [nowhere]) == {}
        many = [Peer(0, ("127.0.0.1", port)) for port in range(1, 100)]
        assert len(find_routes(listening, many)) == MAX_PEERS
    finally:
        listening.close()
        named.close()


class _Line:
    """A transport whose outlet is given."""

    endpoint = parse_endpoint("udpin:127.0.0.1:1")

    def __init__(self, outlet: Outlet | None) -> None:
        self._outlet = outlet

    def outlet(self, address: object) -> Outlet | None:
        return self._outlet


def test_what_is_no_network_has_no_route() -> None:
    ours, theirs = socket.socketpair()
    with ours, theirs:
        for outlet in (None, Outlet(3, None, object()), Outlet(ours.fileno(), None, ours)):
            assert find_routes(_Line(outlet), [Peer(0, "x")]) == {}  # type: ignore[arg-type]
