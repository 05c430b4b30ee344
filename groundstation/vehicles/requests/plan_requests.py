"""The plans of one vehicle: mission, fence and rally, downloaded, uploaded and cleared one after the other."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

import msgspec

from dialects.enums import MissionResult, MissionType
from dialects.result_texts import mission_result_name
from groundstation.formats.plan import Plan, PlannedHome, for_vehicle
from groundstation.vehicles.requests.requests import RequestBook
from link.core import Received
from link.services.mission.client import MissionClient, MissionOutcome
from link.services.mission.items import Items, MissionItem

if TYPE_CHECKING:
    from groundstation.intents.plan import UploadPlan

_NAMES = {
    MissionType.MISSION: "mission",
    MissionType.FENCE: "fence",
    MissionType.RALLY: "rally points",
    MissionType.ALL: "all plans",
}

_PARTS: dict[MissionType, Callable[[Items, PlannedHome | None], Plan]] = {
    MissionType.MISSION: lambda items, home: Plan(mission=items, home=home),
    MissionType.FENCE: lambda items, _: Plan(fence=items),
    MissionType.RALLY: lambda items, _: Plan(rally=items),
}


class _PlanJob(msgspec.Struct, frozen=True):
    """A request that waits, or is under way."""

    number: int
    kind: MissionType
    begin: Callable[[float], None]
    items: Items | None = None
    """Of an upload; () of a clear; None of a download."""


class PlanRequests:
    """Requests about plans. `plans` are those that were downloaded or uploaded."""

    def __init__(self, client: MissionClient, book: RequestBook) -> None:
        self._client = client
        self._book = book
        self.plans: dict[MissionType, Items] = {}
        self.versions: dict[MissionType, int] = {}
        """How often each of `plans` was replaced."""
        self.ids: dict[MissionType, int] = {}
        """Ids that the vehicle gave them; 0: it is empty, or the vehicle has no ids."""
        self._jobs: deque[_PlanJob] = deque()
        self._under_way: _PlanJob | None = None
        self._failed: dict[MissionType, MissionOutcome] = {}
        """Downloads that were not answered to the end, which the next one resumes."""

    # ---- requests ----

    def download(self, number: int, kind: int, now: float) -> None:
        """Download a plan; one that failed before is resumed if it is still the same."""
        plan = MissionType(kind)
        job = _PlanJob(number, plan, lambda later: self._client.download(plan, later, self._failed.pop(plan, None)))
        self._add(job, f"download {_NAMES[plan]}", now)

    def upload_edited(self, intent: UploadPlan, autopilot: int, now: float) -> None:
        """Replace a plan by one that a screen has edited, in the form that this autopilot keeps."""
        kind = MissionType(intent.kind)
        items = tuple(
            MissionItem(each.command, each.frame, each.params, each.x, each.y, each.z, each.autocontinue)
            for each in intent.items
        )
        place = intent.home
        home = place and PlannedHome(place.latitude, place.longitude, intent.home_altitude)
        self.upload(intent.request, kind, for_vehicle(_PARTS[kind](items, home), kind, autopilot), now)

    def upload(self, number: int, kind: MissionType, items: Sequence[MissionItem], now: float) -> None:
        """Replace a plan; the old one stays until the vehicle has accepted the whole new one."""
        whole = tuple(items)
        job = _PlanJob(number, kind, lambda later: self._client.upload(whole, kind, later), whole)
        self._add(job, f"upload {_NAMES[kind]} of {len(whole)} items", now)

    def take(self, kind: MissionType, items: Items, version: int, plan_id: int) -> None:
        """Store a plan that was not requested here: of a log. `version` differs from those of its other plans."""
        self.plans[kind], self.versions[kind], self.ids[kind] = items, version, plan_id

    def forget(self, kind: MissionType) -> None:
        """Forget a plan: the vehicle has another one, which is not known."""
        for kept in (self.plans, self.versions, self.ids):
            kept.pop(kind, None)

    def clear(self, number: int, kind: int, now: float) -> None:
        """Clear a plan."""
        plan = MissionType(kind)
        job = _PlanJob(number, plan, lambda later: self._client.clear(plan, later), ())
        self._add(job, f"clear {_NAMES[plan]}", now)

    def cancel(self, number: int, now: float) -> None:
        """Cancel a request."""
        if self._under_way is not None and self._under_way.number == number:
            self._client.cancel()
            self._under_way = None
        elif all(job.number != number for job in self._jobs):
            return
        self._jobs = deque(job for job in self._jobs if job.number != number)
        self._book.cancel(number)
        self._begin_next(now)

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, report progress."""
        self._client.tick(now)
        self._handle_outcomes(now)
        if self._under_way is not None:
            self._book.advance(self._under_way.number, *self._client.progress)

    # ---- jobs ----

    def _add(self, job: _PlanJob, what: str, now: float) -> None:
        if self._book.begin(job.number, what):
            self._jobs.append(job)
            self._begin_next(now)

    def _begin_next(self, now: float) -> None:
        if self._under_way is None and self._jobs:
            self._under_way = self._jobs.popleft()
            self._under_way.begin(now)

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            job, self._under_way = self._under_way, None
            if job is not None:
                self._end(job, outcome, now)
            self._begin_next(now)

    def _end(self, job: _PlanJob, outcome: MissionOutcome, now: float) -> None:
        if outcome.done:
            self._store(job, outcome)
            self._book.accept(job.number, f"{len(outcome.items)} items" if job.items is None else "")
        elif outcome.result is None:
            if job.items is None:
                self._failed[job.kind] = outcome
            self._book.fail(job.number, f"after {outcome.tries} tries{_where(outcome)}")
        else:
            self._book.refuse(job.number, _refusal_text(outcome), now)

    def _store(self, job: _PlanJob, outcome: MissionOutcome) -> None:
        kinds = [job.kind] if job.kind is not MissionType.ALL else [each for each in MissionType if each != job.kind]
        for kind in kinds:
            self.plans[kind] = outcome.items if job.items is None else job.items
            self.versions[kind] = self.versions.get(kind, 0) + 1
            self.ids[kind] = outcome.plan_id if self.plans[kind] else 0


def _where(outcome: MissionOutcome) -> str:
    """Return how far a download came."""
    return f", {len(outcome.items)} of {outcome.count} items arrived" if outcome.count and outcome.items else ""


def _refusal_text(outcome: MissionOutcome) -> str:
    """Return MAV_MISSION_RESULT by name, with the item where the vehicle's answer shows it."""
    name = mission_result_name(outcome.result if outcome.result is not None else MissionResult.ERROR)
    return name if outcome.item is None else f"item {outcome.item}: {name}"
