"""The plans in force and their ids, by which a ground station detects changes.

The id of a plan is the CRC-32 of its items, 0 for an empty one, as in MISSION_COUNT, MISSION_ACK and MISSION_CURRENT.
The same plan has the same id after a restart, and on another vehicle (https://mavlink.io/en/services/mission.html,
"Detecting Mission/Plan Changes").
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterable, Sequence

from dialects.enums import MissionType
from link.services.mission.items import Items, MissionItem

_ITEM = struct.Struct("<HB?4fiif")


class PlanSet:
    """One plan of each supported type, empty at first."""

    def __init__(self, kinds: Iterable[MissionType]) -> None:
        self._plans: dict[MissionType, Items] = dict.fromkeys(kinds, ())
        self._ids = dict.fromkeys(self._plans, 0)

    def __getitem__(self, kind: MissionType) -> Items:
        return self._plans[kind]

    def get_id(self, kind: MissionType) -> int:
        """Return the plan's id, uint32; 0: the plan is empty."""
        return self._ids[kind]

    def kind(self, number: int) -> MissionType | None:
        """Return the plan type of this MAV_MISSION_TYPE, if it is supported."""
        return next((kind for kind in self._plans if kind == number), None)

    def set(self, kind: MissionType, items: Sequence[MissionItem]) -> None:
        """Replace a plan."""
        self._plans[kind] = tuple(items)
        self._ids[kind] = plan_id(items)


def plan_id(items: Sequence[MissionItem]) -> int:
    """Return the id, uint32, 0 only for an empty plan. Floats count as float32, and all NaNs as equal."""
    data = b"".join(_bytes(item) for item in items)
    return zlib.crc32(data) or 1 if data else 0


def _bytes(item: MissionItem) -> bytes:
    params = [math.nan if math.isnan(value) else value for value in (*item.params, item.z)]
    return _ITEM.pack(item.command, item.frame, item.autocontinue, *params[:4], item.x, item.y, params[4])
