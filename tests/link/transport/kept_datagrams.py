"""Receives datagrams and keeps some, as tables and charts do; prints their number and that of the pages with them."""

from __future__ import annotations

import contextlib
import itertools
import socket
from collections.abc import Hashable, Sequence
from random import Random

from link.endpoint import parse_endpoint
from link.transport.udp import open_udp
from tests.ports import free_port

RECEIVED = 50_000
PAGE_BITS = 12


def main() -> None:
    """Receive all, then print both numbers."""
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
        for _ in range(RECEIVED):
            far.send(bytes(chance.randint(20, 280)))
            transport._readable(keep)
    print(len(kept), len({id(data) >> PAGE_BITS for data in kept.values()}))


if __name__ == "__main__":
    main()
