"""What sockets receive, copied out of one place: the same bytes, and no more memory than they need."""

from __future__ import annotations

import socket
import tracemalloc
from collections.abc import Callable

import pytest

from link.transport.receive_buffer import ReceiveBuffer

LARGEST = 1 << 18


@pytest.mark.parametrize("kind", [socket.SOCK_STREAM, socket.SOCK_SEQPACKET])
def test_it_returns_what_was_sent_as_a_copy(kind: socket.SocketKind) -> None:
    near, far = socket.socketpair(socket.AF_UNIX, kind)
    with near, far:
        buffer = ReceiveBuffer(LARGEST)
        far.send(b"first, longer")
        first = buffer.recv(near)
        far.send(b"second")
        assert (first, buffer.recv(near)) == (b"first, longer", b"second")
        far.close()
        assert buffer.recv(near) == b""


def test_datagram_has_its_address_and_ends_where_the_buffer_does() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as near,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far,
    ):
        near.bind(("127.0.0.1", 0))
        far.bind(("127.0.0.1", 0))
        far.sendto(b"12345", near.getsockname())
        assert ReceiveBuffer(4).recvfrom(near) == (b"1234", far.getsockname())


def _allocated(receive: Callable[[socket.socket], bytes]) -> int:
    """Return how many bytes were allocated at most at once while one small packet was received."""
    near, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with near, far:
        far.send(bytes(100))
        tracemalloc.start()
        try:
            assert receive(near) == bytes(100)
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()


def test_a_small_packet_allocates_little() -> None:
    buffer = ReceiveBuffer(LARGEST)
    assert _allocated(lambda sock: sock.recv(LARGEST)) > LARGEST
    assert _allocated(buffer.recv) < 4096
