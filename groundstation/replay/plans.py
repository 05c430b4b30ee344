"""Plans in a log: which mission, fence and rally points a vehicle had at each moment, from their uploads and downloads.

The index finds where plans were replaced; a station that shows a moment is given those of that moment. Source:
https://mavlink.io/en/services/mission.html.
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable
from typing import Any, NamedTuple

import msgspec

from dialects import messages as m
from dialects.codec import decode_frame
from dialects.enums import MissionResult, MissionType
from link.services.mission.items import item_request
from link.tlog.scan import LogFrame

PLAN_IDS = frozenset(
    kind.id
    for kind in (
        m.MissionCount,
        m.MissionWritePartialList,
        m.MissionItem,
        m.MissionItemInt,
        m.MissionAck,
        m.MissionClearAll,
    )
)
"""Ids of the messages that transfer plans."""

MAX_OPEN = 16
"""Transfers that may be under way at once."""

MAX_PLAN = 10_000
"""Items of a plan: of a longer one, which no autopilot has, none are kept."""

MAX_ITEMS = 500_000
"""Items of all plans of a log, 8 bytes each; plans beyond that are not shown."""

MAX_CHANGES = 10_000
"""Plans that were replaced; later ones are not shown."""

_NAMES = {MissionType.MISSION: "mission", MissionType.FENCE: "fence", MissionType.RALLY: "rally points"}
_KINDS = tuple(_NAMES)


class RecordedPlan(NamedTuple):
    """A plan that a vehicle has from a record on, or is seen to have."""

    offset: int
    """Of the record that ends the transfer."""
    system: int
    kind: MissionType
    items: array[int] | None
    """Offsets of the records of its items; None: some of them are not in the log."""
    plan_id: int = 0
    """Id that the vehicle gave it; 0: none."""
    sent: bool = False
    """It was uploaded or cleared; else downloaded."""


class _Key(NamedTuple):
    vehicle: int
    station: int
    kind: int
    upload: bool


class _Transfer(msgspec.Struct):
    count: int
    """Of the items of the plan."""
    plan_id: int = 0
    items: dict[int, int] = msgspec.field(default_factory=dict)
    """Sequence -> offset of the newest record of the item."""
    parts: range | None = None
    """Sequences of the items that are replaced, the others stay; None: all."""

    @classmethod
    def of_part(cls, message: m.MissionWritePartialList, before: RecordedPlan | None) -> _Transfer:
        """Return the upload of a part. It is never whole if the plan before is not known."""
        parts = range(message.start_index, message.end_index + 1)
        kept = before.items if before is not None else None
        if kept is None or not 0 <= parts.start < parts.stop <= len(kept):
            return cls(MAX_PLAN + 1)
        return cls(len(kept), items={at: each for at, each in enumerate(kept) if at not in parts}, parts=parts)

    def takes(self, sequence: int) -> bool:
        """Return whether an item belongs to it."""
        return sequence in (range(self.count) if self.parts is None else self.parts) and self.count <= MAX_PLAN

    @property
    def offsets(self) -> array[int] | None:
        """Offsets in the order of the plan, if it is whole."""
        whole = len(self.items) == self.count
        return array("Q", (self.items[each] for each in range(self.count))) if whole else None


class PlanHistory:
    """Takes the messages of PLAN_IDS in the order of the file."""

    def __init__(self) -> None:
        self.changes: list[RecordedPlan] = []
        self._open: dict[_Key, _Transfer] = {}
        self._items = 0

    def add(self, frame: LogFrame, vehicles: Iterable[int]) -> list[RecordedPlan]:
        """Add a message; return the changes that end with it. `vehicles`: their systems, as far as they are known."""
        message: Any = decode_frame(frame.message_id, frame.raw)
        target, from_vehicle = message.target_system, frame.system in vehicles
        vehicle, station = (frame.system, target) if from_vehicle else (target, frame.system)
        key = _Key(vehicle, station, int(message.mission_type), upload=not from_vehicle)
        match message:
            case m.MissionCount():
                found = self._begin(key, _Transfer(message.count, message.opaque_id), frame)
            case m.MissionWritePartialList() if not from_vehicle:
                found = self._begin(key, _Transfer.of_part(message, self._newest(key)), frame)
            case m.MissionClearAll() if not from_vehicle:
                found = self._begin(key, _Transfer(0), frame)
            case m.MissionAck() if from_vehicle:
                found = self._end_upload(key._replace(upload=True), message, frame)
            case m.MissionItem() | m.MissionItemInt() if item_request(message) is None:
                found = self._add_item(key, message.seq, frame)
            case _:
                found = []
        if len(self.changes) >= MAX_CHANGES:
            return []
        self.changes += found
        return found

    def _newest(self, key: _Key) -> RecordedPlan | None:
        changes = reversed(self.changes)
        return next((each for each in changes if (each.system, each.kind) == (key.vehicle, key.kind)), None)

    def _begin(self, key: _Key, transfer: _Transfer, frame: LogFrame) -> list[RecordedPlan]:
        self._open.pop(key, None)
        if len(self._open) >= MAX_OPEN:
            self._open.pop(next(iter(self._open)))
        self._open[key] = transfer
        return self._end_download(key, transfer, frame)

    def _add_item(self, key: _Key, sequence: int, frame: LogFrame) -> list[RecordedPlan]:
        transfer = self._open.get(key)
        if transfer is None or not transfer.takes(sequence):
            return []
        transfer.items[sequence] = frame.at
        return self._end_download(key, transfer, frame)

    def _end_download(self, key: _Key, transfer: _Transfer, frame: LogFrame) -> list[RecordedPlan]:
        """Return the plan of a download that is whole; the ACK of the station may not be in the log."""
        if key.upload or key.kind not in _KINDS or len(transfer.items) < transfer.count:
            return []
        del self._open[key]
        return [self._change(key, MissionType(key.kind), transfer.offsets, transfer.plan_id, frame)]

    def _end_upload(self, key: _Key, message: m.MissionAck, frame: LogFrame) -> list[RecordedPlan]:
        """Return the plans that a vehicle has accepted; before that it has the old ones."""
        transfer = self._open.pop(key, None)
        if transfer is None or message.type != MissionResult.ACCEPTED:
            return []
        kinds = _KINDS if key.kind == MissionType.ALL else [each for each in _KINDS if each == key.kind]
        return [self._change(key, kind, transfer.offsets, message.opaque_id, frame) for kind in kinds]

    def _change(
        self, key: _Key, kind: MissionType, items: array[int] | None, plan_id: int, frame: LogFrame
    ) -> RecordedPlan:
        self._items += len(items or ())
        kept = items if self._items <= MAX_ITEMS else None
        return RecordedPlan(frame.at, key.vehicle, kind, kept, plan_id if items else 0, key.upload)


def describe(change: RecordedPlan) -> str:
    """Return what a vehicle has accepted, in a few words."""
    name = _NAMES[change.kind]
    if change.items is None:
        return f"{name} replaced; its items are not in the log"
    count = len(change.items)
    return f"{name}: {count} item{'' if count == 1 else 's'}" if count else f"{name} cleared"
