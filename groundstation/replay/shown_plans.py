"""ShownPlans: gives a station the plans that the vehicles of a log had at each moment."""

from __future__ import annotations

from dialects import messages as m
from dialects.codec import decode_frame
from groundstation.replay.log_index import LogIndex
from groundstation.replay.plans import PlanChange
from groundstation.station.station import Station
from link.services.mission.items import MissionItem, from_message


class ShownPlans:
    """The plans of one station, which begins at an offset of the log."""

    def __init__(self, index: LogIndex, station: Station, offset: int) -> None:
        """Give it the newest plan of each vehicle and kind from before the offset."""
        self._index = index
        self._station = station
        self._next = 0
        newest: dict[tuple[int, int], tuple[int, PlanChange]] = {}
        changes = index.findings.plans.changes
        while self._next < len(changes) and changes[self._next].offset < offset:
            change = changes[self._next]
            self._next += 1
            newest[change.system, change.kind] = self._next, change
        for number, change in newest.values():
            self._show(number, change)

    def advance(self, offset: int) -> None:
        """Give it the plans up to the record at an offset."""
        changes = self._index.findings.plans.changes
        while self._next < len(changes) and changes[self._next].offset <= offset:
            self._next += 1
            self._show(self._next, changes[self._next - 1])

    def _show(self, number: int, change: PlanChange) -> None:
        contact = self._station.fleet.get(change.system)
        if contact is None:
            return
        plans = self._station.services.services_of(contact).plans
        found = [self._read(offset) for offset in change.items or ()]
        items = [item for item in found if item is not None]
        if change.items is None or len(items) < len(found):
            plans.forget(change.kind)
        else:
            plans.take(change.kind, tuple(items), number, change.plan_id)

    def _read(self, offset: int) -> MissionItem | None:
        frame = self._index.read_frame(offset)
        message = None if frame is None else decode_frame(frame.message_id, frame.raw)
        return from_message(message) if isinstance(message, (m.MissionItem, m.MissionItemInt)) else None
