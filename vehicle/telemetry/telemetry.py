"""Who is told what: a schedule for each peer, a budget for each link, and one message for all who are due for it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping
from typing import Any

from dialects import messages as m
from link.core import RECORDER, Outgoing, Peer, Received
from vehicle.telemetry.schedule import PEER_MESSAGE_RATE_MAX, BandwidthShare, StreamSchedule
from vehicle.telemetry.streams import STREAM_BY_ID, STREAMS, DialectLevel, Stream, level_of_command
from vehicle.telemetry.view import TelemetryView

LINK_MESSAGE_RATE_MAX = 1000.0
"""Streamed messages/s on one link, in equal parts. 24 peers (link.protocol.channel.MAX_PEERS) get 41 each, and the usual streams
are 39."""
MAX_PEERS = 64
"""Schedules kept. Who connects beyond them waits for the next report of the links."""

_CHANGING = tuple(stream for stream in STREAMS if stream.change_key is not None)
_OF_DEMAND = tuple(stream for stream in STREAMS if stream.follows_demand)


class Telemetry:
    """The streams of all peers. Nobody is told anything before attend() or a HEARTBEAT."""

    def __init__(self, system: int, now: float, *, logged: bool = False) -> None:
        """`system` is ours; `now` the time of boot; `logged`: a log listens, too."""
        self._system = system
        self._boot = now
        self._schedules: dict[Peer, StreamSchedule] = {}
        if logged:
            self._add(RECORDER, now)
            self._schedules[RECORDER].raise_level(DialectLevel.ROVER, now)
        self._rooms: Mapping[int, float] = {}
        self._change_keys: dict[int, Hashable] = {}
        """Message -> what was the newest when its changes were looked at."""

    # ---- who listens ----

    def update_audience(self, audience: Collection[Peer], rooms: Mapping[int, float], now: float) -> None:
        """Who listens now: who is gone takes its rates along. `rooms`: link -> bytes/s for telemetry, where known."""
        self._rooms = rooms
        staying = {RECORDER, *audience}
        self._schedules = {peer: each for peer, each in self._schedules.items() if peer in staying}
        for peer in audience:
            self._add(peer, now)
        self._share_out()

    def receive(self, received: Received, now: float) -> None:
        """What a message shows of its sender, or asks for. Commands that ask are in vehicle/commands/requests.py."""
        topic = _HANDLERS.get(type(received.message))
        if topic is not None:
            topic(self, received, received.message, now)

    def peers_at_level(self, family: DialectLevel) -> tuple[Peer, ...]:
        """Who understands it."""
        return tuple(peer for peer, each in self._schedules.items() if family <= each.level)

    def schedule_of(self, peer: Peer) -> StreamSchedule | None:
        """What this one is told; None for who is told nothing."""
        return self._schedules.get(peer)

    def _handle_introduction(self, received: Received, _: m.Message, now: float) -> None:
        """Who has introduced itself is told what everybody is told, beginning now."""
        if received.may_ask and received.peer not in self._schedules:
            self._add(received.peer, now)
            self._share_out()

    def _command(self, received: Received, message: m.CommandLong | m.CommandInt, now: float) -> None:
        self._handle_introduction(received, message, now)
        self._raise_level(received, level_of_command(message), now)

    def _presence(self, received: Received, _: m.Message, now: float) -> None:
        self._raise_level(received, DialectLevel.ROVER, now)

    def _raise_level(self, received: Received, family: DialectLevel, now: float) -> None:
        schedule = self._schedules.get(received.peer)
        if schedule is not None and received.may_ask:
            schedule.raise_level(family, now)

    def _group(self, received: Received, message: m.RequestDataStream, now: float) -> None:
        schedule = self._schedules.get(received.peer)
        if schedule is not None and received.introduced and message.target_system == self._system:
            schedule.set_group(message.req_stream_id, message.req_message_rate if message.start_stop else 0, now)

    def _radio(self, received: Received, message: m.RadioStatus, now: float) -> None:
        schedule = self._schedules.get(received.peer)
        if schedule is not None:
            schedule.handle_radio_status(message.txbuf, now)

    # ---- what is told ----

    def build_due(self, view: TelemetryView) -> list[Outgoing]:
        """The messages that are due at the time of `view`."""
        self._look_for_changes(_CHANGING, view)
        wanted: dict[int, list[Peer]] = {}
        for peer, schedule in self._schedules.items():
            for stream in schedule.pop_due(view.now):
                wanted.setdefault(stream.message.id, []).append(peer)
        return _built(wanted.items(), view)

    def build_after_demand(self, view: TelemetryView) -> list[Outgoing]:
        """What a changed demand makes worth telling at once; the rest is the next tick's."""
        self._look_for_changes(_OF_DEMAND, view)
        numbers = [stream.message.id for stream in _OF_DEMAND]
        wanted = [
            (n, [peer for peer, each in self._schedules.items() if each.pop_if_due(n, view.now)]) for n in numbers
        ]
        return _built(wanted, view)

    def _look_for_changes(self, streams: Iterable[Stream], view: TelemetryView) -> None:
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
        """Each link in equal parts, so that what one peer asks for slows no other."""
        peers = Counter(peer.link for peer in self._schedules)
        for peer, schedule in self._schedules.items():
            number, room = peers[peer.link], self._rooms.get(peer.link)
            schedule.set_share(
                BandwidthShare(
                    min(PEER_MESSAGE_RATE_MAX, LINK_MESSAGE_RATE_MAX / number), None if room is None else room / number
                )
            )


_HANDLERS: dict[type[m.Message], Callable[[Telemetry, Received, Any, float], None]] = {
    m.Heartbeat: Telemetry._handle_introduction,
    m.CommandLong: Telemetry._command,
    m.CommandInt: Telemetry._command,
    m.RoverOperatorPresence: Telemetry._presence,
    m.RequestDataStream: Telemetry._group,
    m.RadioStatus: Telemetry._radio,
}
"""Message -> what it changes."""


def _built(wanted: Iterable[tuple[int, list[Peer]]], view: TelemetryView) -> list[Outgoing]:
    """Each message once, for all who want it."""
    found: list[tuple[m.Message | None, list[Peer]]] = [
        (STREAM_BY_ID[number].build(view), peers) for number, peers in wanted if peers
    ]
    return [Outgoing(message, among=tuple(peers)) for message, peers in found if message is not None]
