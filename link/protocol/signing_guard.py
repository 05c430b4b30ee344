"""Signing on one link: which frames may be handled and in which role, and how ours are signed.

Frames are judged before anything else learns of them, so that a forged one neither takes a place nor counts as a
number of its sender. https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterable, Sequence
from typing import NamedTuple

import msgspec

from dialects import codec
from dialects.messages import Heartbeat, RadioStatus
from dialects.traits import NEWEST_ONLY, URGENT
from link.core import GuardReport, SigningCounts
from link.protocol.frame import Frame
from link.protocol.peer import PeerState, find_signing
from link.protocol.rate import SenderLimit
from link.signing.clock import FOLLOWED_MAX, TICKS
from link.signing.keys import MAX_KEYS, SigningKey
from link.signing.role import SigningRole
from link.signing.signature import is_signed, link_and_stamp
from link.signing.signing import FrameSigner, Signing
from link.signing.verifier import AHEAD_MAX, PINNED_FOR, Refusal, Verified

LANES = 4
"""Link ids of one link: a frame that overtakes others on the way (link/transport/priority_queue.py) must not make them
look replayed. Each class that keeps its order has its own."""
WATCHDOG_LANE = 128
"""First link id of the watchdog's process: it signs with the station's key and ids. Those below are the station's."""
ANSWER_PERIOD = 1.0
"""s between two HEARTBEATs to a sender whose time is refused, as between those to all others."""
COPY_DELAY = 5 * TICKS
"""How old a copy that a second link brings may be. A clock that is less behind catches up before it is missed."""
ANSWERS_MAX = 32
"""Senders that are answered so in that time."""


class SigningPolicy(msgspec.Struct, frozen=True):
    """What a program makes of frames that are not signed, or not well."""

    unsigned: SigningRole | None
    """What unsigned senders may do; None: their frames are dropped. RADIO_STATUS is used for flow control all the same,
    because telemetry radios cannot sign."""
    open_stops: bool = False
    """A stop is obeyed whoever sends it."""
    pinned_for: float = PINNED_FOR
    """s after a signed frame in which unsigned ones with the same ids are refused, whatever `unsigned` says."""
    greets_late: bool = False
    """A system whose clock is behind gets our frames all the same, from which it learns the time. Not for vehicles: an
    old HEARTBEAT would bring anybody telemetry; they answer it with one of their own."""
    announces: bool = False
    """The clock of a system may be any time ahead. If that is more than a day, it is followed once a report has said
    so. False, for vehicles: beyond a day it is refused by who knows the right time, and followed by who does not."""


class SigningContext(NamedTuple):
    """How frames to one peer are signed by another process in our place."""

    key: str
    """Name of the key; empty for unsigned frames."""
    lead: int
    """How far the receiver's clock is ahead, in timestamps."""
    link_id: int


UNSIGNED = 2
"""Place of unsigned frames in SigningCounts."""
_PLACES = {Refusal.BAD_SIGNATURE: 0, Refusal.REPLAYED: 1, Refusal.TOO_OLD: 3, Refusal.TOO_NEW: 3}
"""Why a signed frame is refused -> its place in SigningCounts."""


class Passed(NamedTuple):
    """A frame that may be handled."""

    frame: Frame
    role: SigningRole
    verified: Verified | None
    """None: it is not signed."""


def best_key(passed: Iterable[Passed]) -> SigningKey | None:
    """Return the key with the most rights of frames that arrived together; None if none of them is signed."""
    keys = (each.verified.key for each in passed if each.verified is not None)
    return max(keys, key=lambda key: key.role, default=None)


class Judged(msgspec.Struct):
    """Frames that arrived together, by what is done with them."""

    passed: list[Passed] = msgspec.field(default_factory=list)
    refused: list[Frame] = msgspec.field(default_factory=list)
    late: list[Frame] = msgspec.field(default_factory=list)
    """Genuine HEARTBEATs of systems whose clock is behind."""
    untimely: list[tuple[Frame, Refusal]] = msgspec.field(default_factory=list)
    """Genuine frames whose time is refused."""
    radio: list[Frame] = msgspec.field(default_factory=list)
    """Unsigned RADIO_STATUS, for flow control only."""


