"""How QGroundControl reads and writes a plan (PlanManager).

It repeats MISSION_COUNT and its requests for the list and for items. An item that was requested is sent once: the
vehicle has to request it again.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from dialects import messages as m
from dialects.enums import MissionResult

if TYPE_CHECKING:
    from tests.interop.qgroundcontrol import QGroundControl

ACK_LIMIT, ITEM_LIMIT, TRIES = 1.5, 0.25, 5
"""s for most answers, s for an item, and the number of retries."""


class PlanError(Exception):
    """QGroundControl gave up and shows an error; its user retries."""


def count(ground: QGroundControl, kind: int) -> int:
    """Return the length of a plan. Raises PlanError."""
    for attempt in range(TRIES + 1):
        ground.repeats += attempt > 0
        ground.send(m.MissionRequestList(1, 1, kind))
        told = ground.wait(m.MissionCount, ACK_LIMIT, lambda each: each.mission_type == kind)
        if told is not None:
            return int(told.count)
    raise PlanError(f"no answer for plan {kind}")


def read(ground: QGroundControl, kind: int) -> list[m.MissionItemInt]:
    """Return the whole plan. Raises PlanError."""
    items = [_item(ground, number, kind) for number in range(count(ground, kind))]
    ground.send(m.MissionAck(1, 1, MissionResult.ACCEPTED, kind))
    return items


def _item(ground: QGroundControl, number: int, kind: int) -> m.MissionItemInt:
    for attempt in range(TRIES + 1):
        ground.repeats += attempt > 0
        ground.send(m.MissionRequestInt(1, 1, number, kind))
        item = ground.wait(m.MissionItemInt, ITEM_LIMIT, lambda each: (each.seq, each.mission_type) == (number, kind))
        if item is not None:
            return item
    raise PlanError(f"no item {number} of plan {kind}")


def write(ground: QGroundControl, kind: int, items: Sequence[m.MissionItemInt]) -> MissionResult:
    """Upload a plan; return the vehicle's answer. Raises PlanError."""
    wanted: set[int] = set(range(len(items)))
    repeats = 0
    ground.send(m.MissionCount(1, 1, len(items), kind))
    while True:
        said = ground.wait(m.Message, ACK_LIMIT, lambda each: _concerns(each, kind))
        if isinstance(said, m.MissionAck):
            return MissionResult(said.type)
        if isinstance(said, m.MissionRequest | m.MissionRequestInt):
            wanted.discard(said.seq)
            ground.send(items[said.seq])
        elif 0 in wanted and repeats < TRIES:
            repeats += 1
            ground.repeats += 1
            ground.send(m.MissionCount(1, 1, len(items), kind))
        else:
            raise PlanError(f"plan {kind} not written: {'items not asked for' if wanted else 'no final answer'}")


def _concerns(message: m.Message, kind: int) -> bool:
    return isinstance(message, m.MissionRequest | m.MissionRequestInt | m.MissionAck) and message.mission_type == kind
