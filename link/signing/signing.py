"""What all links of one program share for signing: keys, clock, streams; and what is kept for the next run."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from link.signing.clock import TICKS, SigningClock
from link.signing.keys import KeyRing, SigningKey
from link.signing.signature import STAMP_MAX, SecretHash
from link.signing.streams import SignedStream, Span, StreamTable
from link.signing.verifier import AHEAD_MAX, NEW_STREAM_WINDOW, Verifier

CRASH_TIME = NEW_STREAM_WINDOW / TICKS
"""s after a start for which frames from before a crash could be young enough. With a clock that is not set nothing
shortens that window: it begins BOOT_LEAD ahead, and the frames of the operator would be refused as well."""


@dataclass(frozen=True)
class SigningMemory:
    """What one run keeps for the next, so that nothing that was accepted once is accepted again."""

    stamp: int = 0
    """Time of the signing clock, 10 us since 2015-01-01; 0: no earlier run."""
    newest: Mapping[SignedStream, int] = field(default_factory=dict)
    floors: Mapping[str, int] = field(default_factory=dict)
    """Of streams that lost their place (streams.py)."""
    spans: tuple[Span, ...] = ()
    """Of clocks that were years ahead (streams.py)."""
    ended: bool = False
    """The run has ended in order: nothing was accepted after this."""


class Signing:
    """Keys, clock and streams of one program. `wall`: Unix time in s; `now`: s of a monotonic clock."""

    def __init__(
        self,
        ring: KeyRing,
        *,
        wall: float,
        now: float,
        memory: SigningMemory | None = None,
        synchronized: bool = False,
    ) -> None:
        """Go on from `memory`. `synchronized`: see SigningClock.update()."""
        kept = memory or SigningMemory()
        self.clock = SigningClock(wall, now, kept.stamp, synchronized=synchronized)
        self.ring = ring
        crashed = self.clock.trusted and kept.stamp > 0 and not kept.ended
        streams, crash_until = (
            StreamTable(kept.newest, kept.floors, kept.spans),
            now + CRASH_TIME if crashed else -math.inf,
        )
        self.verifier = Verifier(ring.keys, self.clock, streams, crash_until=crash_until)
        self._hashes = _hash_all(ring)
        self._heal(now)

    def set_ring(self, ring: KeyRing) -> None:
        """Use these keys from now on, for example after one was withdrawn."""
        self.ring = ring
        self._hashes = _hash_all(ring)
        self.verifier.set_keys(ring.keys)

    def update(self, wall: float, now: float, *, synchronized: bool = False) -> None:
        """Follow the computer's clock. Call it once a second. `synchronized`: see SigningClock.update()."""
        before = self.clock.synchronized
        self.clock.update(wall, now, synchronized=synchronized)
        if not before:
            self._heal(now)

    def memory(self, now: float, *, ended: bool = False) -> SigningMemory:
        """Return what to keep for the next run. `ended`: this one accepts nothing more."""
        streams = self.verifier.streams
        newest, floors, spans = dict(streams.newest), dict(streams.floors), tuple(streams.spans)
        return SigningMemory(self.clock.stamp(now), newest, floors, spans, ended)

    def hash_of(self, key: SigningKey | None) -> SecretHash | None:
        """Return what signs with a key of the ring; None without a key, or if the ring no longer has its secret.

        A key that has the name of one that was removed is another key.
        """
        return None if key is None else self._hashes.get(key.secret)

    def _heal(self, now: float) -> None:
        """End what a clock of years ahead has left behind, as soon as the right time is known."""
        if self.clock.synchronized:
            self.verifier.streams.heal(self.clock.stamp(now), AHEAD_MAX)


def _hash_all(ring: KeyRing) -> dict[bytes, SecretHash]:
    return {key.secret: SecretHash(key.secret) for key in ring.keys}


class FrameSigner:
    """Signs the frames of one link; their timestamps rise, and advance with the clock."""

    def __init__(self, clock: SigningClock) -> None:
        self._clock = clock
        self._last = 0

    def sign(self, frame: bytes, by: SecretHash, link_id: int, lead: int, now: float) -> bytes:
        """Return a frame (codec.frame_to_sign) with its signature.

        `lead`: how far the receiver's clock is ahead of ours, in timestamps.
        """
        self._last = max(self._clock.stamp(now), self._last + 1)
        return by.sign(frame, link_id, min(self._last + lead, STAMP_MAX))
