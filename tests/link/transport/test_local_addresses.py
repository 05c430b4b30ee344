"""Addresses of this machine, against real sockets that listen on them."""

from __future__ import annotations

import socket
from contextlib import suppress

from link.transport.local_addresses import PERIOD, LocalAddresses


def test_a_socket_can_listen_on_each_address() -> None:
    found = LocalAddresses().find(0.0)
    assert len(set(found)) == len(found)
    for address in found:
        assert not address.startswith("127.")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
            sock.bind((address, 0))


def test_the_address_of_the_default_route_comes_first() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        with suppress(OSError):  # a machine without a network has no such route
            sock.connect(("192.0.2.1", 9))
        own = sock.getsockname()[0]
    if own != "0.0.0.0" and not own.startswith("127."):
        assert LocalAddresses().find(0.0)[0] == own


def test_the_addresses_are_looked_up_again_after_a_while() -> None:
    addresses = LocalAddresses()
    first = addresses.find(0.0)
    assert addresses.find(PERIOD / 2) is first
    assert addresses.find(PERIOD) is not first or not first
