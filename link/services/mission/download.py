"""Plan downloads: single items on request, or a range of items at once.

MISSION_REQUEST_PARTIAL_LIST has no message sequence in the specification, only its description: "if start and end index
are the same, just send one waypoint". So the reply is the items themselves; lost ones are requested by number. Source:
https://mavlink.io/en/services/mission.html.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing, Peer, Received
from link.services.mission.items import to_message
from link.services.mission.plans import PlanSet
from link.services.mission.upload import MissionPeer, ack, sender_of
from link.services.pacing import MAVLINK2_OVERHEAD, BulkPacer

MAX_CLIENTS = 8
ITEM_FRAME = m.MissionItemInt.unpacker.size + MAVLINK2_OVERHEAD
TO_THE_END = -1
"""`end_index` for the last item."""


class PlanDownloads:
    """Serves downloads. `current` returns the index of the current mission item."""

    def __init__(self, plans: PlanSet, pacer: BulkPacer, current: Callable[[], int]) -> None:
        self._plans = plans
        self._pacer = pacer
        self._current = current
        self._under_way: dict[Peer, deque[Outgoing]] = {}

    def receive(self, received: Received) -> list[Outgoing] | None:
        """Return the reply to a request; None if the message is not one."""
        sender = sender_of(received)
        match received.message:
            case m.MissionRequestList() as message:
                return [self._count(message, sender)]
            case m.MissionRequestInt() | m.MissionRequest() as message:
                return [self._item(message, sender)]
            case m.MissionRequestPartialList() as message:
                return self._begin_partial(message, sender)
        return None

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next items of ranges under way, as far as the links have room."""
        outgoing: list[Outgoing] = []
        for peer, items in list(self._under_way.items()):
            while items and self._pacer.consume(peer, ITEM_FRAME, now):
                outgoing.append(items.popleft())
            if not items:
                del self._under_way[peer]
        return outgoing

    def _count(self, message: m.MissionRequestList, sender: MissionPeer) -> Outgoing:
        kind = self._plans.kind(message.mission_type)
        if kind is None:
            return ack(sender, message.mission_type, MissionResult.UNSUPPORTED)
        count, plan_id = len(self._plans[kind]), self._plans.get_id(kind)
        return Outgoing(m.MissionCount(sender.system, sender.component, count, kind, plan_id), sender.peer)

    def _item(self, message: m.MissionRequestInt | m.MissionRequest, sender: MissionPeer) -> Outgoing:
        kind = self._plans.kind(message.mission_type)
        if kind is None:
            return ack(sender, message.mission_type, MissionResult.UNSUPPORTED)
        if message.seq >= len(self._plans[kind]):
            return ack(sender, kind, MissionResult.INVALID_SEQUENCE)
        return self._build_item(message.seq, kind, sender)

    def _begin_partial(self, message: m.MissionRequestPartialList, sender: MissionPeer) -> list[Outgoing]:
        kind = self._plans.kind(message.mission_type)
        if kind is None:
            return [ack(sender, message.mission_type, MissionResult.UNSUPPORTED)]
        count, first = len(self._plans[kind]), message.start_index
        last = count - 1 if message.end_index == TO_THE_END else message.end_index
        if not 0 <= first <= last < count:
            return [ack(sender, kind, MissionResult.INVALID_SEQUENCE)]
        if sender.peer not in self._under_way and len(self._under_way) >= MAX_CLIENTS:
            return [ack(sender, kind, MissionResult.DENIED)]
        self._under_way[sender.peer] = deque(self._build_item(index, kind, sender) for index in range(first, last + 1))
        return []

    def _build_item(self, index: int, kind: MissionType, sender: MissionPeer) -> Outgoing:
        current = kind is MissionType.MISSION and self._current() == index
        target = (sender.system, sender.component)
        return Outgoing(to_message(self._plans[kind][index], index, kind, target, current=current), sender.peer)
