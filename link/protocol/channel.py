"""MAVLink channel of one link: bytes to messages and back, with peers, sequence numbers, rate limits.

Rules: only a valid frame creates a peer; a peer gets no telemetry before its first HEARTBEAT; a reply is never longer
than the request allows; every table is bounded. A repeated frame has no second effect. Of state messages (all but
dialects.traits.ACKED) one that a newer one has overtaken is dropped. A stop is handed on whoever sends it, also when
all places are taken, and can be answered.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Iterator, Sequence

from dialects import codec
from dialects.messages import (
    FileTransferProtocol,
    Heartbeat,
    ManualControl,
    Message,
    Ping,
    RadioStatus,
    Timesync,
    target_system,
)
from dialects.traits import ACKED, COMMANDS, DEMANDS, is_stop
from link.core import LinkReport, Outgoing, Peer, Received
from link.protocol.address_budget import AddressBudget
from link.protocol.flow_control import FlowControl
from link.protocol.frame import Frame, find_mismatches, noise_hint, sum_counts
from link.protocol.framer import Framer
from link.protocol.log_tap import LogTap
from link.protocol.peer import ONE, PeerState, count_sources, find_signing, find_version_1
from link.protocol.peer_table import MAX_PEERS, PeerTable
from link.protocol.sent_frames import SentFrames
from link.protocol.sequence import NEW, FrameOrder
from link.protocol.signing_guard import Passed, SigningContext, SigningGuard, best_key
from link.protocol.stops import find_stops
from link.signing.role import SigningRole

_RADIO_STATUS: int = RadioStatus.id
_RATE_CLASS = {**dict.fromkeys(DEMANDS, "demand"), **dict.fromkeys(COMMANDS, "command")}
"""Message id -> the token bucket that limits it; all other messages share one."""
_RATE_CLASS_OF_STATIONS = {**_RATE_CLASS, FileTransferProtocol.id: "file"}


_ANSWERS = frozenset({Ping.id, Timesync.id})
MAX_ANSWERS = 32
"""Answers to PING that wait for the next tick."""
LOOK_WITHIN = 2.0
"""s until a vehicle that is looked at sends everything."""


class Channel:
    """Turns received bytes into Received, and Outgoing into bytes.

    `system` and `component` (1..255) are ours. `stream`: bytes have no datagram boundaries. `wanted`: message ids that
    the core handles (None: all); others are counted and not decoded. `target`: the address that the user named, for
    links that send first. `capacity`: bytes/s that the link carries, where known. `sent`: shared by all channels.
    `downloads`: files may come faster than other messages; a vehicle serves them and expects requests only.
    `places`: peers at once. `first_sequence`: packet sequence of the first frame to each. `named`: an address is the
    name of its program in a fleet. `bounded`: an address of datagrams gets a little only until it has shown that it
    receives (address_budget.py). `guard`: verifies and signs; None: frames are neither verified nor signed.
    """

    def __init__(
        self,
        name: str,
        index: int,
        *,
        system: int,
        component: int,
        stream: bool = False,
        wanted: frozenset[int] | None = None,
        target: Hashable | None = None,
        capacity: float | None = None,
        sent: SentFrames | None = None,
        places: int = MAX_PEERS,
        first_sequence: int = 0,
        downloads: bool = False,
        named: bool = False,
        bounded: bool = False,
        guard: SigningGuard | None = None,
    ) -> None:
        self.name = name
        self.index = index
        self.ids = (system, component)
        self.log_tap: LogTap | None = None
        """Records every frame that arrives."""
        self._capacity = capacity
        self._sent = sent or SentFrames()
        self.guard = guard
        """May be replaced while the link is open: the first key may come later."""
        self._flow = FlowControl()
        self._stream = stream
        self._wanted = wanted
        self._rate_class = _RATE_CLASS_OF_STATIONS if downloads else _RATE_CLASS
        self._new_peer_framer = Framer(stream=False)
        self._peers = PeerTable(
            index, stream=stream, places=places, first_sequence=first_sequence, named=named, bounded=bounded
        )
        self._answers_ping = wanted is None or Ping.id not in wanted
        self._answers: list[tuple[PeerState, Ping]] = []
        """Answers to PING, by which a vehicle sees that this program receives, where the core does not answer."""
        self._bytes_received = 0
        self._duplicates = self._late = self._rate_limited = self._withheld = 0
        self._own_id = False
        self._untimely: list[Peer] = []
        self._proven: set[int] = set()
        """Ids of messages that have arrived damaged and whole, so that the damage is not a mismatch of dialects."""
        self._interesting: frozenset[int] | None = None
        if target is not None:
            self._peers.add_fixed(target)

    # ---- receiving ----

    def receive(self, data: bytes, address: Hashable, now: float) -> list[Received]:
        """Return the messages in `data` from `address`; a new connection comes with empty `data`."""
        self._bytes_received += len(data)
        state = self._peers.get(address)
        if self.guard is not None:
            return self._receive_guarded(self.guard, state, data, address, now)
        if state is not None:
            return self._accept(state, state.framer.feed(data, now), now)
        frames = self._new_peer_framer.feed(data, now)
        if not frames and not self._stream:
            return []
        state = self._peers.admit(address, frames, now)
        if state is None:
            return self._accept_stops(frames, address, now)
        return self._accept(state, state.framer.feed(data, now) if self._stream else frames, now)

    def pop_untimely(self) -> list[Peer]:
        """Return the senders of genuine frames whose time was refused, to be answered with a HEARTBEAT at once.

        It is signed with their key and with the time that is accepted here: a ground station learns it so. One each
        second and sender.
        """
        untimely, self._untimely = self._untimely, []
        return untimely

    def tick(self, now: float) -> list[Received]:
        """Give up overdue partial frames and return the messages found behind them."""
        if not self._stream:
            return []
        found: list[Received] = []
        for state in self._peers:
            frames = state.framer.expire(now)
            if self.guard is None:
                found += self._accept(state, frames, now)
            elif frames:
                found += self._judge(self.guard, state, frames, state.peer.address, now)
        return found

    def handle_disconnect(self, address: Hashable) -> None:
        """Handle the end of the connection to `address`.

        A partial frame is lost, and the next peer there must send its HEARTBEAT.
        """
        self._peers.end_connection(address)

    def set_interest(self, systems: frozenset[int] | None, now: float) -> None:
        """Set the system ids that send everything; what others leave out is not lost. None: all do."""
        self._interesting = systems
        for state in self._peers:
            for (system, _), source in state.sources.items():
                source.expect_gaps(self._gaps_until(system, now + LOOK_WITHIN))

    def _gaps_until(self, system: int, otherwise: float) -> float:
        """Return until when the numbers of a system have gaps: always while it is not looked at."""
        return math.inf if self._interesting is not None and system not in self._interesting else otherwise

    def reserve(self, ids: tuple[int, int] | None) -> None:
        """Keep places for the system and component id of the ground station in control; None: for nobody."""
        self._peers.reserved_ids = ids

    def _receive_guarded(
        self, guard: SigningGuard, state: PeerState | None, data: bytes, address: Hashable, now: float
    ) -> list[Received]:
        if state is None and self._stream:
            state = self._peers.admit(address, (), now)
        framer = self._new_peer_framer if state is None else state.framer
        return self._judge(guard, state, framer.feed(data, now), address, now)

    def _judge(
        self, guard: SigningGuard, state: PeerState | None, frames: list[Frame], address: Hashable, now: float
    ) -> list[Received]:
        """Return the messages of the frames that are signed well or need not be, and stops if they are open to all."""
        judged = guard.judge(frames, now)
        for frame in judged.radio:
            self._flow.handle_frame(frame[4], now)
        for frame in judged.late:
            self._greet(frame, address, now)
        if judged.untimely and (key := guard.find_untimely(state, judged.untimely, address, now)) is not None:
            sender = self._peers.admit_untimely(address, now)
            guard.set_time(sender, key, now)
            self._untimely.append(sender.peer)
        accepted = self._accept_stops(judged.refused, address, now) if guard.policy.open_stops else []
        passed = [each.frame for each in judged.passed]
        state = state or (self._peers.admit(address, passed, now, best_key(judged.passed)) if passed else None)
        if state is None:
            stops = self._accept_stops(passed, address, now)
            if stops:
                guard.note_sender(self._peers.admit_transient(address, now), judged.passed, now)
            return accepted + stops
        guard.note_sender(state, judged.passed, now)
        return accepted + self._accept(state, passed, now, judged.passed)

    def _greet(self, frame: Frame, address: Hashable, now: float) -> None:
        """Send to a system whose HEARTBEAT is genuine but late, and handle nothing of it."""
        state = self._peers.get(address) or self._peers.admit(address, (frame,), now)
        if state is not None:
            state.last_seen, state.silent = now, False
            state.systems.add(frame[1])

    def _accept(
        self, state: PeerState, frames: list[Frame], now: float, judged: Sequence[Passed] | None = None
    ) -> list[Received]:
        """Return the messages of frames. `judged`: what signing says of each; None: nothing is verified."""
        accepted: list[Received] = []
        if self.log_tap is not None and frames:
            self.log_tap.record_received(frames, self.index, now)
        for index, frame in enumerate(frames):
            number, system, component, sequence, raw = frame
            sender = (system, component)
            if not system or sender == self.ids:  # component 0 is valid: pymavlink sends it by default
                self._own_id |= sender == self.ids and raw not in self._sent
                continue
            state.last_seen, state.silent = now, False
            state.note_frame(system, raw)
            self._prove(state, frame, verified=judged is not None and judged[index].verified is not None)
            digest = hash(raw)
            source = state.sources.get(sender)
            if source is None:
                source = state.add_source(frame, digest, now)
                if source is not None:
                    source.expect_gaps(self._gaps_until(system, -math.inf))
            elif (order := source.accept(sequence, number, digest, now)) is not NEW and self._is_old(order, frame):
                continue
            message = self._decode(state, frame, now)
            if message is None:
                continue
            numbering, clash = (source.numbering.index, source.clash) if source else (0, False)
            introduced, named = system in state.systems, state.is_expected
            role = SigningRole.SET_UP if judged is None else judged[index].role
            verified = judged is not None and judged[index].verified is not None
            received = Received(message, system, component, sequence, state.peer, introduced, named, numbering, clash,
                                digest, role, verified)  # fmt: skip
            accepted.append(received)
        return accepted

    def _prove(self, state: PeerState, frame: Frame, *, verified: bool) -> None:
        """Note what a frame shows of the address that it came from, and the questions of others about ours."""
        number, _, _, _, raw = frame
        if (budget := state.budget) is not None and not budget.proven:
            budget.grant(number, len(raw))
            budget.proven = verified
            if number in _ANSWERS:
                budget.note_answer(codec.decode_frame(number, raw))
        if number == Ping.id and self._answers_ping and len(self._answers) < MAX_ANSWERS:
            ping = codec.decode_frame(number, raw)
            if isinstance(ping, Ping) and not ping.target_system:
                self._answers.append((state, Ping(ping.time_usec, ping.seq, frame[1], frame[2])))

    def _accept_stops(self, frames: list[Frame], address: Hashable, now: float) -> list[Received]:
        """Return the stops among the frames of a sender for whom there is no place; all else is dropped."""
        accepted: list[Received] = []
        for frame, message in find_stops(frames, self.ids, self._wanted):
            _, system, component, sequence, _ = frame
            if self.log_tap is not None:
                self.log_tap.record_received([frame], self.index, now)
            peer = self._peers.admit_transient(address, now).peer
            accepted.append(Received(message, system, component, sequence, peer, introduced=False))
        return accepted

    def _is_old(self, order: FrameOrder, frame: Frame) -> bool:
        """Count a repeated or overtaken frame; return whether to drop it.

        ACKED messages are never too late, and a stop is never a repeat: a simple script gives each frame the number 0.
        """
        number, _, _, _, raw = frame
        if order is FrameOrder.DUPLICATE:
            self._duplicates += 1
            return number not in COMMANDS or not is_stop(codec.decode_frame(number, raw))
        self._late += 1
        return number not in ACKED

    def _decode(self, state: PeerState, frame: Frame, now: float) -> Message | None:
        number, system, _, _, raw = frame
        if number == _RADIO_STATUS:
            self._flow.handle_frame(raw, now)
        if self._wanted is not None and number not in self._wanted:
            return None
        kind = self._rate_class.get(number, "rest")
        room = state.buckets[kind].consume(now)
        if not room and kind != "command":
            self._rate_limited += 1
            return None
        message = codec.decode_frame(number, raw)
        if not room and not is_stop(message):  # a stop passes whatever else its sender floods us with
            self._rate_limited += 1
            return None
        if number == Heartbeat.id:
            state.systems.add(system)
        return message

    # ---- sending ----

    def send(
        self, outgoing: Outgoing, payload: bytes | None = None, now: float = 0.0
    ) -> Iterator[tuple[bytes, Hashable, int]]:
        """Yield the frames to send: bytes, address, packet sequence.

        Each peer has its own sequence, so that a frame for one is not a loss to the others. `payload` is the encoded
        message, where it exists already, as for another link. `now` counts for signatures only. Raises
        codec.EncodeError.
        """
        message = outgoing.message
        number = type(message).id
        payload, target = codec.encode_payload(message) if payload is None else payload, target_system(message)
        for state in self._peers.recipients(outgoing):
            for version in state.versions(number, target):
                if state.budget is None or self._take(state.budget, number, len(payload) + self._around(state)):
                    sequence = state.sequence
                    yield self._build(number, payload, state, now, version), state.peer.address, sequence

    def may_send(self, number: int, size: int, address: Hashable) -> bool:
        """Return whether a message may go to an address now, and count it: see `bounded`."""
        state = self._peers.get(address)
        return state is None or state.budget is None or self._take(state.budget, number, size)

    def _take(self, budget: AddressBudget, number: int, size: int) -> bool:
        taken = budget.take(number, size)
        self._withheld += not taken
        return taken

    def _around(self, state: PeerState) -> int:
        """Return the bytes around a payload in a frame to a peer."""
        signs = self.guard is not None and self.guard.signs_to(state)
        return codec.HEADER_V2 + codec.CRC_SIZE + (codec.SIGNATURE_SIZE if signs else 0)

    def questions(self, now: float) -> Iterator[tuple[bytes, Hashable]]:
        """Yield what asks the addresses that have shown nothing yet, and answers to others who ask us so."""
        answers, self._answers = self._answers, []
        asked = [
            (state, message)
            for state in self._peers
            if state.budget is not None and state.systems
            for message in state.budget.questions(now)
        ]
        for state, message in (*answers, *asked):
            data = self._build(type(message).id, codec.encode_payload(message), state, now)
            yield data, state.peer.address

    def _build(self, number: int, payload: bytes, state: PeerState, now: float, version: int = 2) -> bytes:
        if version == 1 and not (self.guard is not None and self.guard.signs_to(state)):
            data = codec.frame_v1(number, payload, state.sequence, *self.ids)
        elif self.guard is None:
            data = codec.frame(number, payload, state.sequence, *self.ids)
        else:
            data = self.guard.build_frame(number, payload, self.ids, state, now)
        state.sequence = (state.sequence + 1) & 0xFF
        self._sent.add(data)
        return data

    def speaks_version_1(self, address: Hashable, system: int) -> bool:
        """Return whether frames to a system at an address go as MAVLink 1."""
        state = self._peers.get(address)
        signs = self.guard is not None and state is not None and self.guard.signs_to(state)
        return state is not None and not signs and state.versions(ManualControl.id, system) == ONE

    def signing_way(self, address: Hashable, now: float) -> SigningContext | None:
        """Return how frames to an address are signed; None if they are not."""
        state = self._peers.get(address)
        return None if self.guard is None or state is None else self.guard.way_to(state, now)

    # ---- reporting ----

    def expire_peers(self, now: float) -> None:
        """Drop peers that have been silent for PEER_SILENCE."""
        self._peers.expire(now)

    def report(self, down: str | None = None, *, now: float = 0.0, dropped: int = 0) -> LinkReport:
        """Return the counters of this channel. `down` and `dropped` come from the transport."""
        counts = sum_counts(
            [self._peers.past_counts, self._new_peer_framer.counts, *(state.framer.counts for state in self._peers)]
        )
        frames, noisy = counts.frames + counts.unknown, self._capacity is not None
        hint = noise_hint(self.name, self._bytes_received, frames) if noisy else None
        self._proven.update(filter(self._has_received, counts.mismatches))
        return LinkReport(
            name=self.name,
            index=self.index,
            peers=sum(1 for state in self._peers if state.systems),
            frames=counts.frames,
            bytes_received=self._bytes_received,
            crc_errors=counts.crc_errors,
            resync_bytes=counts.resync_bytes,
            unknown=counts.unknown,
            unknown_ids=counts.unknown_ids,
            duplicates=self._duplicates,
            late=self._late,
            rate_limited=self._rate_limited,
            refused_peers=self._peers.refused,
            dialect_mismatch=find_mismatches(counts, self._proven),
            signing=find_signing(self._peers),
            verified=self.guard.find_verified(self._peers) if self.guard else frozenset(),
            refused=self.guard.counts() if self.guard else None,
            guard=self.guard.report(self._peers, now) if self.guard else None,
            own_id=self._own_id,
            version_1=find_version_1(self._peers),
            down=down or hint,
            capacity=self._capacity,
            headroom=self._flow.headroom(now) if self._capacity is not None else 1.0,
            dropped=dropped + self._withheld,
            sources=count_sources(self._peers),
            audience=tuple(state.peer for state in self._peers if state.accepts_target(0)),
        )

    def _has_received(self, message_id: int) -> bool:
        """Return whether a message has arrived with the right checksum, from anybody who still sends."""
        return any(source.has_received(message_id) for state in self._peers for source in state.sources.values())
