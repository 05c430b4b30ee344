"""Opens links: a transport for each endpoint, with a channel over it."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from functools import partial

from link.endpoint import Side
from link.protocol.channel import Channel
from link.protocol.peer_table import MAX_PEERS
from link.protocol.sent_frames import SentFrames
from link.transport.transport import Link, Transport
from link.transport.transports import open_transports

SEQUENCES_PER_SECOND = 40
"""By how much the first packet sequence of a ground station grows each second. A program that counts from 0 again soon
after it, or a verb before it, has sent a few frames would seem to repeat old ones (link/protocol/sequence.py): its
numbers would be late, and the vehicle would not hear its proofs."""


def open_links(
    endpoints: Sequence[str],
    *,
    system: int,
    component: int,
    wanted: frozenset[int] | None = None,
    sent: SentFrames | None = None,
    places: int = MAX_PEERS,
    side: Side | None = None,
    devices: Mapping[str, str] | None = None,
    wrap: Callable[[Transport], Transport] | None = None,
) -> list[Link]:
    """Open all endpoints, or none. Raises EndpointError or LinkError.

    `wanted`, `sent`, `places`: see Channel. `side`: which end this program is; a ground station downloads files.
    `devices`: see open_transports(). `wrap` puts something around each transport, such as faults.
    """
    build = partial(
        build_link,
        system=system,
        component=component,
        wanted=wanted,
        sent=sent or SentFrames(),
        places=places,
        first_sequence=int(time.monotonic() * SEQUENCES_PER_SECOND) & 0xFF if side is Side.GROUND_STATION else 0,
        downloads=side is Side.GROUND_STATION,
        bounded=side is not Side.GROUND_STATION,  # its demands and stops never wait
    )
    transports = open_transports(endpoints, side, devices)
    return [build(wrap(each) if wrap else each, index) for index, each in enumerate(transports)]


def build_link(
    transport: Transport,
    index: int,
    *,
    system: int,
    component: int,
    wanted: frozenset[int] | None = None,
    sent: SentFrames | None = None,
    watch_only: bool = False,
    places: int = MAX_PEERS,
    first_sequence: int = 0,
    downloads: bool = False,
    bounded: bool = False,
) -> Link:
    """Return a link over an open transport. `index` is unique among the links of a runner."""
    channel = Channel(
        transport.endpoint.text,
        index,
        system=system,
        component=component,
        stream=transport.stream,
        wanted=wanted,
        target=None if watch_only else transport.fixed_address,
        capacity=transport.capacity,
        sent=sent,
        places=places,
        first_sequence=first_sequence,
        downloads=downloads,
        bounded=bounded,
        named=bool(transport.endpoint.fleet),
    )
    return Link(transport, channel, watch_only)
