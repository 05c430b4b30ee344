"""EndpointListener: counts what arrives on each endpoint, and lets a router decide where it would go. Sends nothing."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import msgspec
from msgspec.structs import replace

from dialects import codec
from dialects.messages import Heartbeat
from link.bridge.doctor.facts import ForwardRoute, Source, TrafficSample
from link.protocol.frame import MAX_UNKNOWN, Frame, FramerCounts, find_mismatches
from link.protocol.framer import Framer
from link.routing.router import Router
from link.signing.signature import is_signed

MAX_ADDRESSES = 64
"""Addresses whose frames are examined on one endpoint; of further ones only the bytes are counted."""
MAX_SOURCES = 256
"""Systems and components per endpoint."""


class _Endpoint(msgspec.Struct):
    stream: bool
    received: int = 0
    framers: dict[Hashable, Framer] = msgspec.field(default_factory=dict)
    sources: dict[tuple[int, int], Source] = msgspec.field(default_factory=dict)
    unknown_ids: set[int] = msgspec.field(default_factory=set)


class EndpointListener:
    """Takes the bytes of all endpoints. `links`, by index: (is it a stream, its fixed address or None)."""

    def __init__(self, links: Sequence[tuple[bool, Hashable | None]]) -> None:
        self._endpoints = [_Endpoint(stream) for stream, _ in links]
        self._router = Router(links)

    def receive(self, link: int, pieces: Sequence[tuple[bytes, Hashable]], now: float) -> None:
        """Handle the bytes that arrived on a link."""
        self._router.receive(link, pieces, now)
        endpoint = self._endpoints[link]
        for data, address in pieces:
            endpoint.received += len(data)
            if data and (framer := self._framer(endpoint, address)):
                self._count(endpoint, framer.feed(data, now))

    def tick(self, now: float) -> None:
        """Give up overdue partial frames."""
        self._router.tick(now)
        for endpoint in self._endpoints:
            for framer in endpoint.framers.values():
                self._count(endpoint, framer.expire(now))

    def handle_disconnect(self, link: int, address: Hashable) -> None:
        """Handle the end of the connection to `address`."""
        self._router.table.handle_disconnect(link, address)

    def heard(self, link: int) -> TrafficSample:
        """Return what has arrived on a link."""
        endpoint, counts = self._endpoints[link], FramerCounts()
        for framer in endpoint.framers.values():
            counts.add(framer.counts)
        return TrafficSample(
            received=endpoint.received,
            addresses=len(endpoint.framers),
            frames=counts.frames,
            crc_errors=counts.crc_errors,
            noise=counts.resync_bytes,
            unknown=counts.unknown,
            unknown_ids=tuple(sorted(endpoint.unknown_ids)),
            mismatched=find_mismatches(counts),
            sources=tuple(endpoint.sources[key] for key in sorted(endpoint.sources)),
        )

    def routes(self, link: int, names: Sequence[str]) -> tuple[ForwardRoute, ...]:
        """Return where the sources of a link would be forwarded to; `names` of the links, "" for one that fails."""
        return tuple(self._route(link, key, names) for key in sorted(self._endpoints[link].sources))

    def _route(self, link: int, key: tuple[int, int], names: Sequence[str]) -> ForwardRoute:
        ways = self._router.broadcast_links(link, key)
        doubles = (other for other, each in enumerate(self._endpoints) if other != link and key in each.sources)
        broadcasts = tuple(names[each] for each in sorted(ways) if names[each])
        return ForwardRoute(*key, broadcasts, tuple(names[each] for each in doubles))

    @staticmethod
    def _framer(endpoint: _Endpoint, address: Hashable) -> Framer | None:
        framer = endpoint.framers.get(address)
        if framer is None and len(endpoint.framers) < MAX_ADDRESSES:
            framer = endpoint.framers[address] = Framer(stream=endpoint.stream, unknown=True)
        return framer

    @staticmethod
    def _count(endpoint: _Endpoint, frames: Sequence[Frame]) -> None:
        for frame in frames:
            number, system, component, _, _ = frame
            key = (system, component)
            if number not in codec.CRC_EXTRA:
                if len(endpoint.unknown_ids) < MAX_UNKNOWN:
                    endpoint.unknown_ids.add(number)
            elif key in endpoint.sources or len(endpoint.sources) < MAX_SOURCES:
                endpoint.sources[key] = _count_frame(endpoint.sources.get(key, Source(*key, 0)), frame)


def _count_frame(source: Source, frame: Frame) -> Source:
    number, _, _, _, raw = frame
    counted = replace(source, frames=source.frames + 1, signed=is_signed(raw))
    message = codec.decode_frame(number, raw) if number == Heartbeat.id else None
    if not isinstance(message, Heartbeat):
        return counted
    return replace(counted, kind=message.type, autopilot=message.autopilot)
