"""Two-phase plan changes: a plan takes effect, and MISSION_ACK is sent, once it is on disk.

Until then the old plan is in force, so that MISSION_ACK, the plan's id and what a power cut leaves never contradict
each other. If the disk fails or does not answer, or the vehicle has meanwhile started to use the old plan, nothing has
changed, and the reply says so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

import msgspec

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing
from link.services.mission.items import Items
from link.services.mission.plans import PlanSet
from link.services.mission.upload import MissionPeer

WRITE_TIMEOUT = 8.0
"""s for a disk: as long as the vehicle waits for an item. Clients repeat their last message, or give up before."""


class PendingPlanWrite(Protocol):
    """A plan that is being written."""

    @property
    def done(self) -> bool:
        """Whether the write has ended, with or without success."""

    @property
    def problem(self) -> str | None:
        """Why the write failed, in one line."""


class PlanBackend(Protocol):
    """Stores plans, and is notified of changes."""

    def write_plan(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Start to write a plan. Never blocks and never raises."""

    def handle_plan_changed(self, kind: MissionType, items: Items) -> None:
        """Use a plan that is on disk now."""

    def handle_change_failed(self, kind: MissionType, items: Items, reason: str | None) -> None:
        """Keep the old plan: `items` stay in force, and must be on disk as well. `reason`: of a disk error."""


class PlanChange(msgspec.Struct):
    """New plans that take effect together: one of an upload, or all that are cleared at once."""

    plans: Mapping[MissionType, Items]
    allowed: Callable[[], MissionResult]
    """Whether the change may be made now, by the sender as it was when its last message arrived: a write may take
    longer than a proof of the sender is valid. Checked before the write and again after it."""
    build_reply: Callable[[MissionResult, float], list[Outgoing]] = lambda verdict, now: []
    """Builds the reply."""
    sender: MissionPeer | None = None
    cause: m.Message | None = None
    """The sender's last message, which has no reply yet."""
    verdict: MissionResult | None = None
    """None: under way."""
    began: float = 0.0
    writes: list[PendingPlanWrite] = msgspec.field(default_factory=list)

    def is_repeat(self, message: m.MissionCount | m.MissionClearAll | m.MissionWritePartialList) -> bool:
        """Return whether `message` repeats the cause, because no reply has arrived yet."""
        cause = self.cause
        same = type(cause) is type(message) and cause.mission_type == message.mission_type
        return same and getattr(message, "count", 0) == 0


class PlanChanges:
    """The changes under way, at most one of each plan type."""

    def __init__(self, plans: PlanSet, backend: PlanBackend) -> None:
        self._plans = plans
        self._backend = backend
        self._under_way: list[PlanChange] = []

    def pending(self, kind: MissionType) -> PlanChange | None:
        """Return the change of this plan type that is under way."""
        return next((change for change in self._under_way if kind in change.plans), None)

    def begin(self, change: PlanChange, now: float) -> list[Outgoing]:
        """Start to write a change; return the reply if it is known at once."""
        change.began = now
        verdict = change.allowed()
        if verdict is not MissionResult.ACCEPTED:
            change.verdict = verdict
            return change.build_reply(verdict, now)
        change.writes = [self._backend.write_plan(kind, items) for kind, items in change.plans.items()]
        self._under_way.append(change)
        return self._finish_if_done(change, now)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the replies to changes that are done."""
        return [answer for change in list(self._under_way) for answer in self._finish_if_done(change, now)]

    def _finish_if_done(self, change: PlanChange, now: float) -> list[Outgoing]:
        """Return the reply of a change that is done or takes too long; nothing while it is under way."""
        if not all(write.done for write in change.writes) and now - change.began < WRITE_TIMEOUT:
            return []
        self._under_way.remove(change)
        change.verdict = self._end(change, now)
        return change.build_reply(change.verdict, now)

    def _end(self, change: PlanChange, now: float) -> MissionResult:
        problems = (each.problem if each.done else "the disk does not answer" for each in change.writes)
        reason = next(filter(None, problems), None)
        verdict = MissionResult.ERROR if reason else change.allowed()
        for kind, items in change.plans.items():
            if verdict is MissionResult.ACCEPTED:
                self._plans.set(kind, items)
                self._backend.handle_plan_changed(kind, items)
            else:
                self._backend.handle_change_failed(kind, self._plans[kind], reason)
        return verdict
