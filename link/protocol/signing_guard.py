"""Signing on one link: which frames may be handled and in which role, and how ours are signed.

Frames are judged before anything else learns of them, so that a forged one neither takes a place nor counts as a
number of its sender. https://mavlink.io/en/guide/message_signing.html
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import msgspec

from dialects import codec
from dialects.messages import Heartbeat, RadioStatus
from dialects.traits import NEWEST_ONLY, URGENT
from link.core import GuardReport, SigningCounts
from link.protocol.frame import Frame
from link.protocol.peer import PeerState, find_signing
from link.signing.clock import TICKS
from link.signing.keys import SigningKey
from link.signing.role import Role
from link.signing.signature import is_signed
from link.signing.signing import FrameSigner, Signing
from link.signing.verifier import PINNED_FOR, Refusal, Verified

LANES = 4
"""Link ids of one link: a frame that overtakes others on the way (link/transport/priority_queue.py) must not make them
look replayed. Each class that keeps its order has its own."""
WATCHDOG_LANE = 128
"""First link id of the watchdog's process: it signs with the station's key and ids. Those below are the station's."""
LEAD_MAX = 50 * 365 * 86400 * TICKS
"""How far a receiver's clock may be ahead for us to follow it; beyond that its timestamps are nearly used up."""


class SigningPolicy(msgspec.Struct, frozen=True):
    """What a program makes of frames that are not signed, or not well."""

    unsigned: Role | None
    """What unsigned senders may do; None: their frames are dropped. RADIO_STATUS is used for flow control all the same,
    because telemetry radios cannot sign."""
    open_stops: bool = False
    """A stop is obeyed whoever sends it."""
    pinned_for: float = PINNED_FOR
    """s after a signed frame in which unsigned ones with the same ids are refused, whatever `unsigned` says."""
    greets_late: bool = False
    """A system whose clock is behind gets our frames all the same, from which it learns the time. Not for vehicles: an
    old HEARTBEAT would bring anybody telemetry."""


class SigningWay(NamedTuple):
    """How frames to one peer are signed by another process in our place."""

    key: str
    """Name of the key; empty for unsigned frames."""
    lead: int
    """How far the receiver's clock is ahead, in timestamps."""
    link_id: int


UNSIGNED = 2
"""Place of unsigned frames in SigningCounts."""
_PLACES = {Refusal.BAD_SIGNATURE: 0, Refusal.REPLAYED: 1, Refusal.TOO_OLD: 3}
"""Why a signed frame is refused -> its place in SigningCounts."""


class Passed(NamedTuple):
    """A frame that may be handled."""

    frame: Frame
    role: Role
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
        verdict = self._signing.verifier.check(raw, system, component, now)
        if isinstance(verdict, Verified):
            found.passed.append(Passed(frame, verdict.key.role, verdict))
            return
        if verdict is Refusal.TOO_OLD and self.policy.greets_late and number == Heartbeat.id:
            found.late.append(frame)
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

    def way_to(self, state: PeerState) -> SigningWay:
        """Return how frames to a peer are signed, for the watchdog, which goes on in our place."""
        key = state.key if self._signing.hash_of(state.key) else self._own_key
        return SigningWay("" if key is None else key.name, state.lead, WATCHDOG_LANE + self._first_id // LANES)

    def note_sender(self, state: PeerState, passed: Sequence[Passed], now: float) -> None:
        """Remember which key a peer uses, and how far its clock is ahead."""
        for each in passed:
            if each.verified is not None:
                state.key = each.verified.key
                lead = each.verified.stamp - self._signing.clock.stamp(now)
                if state.lead < lead <= LEAD_MAX:
                    state.lead = lead

    # ---- sending ----

    def build_frame(self, number: int, payload: bytes, ids: tuple[int, int], state: PeerState, now: float) -> bytes:
        """Return a frame for a peer, with the key that it uses itself; unsigned if there is no key."""
        key = self._signing.hash_of(state.key) or self._signing.hash_of(self._own_key)
        if key is None:
            return codec.frame(number, payload, state.sequence, *ids)
        frame = codec.frame_to_sign(number, payload, state.sequence, *ids)
        return self._signer.sign(frame, key, self._first_id + lane_of(number), state.lead, now)

    @property
    def _own_key(self) -> SigningKey | None:
        return self._signing.ring.signing_key

    # ---- reporting ----

    def counts(self) -> SigningCounts:
        """Return what was refused so far."""
        return SigningCounts(*map(sum, zip(*self._refused.values(), strict=True)))

    def report(self, states: Iterable[PeerState]) -> GuardReport:
        """Return what is known of the systems behind these peers, and of those that were refused."""
        key = self._own_key
        return GuardReport(
            key="" if key is None else f"{key.name} ({key.fingerprint})",
            refused={system: SigningCounts(*counts) for system, counts in self._refused.items()},
            behind=dict(self._signing.verifier.behind),
            ahead={system: state.lead / TICKS for state in states if state.lead for system in state.systems},
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
