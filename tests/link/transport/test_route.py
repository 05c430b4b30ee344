"""By which address frames leave: of connected and of listening sockets, and of what has no address."""

from __future__ import annotations

import socket

import pytest

from link.core import AddressPair, Peer
from link.endpoint import Endpoint, parse_endpoint
from link.transport import route
from link.transport.route import MAX_KNOWN, MAX_PEERS, PERIOD, RETRY, Routes
from link.transport.transport import Outlet
from link.transport.udp import open_udp
from tests.ports import free_port

HERE = AddressPair("127.0.0.1", "127.0.0.1")


def test_a_listening_and_a_connected_socket_have_routes() -> None:
    listening = open_udp(parse_endpoint(f"udpin:0.0.0.0:{free_port()}"))
    named = open_udp(parse_endpoint("udpout:127.0.0.1:9"))
    try:
        routes, peer = Routes(), Peer(0, ("127.0.0.1", 5555))
        assert routes.find(listening, [peer], 1.0) == {peer: HERE}
        assert routes.find(named, [Peer(1, named.fixed_address)], 1.0) == {Peer(1, named.fixed_address): HERE}
        nowhere = Peer(0, ("no address", 1))
        assert routes.find(listening, [nowhere], 1.0) == {}
        many = [Peer(0, ("127.0.0.1", port)) for port in range(1, 100)]
        assert len(routes.find(listening, many, 1.0)) == MAX_PEERS
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
            assert Routes().find(_Line(outlet), [Peer(0, "x")], 1.0) == {}  # type: ignore[arg-type]


def test_a_route_is_looked_up_again_after_a_while(monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[object] = []
    answers: list[AddressPair | None] = [HERE, HERE, HERE, None, HERE]

    def look(endpoint: Endpoint, outlet: Outlet) -> AddressPair | None:
        looks.append(outlet)
        return answers[len(looks) - 1]

    monkeypatch.setattr(route, "_find_route", look)
    routes, peer, first, second = Routes(), Peer(0, "x"), object(), object()

    def find(opened: object, now: float) -> bool:
        return peer in routes.find(_Line(Outlet(3, None, opened)), [peer], now)  # type: ignore[arg-type]

    assert all(find(first, each) for each in (0.0, 1.0, PERIOD - 0.1))
    assert len(looks) == 1
    assert find(first, PERIOD)
    assert find(second, PERIOD + 1.0), "another socket, as after a reconnection"
    assert len(looks) == 3
    assert not find(second, 3 * PERIOD)
    assert not find(second, 3 * PERIOD + RETRY / 2)
    assert find(second, 3 * PERIOD + RETRY)
    assert len(looks) == 5
    for number in range(3 * MAX_KNOWN):
        monkeypatch.setattr(route, "_find_route", lambda endpoint, outlet: HERE)
        routes.find(_Line(Outlet(3, None, first)), [Peer(0, number)], 100.0)  # type: ignore[arg-type]
    assert len(routes._known) <= MAX_KNOWN
