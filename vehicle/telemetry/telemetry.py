"""Streams of all peers: a schedule for each peer, a budget for each link, one message for all its peers."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping
from typing import Any

from dialects import messages as m
from link.core import RECORDER, Outgoing, Peer, Received
from vehicle.telemetry.schedule import PEER_MESSAGE_RATE_MAX, BandwidthShare, StreamSchedule
from vehicle.telemetry.streams import STREAM_BY_ID, STREAMS, DialectLevel, Stream, level_of_command
from vehicle.telemetry.view import TelemetryView

LINK_MESSAGE_RATE_MAX = 1000.0
"""Streamed messages/s on one link, in equal parts. 24 peers (link.protocol.channel.MAX_PEERS) get 41 each; the default
streams are 39."""
MAX_PEERS = 64
"""Schedules kept. Another peer gets none until one of these is gone."""

_CHANGING = tuple(stream for stream in STREAMS if stream.change_key is not None)
_STEADY = tuple(stream for stream in _CHANGING if stream.steady)
_STEADY_IDS = tuple(stream.message.id for stream in STREAMS if stream.steady)
_FOLLOWING_DEMAND = tuple(stream for stream in STREAMS if stream.follows_demand)


class Telemetry:
    """The streams of all peers. A peer gets its streams after `update_audience` or its first HEARTBEAT."""

    def __init__(self, system: int, now: float, *, logged: bool = False) -> None:
        """`system` is the system id of the vehicle, `now` the time of boot; `logged` adds the log as a peer."""
        self._system = system
        self._boot = now
        self._schedules: dict[Peer, StreamSchedule] = {}
        if logged:
            self._add(RECORDER, now)
            self._schedules[RECORDER].raise_level(DialectLevel.ROVER, now)
        self.greet: Callable[[float], None] = lambda now: None
        """Called with the time when a peer has introduced itself, which waits for our HEARTBEAT."""
        self._rates: Mapping[int, float] = {}
        self.shortest = math.inf
        """The shortest interval of a stream of any peer, s. Updated once a second."""
        self._change_keys: dict[int, Hashable] = {}
        """Message -> the value that was compared last."""

    # ---- peers ----

    def update_audience(self, audience: Collection[Peer], rates: Mapping[int, float], now: float) -> None:
        """Set who receives telemetry. A peer that is gone loses its rates. `rates`: link -> bytes/s, where known."""
        self._rates = rates
        staying = {RECORDER, *audience}
        self._schedules = {peer: each for peer, each in self._schedules.items() if peer in staying}
        for peer in audience:
            self._add(peer, now)
        self._share_out()
        self.shortest = min((schedule.shortest for schedule in self._schedules.values()), default=math.inf)

    def observe(self, received: Received, now: float) -> None:
        """Note what a message shows of its sender: that it listens, and which messages it understands."""
        note = _OBSERVED.get(type(received.message))
        if note is not None:
            note(self, received, received.message, now)

    def peers_at_level(self, level: DialectLevel) -> tuple[Peer, ...]:
        """Return the peers that understand a level."""
        return tuple(peer for peer, each in self._schedules.items() if level <= each.level)

    def has_level(self, peer: Peer, level: DialectLevel) -> bool:
        """Return whether a peer understands a level."""
        schedule = self._schedules.get(peer)
        return schedule is not None and level <= schedule.level

    def schedule_of(self, peer: Peer) -> StreamSchedule | None:
        """Return the schedule of a peer; None if it receives no telemetry."""
        return self._schedules.get(peer)

    def handle_introduction(self, received: Received, _: m.Message, now: float) -> None:
        """Start the streams of a peer that introduces itself."""
        if received.may_ask and received.peer not in self._schedules:
            self._add(received.peer, now)
            self._share_out()
            self.greet(now)

    def handle_request_data_stream(self, received: Received, message: m.RequestDataStream, now: float) -> None:
        """Set the rate of a group of streams for the sender."""
        schedule = self._schedules.get(received.peer)
        if schedule is not None and message.target_system == self._system:
            schedule.set_group(message.req_stream_id, message.req_message_rate if message.start_stop else 0, now)

    def handle_radio_status(self, received: Received, message: m.RadioStatus, now: float) -> None:
        """Slow the streams of a peer down while the buffer of its radio is full."""
        schedule = self._schedules.get(received.peer)
        if schedule is not None:
            schedule.handle_radio_status(message.txbuf, now)

    def _note_command(self, received: Received, message: m.CommandLong | m.CommandInt, now: float) -> None:
        self.handle_introduction(received, message, now)
        self._raise_level(received, level_of_command(message), now)

    def _note_presence(self, received: Received, _: m.Message, now: float) -> None:
        self._raise_level(received, DialectLevel.ROVER, now)

    def _raise_level(self, received: Received, level: DialectLevel, now: float) -> None:
        schedule = self._schedules.get(received.peer)
        if schedule is not None and received.may_ask:
            schedule.raise_level(level, now)

    # ---- messages ----

    def build_due(self, view: TelemetryView, *, all_changes: bool = True) -> list[Outgoing]:
        """Build the messages that are due at the time of `view`. Without `all_changes` only steady ones go early."""
        self._expedite_changes(_CHANGING if all_changes else _STEADY, view)
        wanted: dict[int, list[Peer]] = {}
        for peer, schedule in self._schedules.items():
            for stream in schedule.pop_due(view.now):
                wanted.setdefault(stream.message.id, []).append(peer)
        return _build(wanted.items(), view)

    def build_after_demand(self, view: TelemetryView) -> list[Outgoing]:
        """Build what follows a changed demand at once; the rest waits for the next tick."""
        self._expedite_changes(_FOLLOWING_DEMAND, view)
        return self._build_those_due([stream.message.id for stream in _FOLLOWING_DEMAND], view)

    def is_steady_due(self, now: float) -> bool:
        """Return whether a steady stream is due."""
        return any(now >= schedule.steady_due for schedule in self._schedules.values())

    def build_steady(self, view: TelemetryView) -> list[Outgoing]:
        """Build the steady streams that are due, without a look for changes."""
        return self._build_those_due(_STEADY_IDS, view)

    def _build_those_due(self, numbers: Iterable[int], view: TelemetryView) -> list[Outgoing]:
        wanted = [
            (n, [peer for peer, each in self._schedules.items() if each.pop_if_due(n, view.now)]) for n in numbers
        ]
        return _build(wanted, view)

    def _expedite_changes(self, streams: Iterable[Stream], view: TelemetryView) -> None:
        for stream in streams:
            number, key = stream.message.id, stream.change_key(view) if stream.change_key else None
            if number in self._change_keys and key != self._change_keys[number]:
                for schedule in self._schedules.values():
                    schedule.expedite(number, view.now)
            self._change_keys[number] = key

    def _add(self, peer: Peer, now: float) -> None:
        if peer not in self._schedules and len(self._schedules) < MAX_PEERS:
            self._schedules[peer] = StreamSchedule(self._boot, now)

    def _share_out(self) -> None:
        """Give the peers of a link equal parts, so that the rates of one peer do not slow another down."""
        peers = Counter(peer.link for peer in self._schedules)
        for peer, schedule in self._schedules.items():
            count, rate = peers[peer.link], self._rates.get(peer.link)
            schedule.set_share(
                BandwidthShare(
                    min(PEER_MESSAGE_RATE_MAX, LINK_MESSAGE_RATE_MAX / count), None if rate is None else rate / count
                )
            )


_OBSERVED: dict[type[m.Message], Callable[[Telemetry, Received, Any, float], None]] = {
    m.CommandLong: Telemetry._note_command,
    m.CommandInt: Telemetry._note_command,
    m.RoverOperatorPresence: Telemetry._note_presence,
}
"""Message -> what it shows of its sender."""


def _build(wanted: Iterable[tuple[int, list[Peer]]], view: TelemetryView) -> list[Outgoing]:
    """Build each message once, for all peers that it is due for."""
    found: list[tuple[m.Message | None, list[Peer]]] = [
        (STREAM_BY_ID[number].build(view), peers) for number, peers in wanted if peers
    ]
    return [Outgoing(message, among=tuple(peers)) for message, peers in found if message is not None]
