"""State of one upload: which item is requested next, and when again, and how the upload ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import msgspec

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing, Peer, Received
from link.services.mission.items import Items, MissionItem, PlanRules, from_message, item_fault

REQUEST_TIMEOUT = 0.5
"""s after which an item is requested again: longer than a loaded 57600 baud radio takes (0.18 s each way), and short
enough for 16 attempts at an item (at 30 % loss) before the upload is cancelled."""
MIN_REQUEST_INTERVAL = 0.2
"""s after which a wrong item leads to an immediate new request; sooner, both ends would send everything twice."""
UPLOAD_TIMEOUT = 8.0
"""s without an item until an upload is cancelled (as in ArduPilot)."""
REPEAT_WINDOW = 10.0
"""s in which the last item, repeated because our MISSION_ACK was lost, is acknowledged again."""


class MissionPeer(NamedTuple):
    """The sender of a message."""

    peer: Peer
    system: int
    component: int


def sender_of(received: Received) -> MissionPeer:
    """Return the sender to reply to."""
    return MissionPeer(received.peer, received.system, received.component)


def ack(sender: MissionPeer, kind: int, verdict: MissionResult, plan_id: int = 0) -> Outgoing:
    """Return MISSION_ACK. `plan_id`: id of the new plan at the end of an upload."""
    return Outgoing(m.MissionAck(sender.system, sender.component, verdict, kind, plan_id), sender.peer)


class EndedUpload(msgspec.Struct, frozen=True):
    """The end of an upload, to be acknowledged again when the MISSION_ACK got lost."""

    sender: MissionPeer
    last: int
    """Number of the item that ended it."""
    at: float
    ack: Outgoing

    def move(self, sender: MissionPeer) -> EndedUpload:
        """Return the same end for a sender that is on another link now."""
        return EndedUpload(sender, self.last, self.at, self.ack._replace(peer=sender.peer))

    def repeat_ack(self, sequence: int, sender: MissionPeer, now: float) -> list[Outgoing]:
        """Return the MISSION_ACK again if the sender of the upload has repeated its last item."""
        repeated = (sender, sequence) == (self.sender, self.last) and now - self.at <= REPEAT_WINDOW
        return [self.ack] if repeated else []


class PlanUpload:
    """Items `first` to `end` (excluded) of a plan. Those before and after them in `items` stay."""

    def __init__(
        self,
        sender: MissionPeer,
        kind: MissionType,
        rules: PlanRules,
        *,
        items: Sequence[MissionItem] = (),
        first: int = 0,
        end: int,
        now: float,
    ) -> None:
        self.sender = sender
        self.kind = kind
        self._rules = rules
        self._items = list(items)
        self._next = first
        self._end = end
        self._last_item_at = self._requested_at = now
        self._as_int = True
        self._only_int = self._moved = False
        self.float_requested = False
        """MISSION_REQUEST was sent."""
        self.invalid_item: tuple[int, MissionItem] | None = None
        """The item that ended the upload, and its number; None if the plan as a whole is invalid."""

    @property
    def items(self) -> Items:
        """The items so far: those received, and those that stay."""
        return tuple(self._items)

    def request_item(self, now: float) -> Outgoing:
        """Return the request for the next item."""
        self._requested_at = now
        self.float_requested |= not self._as_int
        request = m.MissionRequestInt if self._as_int else m.MissionRequest
        return Outgoing(request(self.sender.system, self.sender.component, self._next, self.kind), self.sender.peer)

    def move(self, sender: MissionPeer) -> None:
        """Go on with the sender on another link; what was requested on the former one is requested again."""
        self.sender, self._moved = sender, True

    def handle_item(self, message: m.MissionItem | m.MissionItemInt, now: float) -> list[Outgoing] | MissionResult:
        """Handle an item; return the messages to send, or how the upload ends.

        An item that was not requested is dropped: a repeated one silently, a later one with a new request for the
        missing one.
        """
        if message.seq != self._next:
            skipped = message.seq > self._next and now - self._requested_at >= MIN_REQUEST_INTERVAL
            again, self._moved = skipped or self._moved, False
            return [self.request_item(now)] if again else []
        item = from_message(message)
        fault = item_fault(item, self._rules.commands, self._rules.frames)
        if fault is not None:
            self.invalid_item = self._next, item
            return fault
        self._moved = False
        self._items[self._next : self._next + 1] = [item]
        self._next, self._last_item_at = self._next + 1, now
        return [self.request_item(now)] if self._next < self._end else self._rules.check(self.items)

    def is_overdue(self, now: float) -> bool:
        """Return whether no item has come for UPLOAD_TIMEOUT."""
        return now - self._last_item_at >= UPLOAD_TIMEOUT

    def repeat_request(self, now: float) -> list[Outgoing]:
        """Return the request again when its answer is late.

        Every second time it is the older MISSION_REQUEST, because some scripts handle no other.
        """
        if now - self._requested_at < REQUEST_TIMEOUT:
            return []
        self._as_int = self._only_int or not self._as_int
        return [self.request_item(now)]

    def use_int_only(self, now: float) -> list[Outgoing]:
        """Use only MISSION_REQUEST_INT from now on: MAVSDK answers MISSION_REQUEST with UNSUPPORTED."""
        if self._only_int:
            return []  # the rejection of an older request
        self._as_int = self._only_int = True
        return [self.request_item(now)]
