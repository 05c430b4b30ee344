"""MAVLink channel of one link: bytes to messages and back, with peers, sequence numbers, rate limits.

Rules: only a valid frame creates a peer; a peer gets no telemetry before its first HEARTBEAT; a reply is never longer
than the request allows; every table is bounded. A repeated frame has no second effect. Of state messages (all but
dialects.traits.ACKED) one that a newer one has overtaken is dropped. A stop is handed on whoever sends it, also when
all places are taken, and can be answered.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator

from dialects import codec
from dialects.messages import MESSAGES, Heartbeat, Message, RadioStatus
from dialects.traits import ACKED, COMMANDS, DEMANDS, is_stop
from link.core import LinkReport, Outgoing, Received
from link.protocol.flow_control import FlowControl
from link.protocol.frame import Frame, FramerCounts, noise_hint, payload_of
from link.protocol.framer import Framer
from link.protocol.log_tap import LogTap
from link.protocol.peer import PeerState, count_sources, find_signing
from link.protocol.peer_table import MAX_PEERS, PeerTable
from link.protocol.sent_frames import SentFrames
from link.protocol.sequence import NEW, FrameOrder
from link.protocol.stops import find_stops

MISMATCH_AFTER = 3
"""Complete frames with a foreign checksum that prove another dialect; a single one may be an accident."""

_RADIO_STATUS: int = RadioStatus.id
_RATE_CLASS = {**dict.fromkeys(DEMANDS, "demand"), **dict.fromkeys(COMMANDS, "command")}
"""Message id -> the token bucket that limits it; all other messages share one."""


class Channel:
    """Turns received bytes into Received, and Outgoing into bytes.

    `system` and `component` (1..255) are ours. `stream`: bytes have no datagram boundaries. `wanted`: message ids that
    the core handles (None: all); others are counted and not decoded. `target`: the address that the user named, for
    links that send first. `capacity`: bytes/s that the link carries, where known. `sent`: shared by all channels.
    `places`: peers at once.
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
    ) -> None:
        self.name = name
        self.index = index
        self.ids = (system, component)
        self.log_tap: LogTap | None = None
        """Records every frame that arrives."""
        self._capacity = capacity
        self._sent = sent or SentFrames()
        self._flow = FlowControl()
        self._stream = stream
        self._wanted = wanted
        self._new_peer_framer = Framer(stream=False)
        self._peers = PeerTable(index, stream=stream, places=places)
        self._bytes_received = 0
        self._duplicates = self._late = self._rate_limited = 0
        self._own_id = False
        if target is not None:
            self._peers.add_fixed(target)

    # ---- receiving ----

    def receive(self, data: bytes, address: Hashable, now: float) -> list[Received]:
        """Return the messages in `data` from `address`; a new connection comes with empty `data`."""
        self._bytes_received += len(data)
        state = self._peers.get(address)
        if state is not None:
            return self._accept(state, state.framer.feed(data, now), now)
        frames = self._new_peer_framer.feed(data, now)
        if not frames and not self._stream:
            return []
        state = self._peers.admit(address, frames, now)
        if state is None:
            return self._accept_stops(frames, address, now)
        return self._accept(state, state.framer.feed(data, now) if self._stream else frames, now)

    def tick(self, now: float) -> list[Received]:
        """Give up overdue partial frames and return the messages found behind them."""
        if not self._stream:
            return []
        found: list[Received] = []
        for state in self._peers:
            found += self._accept(state, state.framer.expire(now), now)
        return found

    def handle_disconnect(self, address: Hashable) -> None:
        """Handle the end of the connection to `address`.

        A partial frame is lost, and the next peer there must send its HEARTBEAT.
        """
        self._peers.end_connection(address)

    def reserve(self, ids: tuple[int, int] | None) -> None:
        """Keep places for the system and component id of the ground station in control; None: for nobody."""
        self._peers.reserved_ids = ids

    def _accept(self, state: PeerState, frames: list[Frame], now: float) -> list[Received]:
        accepted: list[Received] = []
        if self.log_tap is not None and frames:
            self.log_tap.record_received(frames, now)
        for frame in frames:
            number, system, component, sequence, raw = frame
            sender = (system, component)
            if not system or sender == self.ids:  # component 0 is valid: pymavlink sends it by default
                self._own_id |= sender == self.ids and raw not in self._sent
                continue
            state.last_seen, state.silent = now, False
            state.newest[system] = raw
            digest = hash(raw)
            source = state.sources.get(sender)
            if source is None:
                source = state.add_source(frame, digest, now)
            elif (order := source.accept(sequence, number, digest, now)) is not NEW and self._is_old(order, frame):
                continue
            message = self._decode(state, frame, now)
            if message is None:
                continue
            numbering, clash = (source.numbering.index, source.clash) if source else (0, False)
            known = system in state.systems
            accepted.append(
                Received(
                    message, system, component, sequence, state.peer, known, state.is_expected, numbering, clash, digest
                )
            )
        return accepted

    def _accept_stops(self, frames: list[Frame], address: Hashable, now: float) -> list[Received]:
        """Return the stops among the frames of a sender for whom there is no place; all else is dropped."""
        accepted: list[Received] = []
        for frame, message in find_stops(frames, self.ids, self._wanted):
            _, system, component, sequence, _ = frame
            if self.log_tap is not None:
                self.log_tap.record_received([frame], now)
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
            return number not in COMMANDS or not is_stop(codec.decode(number, payload_of(raw)))
        self._late += 1
        return number not in ACKED

    def _decode(self, state: PeerState, frame: Frame, now: float) -> Message | None:
        number, system, _, _, raw = frame
        if number == _RADIO_STATUS:
            self._flow.handle_frame(raw, now)
        if self._wanted is not None and number not in self._wanted:
            return None
        kind = _RATE_CLASS.get(number, "rest")
        room = state.buckets[kind].consume(now)
        if not room and kind != "command":
            self._rate_limited += 1
            return None
        message = codec.decode(number, payload_of(raw))
        if not room and not is_stop(message):  # a stop passes whatever else its sender floods us with
            self._rate_limited += 1
            return None
        if number == Heartbeat.id:
            state.systems.add(system)
        return message

    # ---- sending ----

    def send(self, outgoing: Outgoing, payload: bytes | None = None) -> Iterator[tuple[bytes, Hashable, int]]:
        """Yield the frames to send: bytes, address, packet sequence.

        Each peer has its own sequence, so that a frame for one is no loss to the others. `payload` is the encoded
        message, where it exists already, as for another link. Raises codec.EncodeError.
        """
        message = outgoing.message
        number = type(message).id
        payload = codec.encode_payload(message) if payload is None else payload
        for state in self._recipients(outgoing):
            sequence = state.sequence
            state.sequence = (sequence + 1) & 0xFF
            data = codec.frame(number, payload, sequence, *self.ids)
            self._sent.add(data)
            yield data, state.peer.address, sequence

    def _recipients(self, outgoing: Outgoing) -> list[PeerState]:
        message, peer, among = outgoing
        if peer is not None:
            return self._peers.known((peer,))
        if among is not None:
            return self._peers.known(among)
        target = getattr(message, "target_system", getattr(message, "target", 0))
        return [state for state in self._peers if state.accepts_target(target)]

    # ---- reporting ----

    def expire_peers(self, now: float) -> None:
        """Drop peers that have been silent for PEER_SILENCE."""
        self._peers.expire(now)

    def report(self, down: str | None = None, *, now: float = 0.0, dropped: int = 0) -> LinkReport:
        """Return the counters of this channel. `down` and `dropped` come from the transport."""
        counts = FramerCounts()
        for each in (
            self._peers.past_counts,
            self._new_peer_framer.counts,
            *(state.framer.counts for state in self._peers),
        ):
            counts.add(each)
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
            dialect_mismatch=tuple(
                sorted(MESSAGES[each].msgname for each, times in counts.mismatches.items() if times >= MISMATCH_AFTER)
            ),
            signing=find_signing(self._peers),
            own_id=self._own_id,
            down=down or self._noise_problem(counts),
            capacity=self._capacity,
            headroom=self._flow.headroom(now) if self._capacity is not None else 1.0,
            dropped=dropped,
            sources=count_sources(self._peers),
            audience=tuple(state.peer for state in self._peers if state.accepts_target(0)),
        )

    def _noise_problem(self, counts: FramerCounts) -> str | None:
        if self._capacity is None:
            return None
        return noise_hint(self.name, self._bytes_received, counts.frames + counts.unknown)
