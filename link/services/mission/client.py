"""Client half of the mission protocol: uploads, downloads or clears one plan of a vehicle.

The vehicle requests the items of an upload, and the client those of a download; whoever requests also repeats. Source:
https://mavlink.io/en/services/mission.html.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

import msgspec

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing, Received
from link.services.mission.items import Items, MissionItem, from_message, to_message

REPEAT_AFTER = 0.7
"""s without an answer before the last message is repeated: longer than the vehicle's own timeout
(upload.REQUEST_TIMEOUT), so that in an upload the vehicle repeats first."""
TRIES = 16
"""Repeats before a job fails: 11 s, longer than the 8 s after which the vehicle cancels an upload. At 30 % loss each
way all of them fail once in 48 000 items."""
RESTARTS = 2
"""How often an upload is restarted that the vehicle has cancelled for lack of items."""


_NOT_OF_AN_ITEM = (
    MissionResult.ACCEPTED,
    MissionResult.ERROR,
    MissionResult.NO_SPACE,
    MissionResult.DENIED,
    MissionResult.CANCELLED,
)
"""Results that are about the whole job."""


class MissionOperation(Enum):
    """What the client is doing."""

    UPLOAD = "upload"
    DOWNLOAD = "download"
    CLEAR = "clear"


class MissionOutcome(msgspec.Struct, frozen=True):
    """How a job ended."""

    job: MissionOperation
    kind: MissionType
    result: int | None
    """MAV_MISSION_RESULT; None: no answer."""
    items: Items = ()
    """Items of a download; of one that failed those that arrived, from the first, with which it can be resumed."""
    item: int | None = None
    """Number of the item that the vehicle has refused, as far as its MISSION_ACK shows: it came before all were
    sent."""
    count: int | None = None
    """Length of the plan, where known."""
    tries: int = 0
    """How often the last message was sent."""
    plan_id: int = 0
    """Id of the vehicle's plan after an upload or a download (a different one in MISSION_CURRENT means that the plan
    has changed); 0: the plan is empty, or the vehicle has no ids."""

    @property
    def done(self) -> bool:
        """Whether the job succeeded."""
        return self.result == MissionResult.ACCEPTED


class _MissionTransfer(msgspec.Struct):
    """The job under way."""

    job: MissionOperation
    kind: MissionType
    items: list[MissionItem]
    """Items to upload, or downloaded so far."""
    last: m.Message
    """The last message, which is repeated."""
    due: float
    sent: int = 1
    restarts: int = 0
    count: int | None = None
    """Items of a download, once known."""
    plan_id: int = 0
    resumed: MissionOutcome | None = None
    """The download that failed and is resumed."""


class MissionClient:
    """Talks to one vehicle, one job at a time; a new job replaces the one under way."""

    def __init__(self, system: int, component: int, *, target_system: int, target_component: int = 1) -> None:
        self._ids = (system, component)
        self._target = (target_system, target_component)
        self._work: _MissionTransfer | None = None
        self._outbox: list[Outgoing] = []
        self._outcomes: list[MissionOutcome] = []

    def upload(self, items: Sequence[MissionItem], kind: MissionType, now: float) -> None:
        """Replace the vehicle's plan."""
        count = m.MissionCount(*self._target, len(items), kind)
        self._begin(MissionOperation.UPLOAD, kind, count, now, items)

    def download(self, kind: MissionType, now: float, resume: MissionOutcome | None = None) -> None:
        """Download the vehicle's plan. `resume`: a download that failed; its items are kept if the plan is the same."""
        self._begin(MissionOperation.DOWNLOAD, kind, m.MissionRequestList(*self._target, kind), now)
        if self._work is not None and resume is not None and resume.kind == kind:
            self._work.resumed = resume

    def cancel(self) -> None:
        """Cancel the job under way, without an outcome; tell the vehicle."""
        if self._work is not None:
            kind = self._work.kind
            self._outbox.append(Outgoing(m.MissionAck(*self._target, MissionResult.CANCELLED, kind)))
        self._work = None

    def clear(self, kind: MissionType, now: float) -> None:
        """Clear the vehicle's plan; MissionType.ALL clears all three."""
        self._begin(MissionOperation.CLEAR, kind, m.MissionClearAll(*self._target, kind), now)

    @property
    def busy(self) -> bool:
        """Whether a job is under way."""
        return self._work is not None

    @property
    def progress(self) -> tuple[int, int | None]:
        """Items that were transferred, and the total."""
        work = self._work
        if work is None:
            return 0, None
        if work.job is MissionOperation.DOWNLOAD:
            return len(work.items), work.count
        return getattr(work.last, "seq", 0), len(work.items)

    def receive(self, received: Received, now: float) -> None:
        """Handle the vehicle's messages about the plan; others are ignored."""
        message, work = received.message, self._work
        if work is None or received.system != self._target[0] or not self._ours(message, work):
            return
        match message:
            case m.MissionRequestInt() | m.MissionRequest() if work.job is MissionOperation.UPLOAD:
                self._send_item(work, message.seq, now)
            case m.MissionCount() if work.job is MissionOperation.DOWNLOAD and work.count is None:
                work.count, work.plan_id = message.count, message.opaque_id
                self._take_resumed(work)
                self._next(work, now)
            case m.MissionItemInt() | m.MissionItem() if (
                work.job is MissionOperation.DOWNLOAD and work.count is not None
            ):
                if message.seq == len(work.items) < work.count:
                    work.items.append(from_message(message))
                    self._next(work, now)
            case m.MissionAck() if message.type != MissionResult.ACCEPTED or self._sent_all(work):
                work.plan_id = message.opaque_id
                self._acknowledged(work, message.type, now)

    def tick(self, now: float) -> None:
        """Repeat the last message when its answer is late, and give up at last."""
        work = self._work
        if work is None or now < work.due:
            return
        if work.sent >= TRIES:
            self._finish(work, None)
        else:
            work.sent += 1
            work.due = now + REPEAT_AFTER
            self._outbox.append(Outgoing(work.last))

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[MissionOutcome]:
        """Return the jobs that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _begin(
        self, job: MissionOperation, kind: MissionType, first: m.Message, now: float, items: Sequence[MissionItem] = ()
    ) -> None:
        self._work = _MissionTransfer(job, kind, list(items), first, now + REPEAT_AFTER)
        self._outbox.append(Outgoing(first))

    def _ours(self, message: m.Message, work: _MissionTransfer) -> bool:
        target = (getattr(message, "target_system", 0), getattr(message, "target_component", 0))
        addressed = target[0] in (0, self._ids[0]) and target[1] in (0, self._ids[1])
        return addressed and getattr(message, "mission_type", None) == work.kind

    @staticmethod
    def _sent_all(work: _MissionTransfer) -> bool:
        """Return whether MISSION_ACK can be for this job: a repeated one of the job before arrives earlier."""
        if work.job is MissionOperation.UPLOAD:
            return getattr(work.last, "seq", -1) == len(work.items) - 1
        return work.job is MissionOperation.CLEAR

    def _send(self, work: _MissionTransfer, message: m.Message, now: float) -> None:
        work.last, work.sent, work.due = message, 1, now + REPEAT_AFTER
        self._outbox.append(Outgoing(message))

    def _send_item(self, work: _MissionTransfer, sequence: int, now: float) -> None:
        if sequence < len(work.items):
            self._send(work, to_message(work.items[sequence], sequence, work.kind, self._target), now)

    @staticmethod
    def _take_resumed(work: _MissionTransfer) -> None:
        """Keep the items of a failed download if the vehicle's id shows that the plan is still the same."""
        before = work.resumed
        if before is not None and work.plan_id and (before.plan_id, before.count) == (work.plan_id, work.count):
            work.items = list(before.items)

    def _next(self, work: _MissionTransfer, now: float) -> None:
        """Request the next item of a download, or acknowledge the last."""
        if len(work.items) == work.count:
            self._outbox.append(Outgoing(m.MissionAck(*self._target, MissionResult.ACCEPTED, work.kind)))
            self._finish(work, MissionResult.ACCEPTED)
        else:
            self._send(work, m.MissionRequestInt(*self._target, len(work.items), work.kind), now)

    def _acknowledged(self, work: _MissionTransfer, result: int, now: float) -> None:
        cancelled = result == MissionResult.CANCELLED and work.job is MissionOperation.UPLOAD
        if cancelled and work.restarts < RESTARTS:
            work.restarts += 1
            self._send(work, m.MissionCount(*self._target, len(work.items), work.kind), now)
        else:
            self._finish(work, result)

    def _finish(self, work: _MissionTransfer, result: int | None) -> None:
        self._work = None
        items = tuple(work.items) if work.job is MissionOperation.DOWNLOAD else ()
        count = work.count if work.job is MissionOperation.DOWNLOAD else len(work.items)
        self._outcomes.append(
            MissionOutcome(
                work.job, work.kind, result, items, self._refused_item(work, result), count, work.sent, work.plan_id
            )
        )

    def _refused_item(self, work: _MissionTransfer, result: int | None) -> int | None:
        """Return the item that a MISSION_ACK refuses: the last that was sent, unless all were."""
        sequence: int | None = getattr(work.last, "seq", None)
        if work.job is not MissionOperation.UPLOAD or result in (None, *_NOT_OF_AN_ITEM) or sequence is None:
            return None
        return sequence if not self._sent_all(work) or len(work.items) == 1 else None
