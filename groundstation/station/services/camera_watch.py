"""CameraWatch: finds the stream of the selected vehicle's camera, and lets it run while a screen shows it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import msgspec

from dialects import messages as m
from dialects.enums import Command
from groundstation.station.driving.commander import Commander
from groundstation.station.view_feed import ViewSource
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.views.base import ViewRequest
from groundstation.views.camera import CameraRequest, CameraView
from link.core import Peer, Received
from link.services.timesync import TimesyncClient
from link.services.video_stream import RTP_UDP, STAMPED

WANTED_FOR = 2.0
"""s for which a screen that has asked counts as watching."""
ASK_PERIOD, ASK_TRIES = 2.0, 3
"""s between two requests of VIDEO_STREAM_INFORMATION; after so many the vehicle has no camera."""
START_PERIOD = 3.0
"""s between two VIDEO_START_STREAMING: a vehicle that has restarted sends again."""
ASK_AGAIN = 15.0
"""s after which a vehicle without a camera is asked again."""
PERIOD = 0.5


class _Stream(msgspec.Struct):
    """What is known of the camera of one vehicle."""

    port: int = 0
    stamped: bool = False
    problem: str = ""
    tries: int = 0
    due: float = -math.inf
    started: bool = False
    hosts: set[str] = msgspec.field(default_factory=set)
    """IP addresses from which the vehicle has sent HEARTBEATs."""


class WantedStream(NamedTuple):
    """What is to be received."""

    port: int
    """UDP port of this machine; 0: nothing."""
    stamped: bool
    hosts: frozenset[str] = frozenset()
    """IP addresses of the vehicle that sends it; empty: it may come from any, as that of another computer on board."""


NOTHING = WantedStream(0, stamped=False)


class CameraWatch:
    """Asks and starts by commands that are not logged."""

    def __init__(self, fleet: Fleet, commander: Commander, timesync: TimesyncClient) -> None:
        self._fleet, self._commander, self._timesync = fleet, commander, timesync
        self._streams: dict[int, _Stream] = {}
        self._wanted_until = -math.inf
        self.receiver_problem = ""
        """Why the stream cannot be received here, in one line."""

    def wanted(self, now: float) -> WantedStream:
        """Return the stream that a screen shows."""
        selected = self._fleet.selected
        stream = None if selected is None else self._streams.get(selected.state.system)
        if stream is None or now >= self._wanted_until:
            return NOTHING
        return WantedStream(stream.port, stream.stamped, frozenset(stream.hosts) if stream.stamped else frozenset())

    @property
    def sources(self) -> Mapping[type[ViewRequest], ViewSource]:
        """Return where the view comes from."""
        return {CameraRequest: ViewSource(self._build, period=PERIOD)}

    def receive(self, contact: Contact, received: Received) -> None:
        """Take the announcement of a stream."""
        message = received.message
        if isinstance(message, m.Heartbeat) and (known := self._streams.get(contact.state.system)) is not None:
            known.hosts |= _host_of(received.peer)
        if not isinstance(message, m.VideoStreamInformation) or contact.state.system not in self._streams:
            return
        stream = self._streams[contact.state.system]
        stream.hosts |= _host_of(received.peer)
        port = int(message.uri) if message.uri.isascii() and message.uri.isdigit() else 0
        if message.type == RTP_UDP and 0 < port < 65536:
            stream.port, stream.stamped, stream.problem = port, message.name == STAMPED, ""
            stream.started = True  # who has asked our vehicle gets pictures already
        else:
            stream.problem = "its stream is of a kind that is not shown here: `mavhelm video` with its URL"

    def tick(self, now: float) -> None:
        """Ask, start and stop."""
        selected = self._fleet.selected
        for contact in self._fleet:
            stream = self._streams.get(contact.state.system)
            wanted = contact is selected and now < self._wanted_until
            if stream is None and wanted:
                stream = self._streams[contact.state.system] = _Stream()
            if stream is not None and contact.lost_at is None:
                self._follow(contact, stream, now, wanted=wanted)

    def _follow(self, contact: Contact, stream: _Stream, now: float, *, wanted: bool) -> None:
        state = contact.state
        if not wanted:
            if stream.started:
                stream.started, stream.due = False, now
                self._commander.stream_video(state, now, on=False)
        elif now >= stream.due:
            if stream.port:
                stream.due, stream.started = now + START_PERIOD, True
                self._commander.stream_video(state, now, on=True)
            elif not self._commander.is_pending(Command.REQUEST_MESSAGE, state):
                stream.tries += 1
                given_up = stream.tries % (ASK_TRIES + 1) == 0
                stream.due = now + (ASK_AGAIN if given_up else ASK_PERIOD)
                if given_up:
                    stream.problem = "the vehicle announces no camera"
                else:
                    self._commander.request_message(state, m.VideoStreamInformation.id, now)

    def _build(self, request: CameraRequest, now: float, wall: float) -> CameraView | None:
        self._wanted_until = now + WANTED_FOR
        selected = self._fleet.selected
        if selected is None:
            return None
        stream = self._streams.get(selected.state.system, _Stream())
        return CameraView(
            selected.state.system, stream.port, stream.stamped, stream.problem or self.receiver_problem,
            self._timesync.offset if stream.stamped else None, self._timesync.offset_error,
        )  # fmt: skip


def _host_of(peer: Peer) -> set[str]:
    """Return the IP address of a peer; nothing for one on a serial line."""
    match peer.address:
        case (str(host), int(), *_):
            return {host}
    return set()
