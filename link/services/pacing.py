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
LOCAL_FILE_RATE = 3_100_000.0
"""bytes/s of files to a station of this project on the same machine: 11,600 frames a second, five in six of what
such a station accepts (link/protocol/peer.py)."""
MAX_FRAME_RATE = 1600.0
"""frames/s to any peer with DEFAULT_RATE or less, however short: decoding a short one takes as long. MAVProxy lost one
in six of 3700 LOG_DATA a second, which its socket buffer could not hold."""
BURST_TIME = 0.05
"""s of the rate that may go at once: two and a half control cycles, so that a late cycle costs no throughput."""
BURST_MAX = 64_000
"""Bytes that may go at once: 250 frames of a file, a quarter of what the socket buffer of a station holds."""
CYCLE = 0.02
"""s between two calls: what comes in a cycle must fit beside a frame, or a slow link is not used to its share."""
MAX_PEERS = 32
MAVLINK2_OVERHEAD = 12
"""Bytes of a MAVLink 2 frame around its payload."""


class BulkPacer:
    """Decides when the next bulk frame may go to a peer. `rate` returns the bytes/s for one."""

    def __init__(self, rate: Callable[[Peer], float] = lambda peer: DEFAULT_RATE) -> None:
        self._rate = rate
        self._buckets: dict[Peer, tuple[float, TokenBucket]] = {}
        self._lossy: dict[Peer, None] = {}

    def note_loss(self, peer: Peer) -> None:
        """Note that frames to a peer were lost: it may be a router with a radio behind it."""
        self._lossy[peer] = None
        if len(self._lossy) > MAX_PEERS:
            del self._lossy[next(iter(self._lossy))]

    def is_lossy(self, peer: Peer) -> bool:
        """Return whether frames to a peer were lost in this conversation."""
        return peer in self._lossy

    def rate(self, peer: Peer) -> float:
        """Return the bytes/s to a peer now."""
        return self._rate(peer)

    def consume(self, peer: Peer, size: int, now: float) -> bool:
        """Return whether a frame of `size` bytes may go to `peer` now, and count it."""
        rate = self._rate(peer)
        known = self._buckets.get(peer)
        if known is None or known[0] != rate:
            burst = max(min(rate * BURST_TIME, BURST_MAX), codec.MAX_FRAME + rate * CYCLE)
            known = self._buckets[peer] = (rate, TokenBucket(rate, burst))
            if len(self._buckets) > MAX_PEERS:
                del self._buckets[next(iter(self._buckets))]
        return known[1].consume(now, max(size, min(rate, DEFAULT_RATE) / MAX_FRAME_RATE))
