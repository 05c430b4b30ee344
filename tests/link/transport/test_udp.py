"""UDP sockets as the transport opens them; delivery over them is tested in tests/link/test_runner.py."""

from __future__ import annotations

import contextlib
import itertools
import socket
from collections.abc import Hashable, Sequence
from pathlib import Path
from random import Random

from link.endpoint import parse_endpoint
from link.transport.udp import RECEIVE_BUFFER, open_udp
from tests.ports import free_port


def test_a_udp_socket_asks_for_a_larger_buffer_than_the_default() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as usual:
        default = usual.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    most = 2 * int(Path("/proc/sys/net/core/rmem_max").read_text())
    with contextlib.closing(open_udp(parse_endpoint(f"udpin:127.0.0.1:{free_port()}"))) as transport:
        granted = transport._socket.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF)
    assert granted == min(2 * RECEIVE_BUFFER, most) >= default


def test_datagrams_that_are_kept_lie_close_together() -> None:
    """Tables of the router and charts keep some: far apart, they keep megabytes of the heap from being used again."""
    endpoint, chance, kept = parse_endpoint(f"udpin:127.0.0.1:{free_port()}"), Random(1), dict[tuple[int, int], bytes]()
    numbers = itertools.count()

    def keep(batch: Sequence[tuple[bytes, Hashable]]) -> None:
        source = chance.randrange(8)
        if chance.random() < 0.7**source:  # some for long, some for a moment only
            kept[source, next(numbers) % 256] = batch[0][0]

    with (
        contextlib.closing(open_udp(endpoint)) as transport,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as far,
    ):
        far.connect(transport._socket.getsockname())
        for _ in range(50_000):
            far.send(bytes(chance.randint(20, 280)))
            transport._readable(keep)
    assert len(kept) > 1500
    assert len({id(data) >> 12 for data in kept.values()}) < 350, "pages; their bytes need 80"
