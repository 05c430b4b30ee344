"""Plans on their way to where they survive a restart: a change counts, and is answered, when the disk has it.

Until then the plan before is in force, so that MISSION_ACK, the plan's id and what a power cut leaves never contradict
each other. Where the disk refuses, or does not answer, or the vehicle has set off by the old plan meanwhile, nothing
has changed, and the answer says so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing
from link.services.mission.items import Items
from link.services.mission.plans import PlanTable
from link.services.mission.upload import Sender

WRITE_TIMEOUT = 8.0
"""s for a disk: as long as the vehicle waits for an item. Clients say their last word again, or give up before."""


class PendingPlanWrite(Protocol):
    """A plan that is being written."""

    @property
    def done(self) -> bool:
        """It is there, or it failed."""

    @property
    def problem(self) -> str | None:
        """Why it failed, in one line."""


class NullPlanWrite:
    """Of a vehicle that keeps nothing: plans end with the program, as everybody knows."""

    done = True
    problem: str | None = None


class PlanBackend(Protocol):
    """Whose plans they are."""

    def write_plan(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Begin to write it. Never blocks and never raises."""

    def handle_plan_changed(self, kind: MissionType, items: Items) -> None:
        """It is kept: drive by it."""

    def handle_change_failed(self, kind: MissionType, items: Items, why: str | None) -> None:
        """A change came to nothing: `items` stay in force, and shall be what is kept, too. `why`: the disk's reason."""


@dataclass(slots=True)
class PlanChange:
    """New plans that count together: one of an upload, or all that are cleared at once."""

    plans: Mapping[MissionType, Items]
    allowed: Callable[[float], MissionResult]
    """May it be made now? Asked before it is written and again after."""
    build_reply: Callable[[MissionResult, float], list[Outgoing]] = lambda verdict, now: []
    """The answer."""
    sender: Sender | None = None
    cause: m.Message | None = None
    """The last word of its sender, to which nothing was answered yet."""
    verdict: MissionResult | None = None
    """None: under way."""
    began: float = 0.0
    writes: list[PendingPlanWrite] = field(default_factory=list)

    def is_repeat(self, message: m.MissionCount | m.MissionClearAll | m.MissionWritePartialList) -> bool:
        """Is this its cause, said again because no answer has come yet?"""
        cause = self.cause
        same = type(cause) is type(message) and cause.mission_type == message.mission_type
        return same and getattr(message, "count", 0) == 0


class PlanChanges:
    """Those under way, at most one of a kind of plan."""

    def __init__(self, shelf: PlanTable, owner: PlanBackend) -> None:
        self._shelf = shelf
        self._owner = owner
        self._under_way: list[PlanChange] = []

    def pending(self, kind: MissionType) -> PlanChange | None:
        """The change of this plan, while it is under way."""
        return next((change for change in self._under_way if kind in change.plans), None)

    def begin(self, change: PlanChange, now: float) -> list[Outgoing]:
        """Have it written. Returns the answer where that is known at once."""
        change.began = now
        verdict = change.allowed(now)
        if verdict is not MissionResult.ACCEPTED:
            change.verdict = verdict
            return change.build_reply(verdict, now)
        change.writes = [self._owner.write_plan(kind, items) for kind, items in change.plans.items()]
        self._under_way.append(change)
        return self._settled(change, now)

    def tick(self, now: float) -> list[Outgoing]:
        """The answers to what is done."""
        return [answer for change in list(self._under_way) for answer in self._settled(change, now)]

    def _settled(self, change: PlanChange, now: float) -> list[Outgoing]:
        """Its answer, where it is done or takes too long; nothing while it is under way."""
        if not all(keeping.done for keeping in change.writes) and now - change.began < WRITE_TIMEOUT:
            return []
        self._under_way.remove(change)
        change.verdict = self._end(change, now)
        return change.build_reply(change.verdict, now)

    def _end(self, change: PlanChange, now: float) -> MissionResult:
        problems = (each.problem if each.done else "the disk does not answer" for each in change.writes)
        why = next(filter(None, problems), None)
        verdict = MissionResult.ERROR if why else change.allowed(now)
        for kind, items in change.plans.items():
            if verdict is MissionResult.ACCEPTED:
                self._shelf.set(kind, items)
                self._owner.handle_plan_changed(kind, items)
            else:
                self._owner.handle_change_failed(kind, self._shelf[kind], why)
        return verdict
