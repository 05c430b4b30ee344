"""A vehicle with plans, for the tests of the mission protocol."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Peer, Received
from link.services.mission.commit import PendingPlanWrite
from link.services.mission.items import ItemRequest, ItemRule, Items, MissionItem, PlanRules, PositionRule
from link.services.mission.server import MissionServer
from link.services.pacing import BulkPacer
from tests.link.services_world import from_gcs, messages

NAV_WAYPOINT, NAV_LOITER_TIME, DO_JUMP, FENCE_CIRCLE = 16, 19, 177, 5003
RULES = {
    MissionType.MISSION: PlanRules(
        {
            NAV_WAYPOINT: ItemRule(PositionRule.NEEDED),
            NAV_LOITER_TIME: ItemRule(PositionRule.OPTIONAL, {1: (0.0, 3600.0)}),
            DO_JUMP: ItemRule(ranges={1: (0, 99), 2: (-1, 100)}),
        },
        capacity=300,
        check=lambda items: (
            MissionResult.ACCEPTED
            if all(item.params[0] < len(items) for item in items if item.command == DO_JUMP)
            else MissionResult.INVALID_PARAM1
        ),
    ),
    MissionType.FENCE: PlanRules({FENCE_CIRCLE: ItemRule(PositionRule.NEEDED, {1: (1, 1000)})}, capacity=10),
    MissionType.RALLY: PlanRules({5100: ItemRule(PositionRule.NEEDED)}, capacity=10),
}


def waypoint(number: int = 0, **changes: Any) -> MissionItem:
    values: dict[str, Any] = {
        "command": NAV_WAYPOINT,
        "frame": 3,
        "params": (0.0, 1.0, 0.0, math.nan),
        "x": 473977420 + number * 100,
        "y": 85455940,
        "z": 0.5,
    }
    return MissionItem(**(values | changes))


def plain(items: Items) -> list[str]:
    """Items as text: NaN is not equal to itself."""
    return [repr(item) for item in items]


class NullPlanWrite:
    """A write that does nothing."""

    done = True
    problem: str | None = None


@dataclass
class Writing:
    """A plan on its way to a slow disk."""

    kind: MissionType
    length: int
    done: bool = False
    problem: str | None = None


@dataclass
class MissionRig:
    """A server, and what it told its vehicle."""

    verdict: MissionResult = MissionResult.ACCEPTED
    changes: list[tuple[MissionType, int]] = field(default_factory=list)
    disk: list[Writing] | None = None
    """What is being written, where there is a disk."""
    stayed: list[tuple[MissionType, int, str | None]] = field(default_factory=list)
    unfits: list[tuple[MissionType, int | None, MissionResult]] = field(default_factory=list)
    selected: list[int] = field(default_factory=list)
    requests: list[tuple[ItemRequest, MissionItem]] = field(default_factory=list)
    """Items that were not part of a plan."""
    at: int = 0
    pacer: BulkPacer | None = None
    others: list[Peer] = field(default_factory=list)
    """Where else every sender is."""

    def __post_init__(self) -> None:
        self.server = MissionServer(
            self, RULES, system=1, component=1, pacer=self.pacer, other_peers=lambda received, now: self.others
        )

    def authorize_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        return self.verdict

    def write_plan(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        if self.disk is None:
            return NullPlanWrite()
        self.disk.append(Writing(kind, len(items)))
        return self.disk[-1]

    def handle_change_failed(self, kind: MissionType, items: Items, why: str | None) -> None:
        self.stayed.append((kind, len(items), why))

    def handle_plan_changed(self, kind: MissionType, items: Items) -> None:
        self.changes.append((kind, len(items)))

    def handle_plan_rejected(
        self,
        kind: MissionType,
        wrong: tuple[int, MissionItem] | None,
        verdict: MissionResult,
        received: Received | None,
        now: float,
    ) -> None:
        self.unfits.append((kind, wrong[0] if wrong else None, verdict))

    def set_current_item(self, sequence: int, received: Received, now: float) -> None:
        self.selected.append(sequence)
        self.at = sequence

    def handle_item_request(
        self, request: ItemRequest, item: MissionItem, received: Received, now: float
    ) -> MissionResult:
        self.requests.append((request, item))
        return self.verdict

    def build_mission_current(self) -> m.MissionCurrent:
        return m.MissionCurrent(self.at)

    def ask(self, message: m.Message, now: float = 0.0, **who: Any) -> list[Any]:
        return messages(self.server.receive(from_gcs(message, **who), now))

    def give(self, item: MissionItem, sequence: int, now: float = 0.0, kind: int = 0, **who: Any) -> list[Any]:
        return self.ask(item_int(item, sequence, kind), now, **who)

    def tick(self, now: float) -> list[Any]:
        return messages(self.server.tick(now))

    @property
    def plan(self) -> Items:
        return self.server.plan(MissionType.MISSION)

    def upload(self, items: list[MissionItem]) -> None:
        self.ask(m.MissionCount(1, 1, len(items)))
        for sequence, item in enumerate(items):
            self.give(item, sequence)


def item_int(item: MissionItem, sequence: int, kind: int = 0) -> m.MissionItemInt:
    return m.MissionItemInt(1, 1, sequence, item.frame, item.command, 0, 1, *item.params, item.x, item.y, item.z, kind)
