"""One plan on its way to the vehicle: which item comes next, when it is asked for, and how it all ends."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing, Peer, Received
from link.services.mission.items import Items, MissionItem, PlanRules, from_message, item_fault

REQUEST_TIMEOUT = 0.5
"""s after which an item is asked for again: longer than a loaded 57600 baud radio takes (0.18 s each way), and short
enough that an item at 30 % loss has 16 tries before it is given up."""
MIN_REQUEST_INTERVAL = 0.2
"""s after which a wrong item is answered by asking again at once; sooner, both ends would say everything twice."""
UPLOAD_TIMEOUT = 8.0
"""s without an item until an upload is cancelled (ArduPilot's time)."""


class Sender(NamedTuple):
    """Who a message came from."""

    peer: Peer
    system: int
    component: int


def sender_of(received: Received) -> Sender:
    """Whom to answer."""
    return Sender(received.peer, received.system, received.component)


def ack(sender: Sender, kind: int, verdict: MissionResult, plan_id: int = 0) -> Outgoing:
    """MISSION_ACK. `plan_id` is the id of the new plan at the end of an upload."""
    return Outgoing(m.MissionAck(sender.system, sender.component, verdict, kind, plan_id), sender.peer)


class PlanUpload:
    """Items `first` to `end` (not included) of a plan. What stands before and after them in `items` stays."""

    def __init__(
        self,
        sender: Sender,
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
        self._heard = self._asked = now
        self._as_int = True
        self._only_int = False
        self.float_requested = False
        """MISSION_REQUEST was sent."""
        self.invalid_item: tuple[int, MissionItem] | None = None
        """The item that ended it, and its number; None where the plan as a whole is no good."""

    @property
    def items(self) -> Items:
        """What has come, and what stood there before."""
        return tuple(self._items)

    def request_item(self, now: float) -> Outgoing:
        """The question for the next item."""
        self._asked = now
        self.float_requested |= not self._as_int
        request = m.MissionRequestInt if self._as_int else m.MissionRequest
        return Outgoing(request(self.sender.system, self.sender.component, self._next, self.kind), self.sender.peer)

    def handle_item(self, message: m.MissionItem | m.MissionItemInt, now: float) -> list[Outgoing] | MissionResult:
        """Take an item; returns what to say to it, or how the upload ends.

        One that was not asked for is dropped: a repeat in silence, a later one by asking again for what is missing.
        """
        if message.seq != self._next:
            skipped = message.seq > self._next and now - self._asked >= MIN_REQUEST_INTERVAL
            return [self.request_item(now)] if skipped else []
        item = from_message(message)
        fault = item_fault(item, self._rules.commands, self._rules.frames)
        if fault is not None:
            self.invalid_item = self._next, item
            return fault
        self._items[self._next : self._next + 1] = [item]
        self._next, self._heard = self._next + 1, now
        return [self.request_item(now)] if self._next < self._end else self._rules.check(self.items)

    def is_overdue(self, now: float) -> bool:
        """Has its sender been silent for too long?"""
        return now - self._heard >= UPLOAD_TIMEOUT

    def repeat_request(self, now: float) -> list[Outgoing]:
        """The question once more when its answer is late, each second time as the older MISSION_REQUEST: some scripts
        wait for nothing else.
        """
        if now - self._asked < REQUEST_TIMEOUT:
            return []
        self._as_int = self._only_int or not self._as_int
        return [self.request_item(now)]

    def use_int_only(self, now: float) -> list[Outgoing]:
        """Ask by MISSION_REQUEST_INT from now on: MAVSDK refuses MISSION_REQUEST with UNSUPPORTED."""
        if self._only_int:
            return []  # the refusal of an older question
        self._as_int = self._only_int = True
        return [self.request_item(now)]
