"""What remembers plans for the next start; vehicle/storage/plan_store.py is one."""

from __future__ import annotations

from typing import Protocol

from dialects.enums import MissionType
from link.services.mission.commit import NullPlanWrite, PendingPlanWrite
from link.services.mission.items import Items


class PlanStoreLike(Protocol):
    """Remembers plans for the next start."""

    plans: dict[MissionType, Items]
    """What was kept."""
    damage: dict[MissionType, str]
    """Why a kept plan could not be had."""

    @property
    def problem(self) -> str | None:
        """Why plans are not kept, one line."""

    @property
    def idle(self) -> bool:
        """Nothing is being written."""

    def save(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Remember it, soon, and say when it is. Never blocks and never raises."""


class NullPlanStore:
    """Plans end with the program, as in the simulator."""

    problem: str | None = None
    idle = True

    def __init__(self) -> None:
        self.plans: dict[MissionType, Items] = {}
        self.damage: dict[MissionType, str] = {}

    def save(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Forget it."""
        return NullPlanWrite()
