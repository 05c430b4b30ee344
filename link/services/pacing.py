"""Paces lists, files and logs to a share of each peer's link, so that they do not crowd out the rest.

All services that send more than one reply to a request (parameter lists, file bursts, logs) share one BulkPacer.
"""

from __future__ import annotations

from collections.abc import Callable

from dialects import codec
from link.core import Peer
from link.protocol.rate import TokenBucket

DEFAULT_RATE = 400_000.0
"""bytes/s to a peer on a network: 1600 file frames a second, two thirds of what link/protocol/channel.py accepts from a
peer."""
MAX_FRAME_RATE = 1600.0
"""frames/s to any peer, however short: decoding a short one takes as long. MAVProxy lost one in six of 3700 LOG_DATA a
second, which its socket buffer could not hold."""
BURST_TIME = 0.05
"""s of the rate that may go at once: two and a half control cycles, so that a late cycle costs no throughput."""
MAX_PEERS = 32
MAVLINK2_OVERHEAD = 12
"""Bytes of a MAVLink 2 frame around its payload."""


class BulkPacer:
    """Decides when the next bulk frame may go to a peer. `rate` returns the bytes/s for one."""

    def __init__(self, rate: Callable[[Peer], float] = lambda peer: DEFAULT_RATE) -> None:
        self._rate = rate
        self._buckets: dict[Peer, tuple[float, TokenBucket]] = {}

    def consume(self, peer: Peer, size: int, now: float) -> bool:
        """Return whether a frame of `size` bytes may go to `peer` now, and count it."""
        rate = self._rate(peer)
        known = self._buckets.get(peer)
        if known is None or known[0] != rate:
            known = self._buckets[peer] = (rate, TokenBucket(rate, max(rate * BURST_TIME, codec.MAX_FRAME)))
            if len(self._buckets) > MAX_PEERS:
                del self._buckets[next(iter(self._buckets))]
        return known[1].consume(now, max(size, rate / MAX_FRAME_RATE))
