"""Decides which signed frames are genuine and new: the signature first, then the timestamp.

A frame with a wrong signature changes nothing here. https://mavlink.io/en/guide/message_signing.html

On a computer whose clock is not set each key has a time of its own: the newest that it has signed in this run. Its new
streams are compared with that, so that the holder of one key, with a wrong clock or on purpose, locks out no other.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum, auto
from typing import NamedTuple

from link.signing.clock import DAY, FOLLOWED_MAX, TICKS, SigningClock
from link.signing.keys import SigningKey
from link.signing.signature import SecretHash, link_and_stamp
from link.signing.streams import MAX_STREAMS, SignedStream, StreamTable

NEW_STREAM_WINDOW = 60 * TICKS
"""How far the first timestamp of a stream in this run may be behind our clock: the specification's minute."""
CRASH_WINDOW = 5 * TICKS
"""The same in the first minute after a crash, when the newest timestamps of the last run are not known."""
AHEAD_MAX = DAY
"""How far a timestamp may be ahead of the right time (SigningClock.synchronized): more than a wrong time zone."""
PINNED_FOR = 10.0
"""s after a signed frame in which unsigned ones with the same system and component id are refused."""


class Refusal(Enum):
    """Why a signed frame is not accepted."""

    BAD_SIGNATURE = auto()
    """No known key made it, or it was changed on the way."""
    REPLAYED = auto()
    """Its timestamp is not newer than those before it."""
    TOO_OLD = auto()
    """It begins a stream more than a minute behind our clock: recorded long ago, or the sender's clock is wrong."""
    TOO_NEW = auto()
    """It is more than a day ahead of the right time: the sender's clock is wrong."""


class Verified(NamedTuple):
    """A frame that is genuine and new."""

    key: SigningKey
    stamp: int
    """Timestamp, 10 us since 2015-01-01."""


class _Known:
    """A key with what its checks need at once."""

    __slots__ = ("fingerprint", "hash", "key")

    def __init__(self, key: SigningKey) -> None:
        self.key = key
        self.hash = SecretHash(key.secret)
        self.fingerprint = key.fingerprint


class Verifier:
    """The keys of one program and the streams of all its links: what one link has brought is a replay on another."""

    def __init__(
        self,
        keys: Sequence[SigningKey],
        clock: SigningClock,
        streams: StreamTable | None = None,
        *,
        crash_until: float = -math.inf,
    ) -> None:
        """`crash_until`: until then the window of new streams is CRASH_WINDOW."""
        self._crash_until = crash_until
        self._clock = clock
        self.streams = streams or StreamTable()
        self._known: list[_Known] = []
        self._senders: dict[tuple[int, int], tuple[_Known, float]] = {}
        """System and component -> the key of their newest frame, and when that came."""
        self._offsets: dict[str, float] = {}
        """Fingerprint -> the largest difference of its timestamps to the monotonic clock, in timestamps."""
        self.behind: dict[int, float] = {}
        """System -> s by which its clock was behind ours in its newest frame that was too old."""
        self.set_keys(keys)

    def set_keys(self, keys: Sequence[SigningKey]) -> None:
        """Use these keys from now on. What is known of keys that are gone is forgotten."""
        before = {each.key: each for each in self._known}
        self._known = [before.get(key) or _Known(key) for key in keys]  # a role that has changed is another key
        self._senders = {ids: each for ids, each in self._senders.items() if each[0] in self._known}
        fingerprints = {each.fingerprint for each in self._known}
        self._offsets = {key: offset for key, offset in self._offsets.items() if key in fingerprints}
        self.streams.keep_keys(fingerprints)

    def check(
        self, frame: bytes, system: int, component: int, now: float, *, any_future: bool = False
    ) -> Verified | Refusal:
        """Return whose frame this is, or why it is not accepted. `frame` is signed and whole, its checksum right.

        `any_future`: timestamps ahead of the right time are accepted, too.
        """
        ids = (system, component)
        before = self._senders.get(ids)
        known = before[0] if before is not None and before[0].hash.matches(frame) else self._find(frame)
        if known is None:
            return Refusal.BAD_SIGNATURE
        link_id, stamp = link_and_stamp(frame)
        stream = SignedStream(known.fingerprint, system, component, link_id)
        streams = self.streams
        if streams.is_replay(stream, stamp):
            return Refusal.REPLAYED
        if not streams.is_running(stream) and self._is_too_old(stream, stamp, now):
            return Refusal.TOO_OLD
        if self._clock.synchronized and not any_future and stamp > self._clock.stamp(now) + AHEAD_MAX:
            return Refusal.TOO_NEW
        streams.record(stream, stamp)
        self._note_sender(ids, known, now)
        if stamp <= FOLLOWED_MAX:
            offset = stamp - now * TICKS
            self._offsets[known.fingerprint] = max(offset, self._offsets.get(known.fingerprint, offset))
        return Verified(known.key, stamp)

    def find_key(self, frame: bytes) -> SigningKey | None:
        """Return the key that has signed a frame; None if it is none of ours."""
        known = self._find(frame)
        return None if known is None else known.key

    def time_of(self, key: SigningKey, now: float) -> int:
        """Return the time after which frames of a key are accepted in every stream, as a timestamp."""
        fingerprint = key.fingerprint
        return max(self._reference(fingerprint, now), self.streams.newest_of(fingerprint))

    def is_pinned(self, system: int, component: int, now: float, within: float = PINNED_FOR) -> bool:
        """Return whether a sender has signed `within` s, so that unsigned frames with its ids are somebody else's."""
        sender = self._senders.get((system, component))
        return sender is not None and now - sender[1] <= within

    def _find(self, frame: bytes) -> _Known | None:
        return next((each for each in self._known if each.hash.matches(frame)), None)

    def _reference(self, fingerprint: str, now: float) -> int:
        """Return the time with which a new stream of a key is compared."""
        own = self._clock.stamp(now)
        if self._clock.trusted or fingerprint not in self._offsets:
            return own
        return max(own, int(now * TICKS + self._offsets[fingerprint]))

    def _is_too_old(self, stream: SignedStream, stamp: int, now: float) -> bool:
        system, behind = stream.system, self._reference(stream.key, now) - stamp
        if behind <= (CRASH_WINDOW if now < self._crash_until else NEW_STREAM_WINDOW):
            self.behind.pop(system, None)
            return False
        self.behind[system] = behind / TICKS
        return True

    def _note_sender(self, ids: tuple[int, int], known: _Known, now: float) -> None:
        if ids not in self._senders and len(self._senders) >= MAX_STREAMS:
            del self._senders[next(iter(self._senders))]
        self._senders[ids] = known, now
