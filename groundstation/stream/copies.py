"""Copies of packets, which our vehicle sends (vehicle/camera/copies.py): each replaces a packet that is lost."""

from __future__ import annotations

from collections import deque

from groundstation.stream.rtp import HEADER, is_rtp
from link.services.video_stream import COPY_PAYLOAD_TYPE, PAYLOAD_TYPE, with_payload_type

KEPT = 2048
"""Packets that are remembered: those of a second at the highest bit rate."""


class PacketCopies:
    """Turns copies of lost packets into those packets."""

    def __init__(self) -> None:
        self._seen: set[bytes] = set()
        self._order: deque[bytes] = deque()

    def take(self, packet: bytes) -> bytes | None:
        """Return a packet as it was sent first; None for the copy of one that came. Packets that are no copy pass."""
        name = packet[2:HEADER]
        if is_copy(packet):
            if name in self._seen:
                return None
            packet = with_payload_type(packet, PAYLOAD_TYPE)
        self._seen.add(name)
        self._order.append(name)
        if len(self._order) > KEPT:
            self._seen.discard(self._order.popleft())
        return packet


def is_copy(packet: bytes) -> bool:
    """Return whether it is the copy of a packet."""
    return is_rtp(packet, COPY_PAYLOAD_TYPE)
