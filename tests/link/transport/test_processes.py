"""Which program has a network port, by what the kernel says of real sockets."""

from __future__ import annotations

import socket

from link.transport.processes import HIDDEN, find_socket_holders
from tests.ports import free_port


def test_a_free_port_has_no_holder_and_a_taken_one_has() -> None:
    port = free_port()
    assert (find_socket_holders("udp", port), find_socket_holders("tcp", port)) == ([], [])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp, socket.create_server(("127.0.0.1", port)):
        udp.bind(("127.0.0.1", port))
        # Only other processes are named: a port of this one looks like that of a program that hides its files.
        assert (find_socket_holders("udp", port), find_socket_holders("tcp", port)) == ([HIDDEN], [HIDDEN])
    assert find_socket_holders("udp", port) == []