class SigningGuard:
    """Judges and signs the frames of one link. `index`: that of the link."""

    def __init__(self, signing: Signing, policy: SigningPolicy, index: int) -> None:
        self.policy = policy
        self._signing = signing
        self._first_id = index * LANES % WATCHDOG_LANE
        self._signer = FrameSigner(signing.clock)
        self._refused: dict[int, list[int]] = {}
        """System -> how many of its frames were refused, in the order of SigningCounts."""
        self._announced: set[SigningKey] = set()
        """Keys of clocks that are more than a day ahead, of which a report has said so."""
        self._answers = SenderLimit(ANSWER_PERIOD, ANSWERS_MAX)

    # ---- receiving ----

    def judge(self, frames: Sequence[Frame], now: float) -> Judged:
        """Sort frames by what may be done with them, and count those that are refused."""
        found = Judged()
        for frame in frames:
            if is_signed(frame[4]):
                self._judge_signed(frame, found, now)
            else:
                self._judge_unsigned(frame, found, now)
        return found

    def _judge_signed(self, frame: Frame, found: Judged, now: float) -> None:
        number, system, component, _, raw = frame
        verdict = self._signing.verifier.check(raw, system, component, now, any_future=self.policy.announces)
        if isinstance(verdict, Verified):
            found.passed.append(Passed(frame, verdict.key.role, verdict))
            return
        if verdict is Refusal.TOO_OLD and self.policy.greets_late and number == Heartbeat.id:
            found.late.append(frame)
        elif verdict is not Refusal.BAD_SIGNATURE and not self.policy.greets_late:
            found.untimely.append((frame, verdict))
        self._refuse(frame, _PLACES[verdict], found)

    def _judge_unsigned(self, frame: Frame, found: Judged, now: float) -> None:
        number, system, component, _, _ = frame
        role = self.policy.unsigned
        if role is not None and not self._is_pinned(system, component, now):
            found.passed.append(Passed(frame, role, None))
        elif number == RadioStatus.id:
            found.radio.append(frame)
        else:
            self._refuse(frame, UNSIGNED, found)

    def _refuse(self, frame: Frame, place: int, found: Judged) -> None:
        self._refused.setdefault(frame[1], [0, 0, 0, 0])[place] += 1
        found.refused.append(frame)

    def _is_pinned(self, system: int, component: int, now: float) -> bool:
        return self._signing.verifier.is_pinned(system, component, now, self.policy.pinned_for)

    def way_to(self, state: PeerState, now: float) -> SigningContext:
        """Return how frames to a peer are signed, for the watchdog, which goes on in our place."""
        key = self._key_for(state)
        lead = self._lead(state, key, now)
        return SigningContext("" if key is None else key.name, lead, WATCHDOG_LANE + self._first_id // LANES)

    def note_sender(self, state: PeerState, passed: Sequence[Passed], now: float) -> None:
        """Remember which key a peer uses, and the clock of that key."""
        for each in passed:
            if each.verified is not None:
                state.key, stamp = each.verified
                self._note_clock(state, state.key, stamp, now)

    def find_untimely(
        self, state: PeerState | None, untimely: Sequence[tuple[Frame, Refusal]], address: Hashable, now: float
    ) -> SigningKey | None:
        """Return the key of a sender that is to be answered with our time; None: with nothing.

        A replay at a place that has this key is a copy of a second link, unless it is older than those can be.
        """
        for frame, refusal in untimely:
            key = self._signing.verifier.find_key(frame[4])
            if key is None:
                continue
            behind = self._signing.verifier.time_of(key, now) - link_and_stamp(frame[4])[1]
            if refusal is Refusal.REPLAYED and state is not None and state.key == key and behind < COPY_DELAY:
                continue
            return key if self._answers.allow((address, key), now) else None
        return None

    def set_time(self, state: PeerState, key: SigningKey, now: float) -> None:
        """Sign to a peer with a key, and with the time that the frames of this key must have to be accepted here."""
        state.key, state.clocks = key, {}
        self._note_clock(state, key, self._signing.verifier.time_of(key, now), now)

    def _note_clock(self, state: PeerState, key: SigningKey, stamp: int, now: float) -> None:
        offset, before = stamp - now * TICKS, state.clocks.get(key, -math.inf)
        if self._signing.clock.synchronized and self._ahead(state, key, now) > AHEAD_MAX and not self.policy.announces:
            before = -math.inf  # from before the right time was known
        if stamp <= FOLLOWED_MAX and offset > before:
            if len(state.clocks) >= MAX_KEYS and key not in state.clocks:
                state.clocks.clear()  # of keys that are gone
            state.clocks[key] = offset

    # ---- sending ----

    def build_frame(self, number: int, payload: bytes, ids: tuple[int, int], state: PeerState, now: float) -> bytes:
        """Return a frame for a peer, with the key that it uses itself; unsigned if there is no key."""
        key = self._key_for(state)
        by = self._signing.hash_of(key)
        if by is None:
            return codec.frame(number, payload, state.sequence, *ids)
        frame = codec.frame_to_sign(number, payload, state.sequence, *ids)
        return self._signer.sign(frame, by, self._first_id + lane_of(number), self._lead(state, key, now), now)

    def signs_to(self, state: PeerState) -> bool:
        """Return whether frames to a peer are signed: MAVLink 1 has no signatures."""
        return self._signing.hash_of(self._key_for(state)) is not None

    def _key_for(self, state: PeerState) -> SigningKey | None:
        return state.key if self._signing.hash_of(state.key) else self._own_key

    def _lead(self, state: PeerState, key: SigningKey | None, now: float) -> int:
        """Return how far we sign ahead of our clock for a peer that uses a key, in timestamps."""
        lead = self._ahead(state, key, now)
        if lead <= AHEAD_MAX:
            return lead
        if self.policy.announces:
            return lead if key in self._announced else 0
        return 0 if self._signing.clock.synchronized else lead

    def _ahead(self, state: PeerState, key: SigningKey | None, now: float) -> int:
        if key is None or key not in state.clocks:
            return 0
        return max(0, round(state.clocks[key] + now * TICKS) - self._signing.clock.stamp(now))

    @property
    def _own_key(self) -> SigningKey | None:
        return self._signing.ring.signing_key

    # ---- reporting ----

    def counts(self) -> SigningCounts:
        """Return what was refused so far."""
        return SigningCounts(*map(sum, zip(*self._refused.values(), strict=True)))

    def report(self, states: Iterable[PeerState], now: float) -> GuardReport:
        """Return what is known of the systems behind these peers, and of those that were refused.

        From now on a clock that is more than a day ahead is followed: this says so.
        """
        states, key = list(states), self._own_key
        leads = [(state, self._ahead(state, state.key, now)) for state in states]
        self._announced.update(state.key for state, lead in leads if lead > AHEAD_MAX and state.key is not None)
        return GuardReport(
            key="" if key is None else f"{key.name} ({key.fingerprint})",
            refused={system: SigningCounts(*counts) for system, counts in self._refused.items()},
            behind=dict(self._signing.verifier.behind),
            ahead={system: lead / TICKS for state, lead in leads if lead for system in state.systems},
        )

    def find_verified(self, states: Iterable[PeerState]) -> frozenset[int]:
        """Return the systems whose newest frame was signed with a key that we have now."""
        return find_signing(state for state in states if self._signing.hash_of(state.key))


def lane_of(number: int) -> int:
    """Return the class of a message, by what may overtake it."""
    if number == Heartbeat.id:
        return 3
    if number in NEWEST_ONLY:
        return 2
    return 1 if number in URGENT else 0
