"""The mission protocol of a vehicle: its three plans (mission, fence, rally), uploaded, downloaded and cleared.

Rules (mavlink.io/en/services/mission.html): an upload is asked for item by item and counts only when it is complete
and valid; until then the old plan stays. One upload a plan at a time, a second sender is DENIED. Who uploads may end
it by a MISSION_ACK with an error. What a plan means is the vehicle's work, and so is saving it; the last answer waits
for that (commit.py). Reading is in download.py, ids are in plans.py; the other half is
client.py.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import Outgoing, Received
from link.services.mission.commit import PlanBackend, PlanChange, PlanChanges
from link.services.mission.download import PlanDownloads
from link.services.mission.items import Items, MissionItem, PlanRules
from link.services.mission.plans import PlanTable
from link.services.mission.upload import PlanUpload, Sender, ack, sender_of
from link.services.pacing import BulkPacer

REPEAT_WINDOW = 10.0
"""s in which the last item, said again because our answer was lost, is answered again."""

_Begin = m.MissionCount | m.MissionWritePartialList | m.MissionClearAll
_Item = m.MissionItem | m.MissionItemInt


class MissionBackend(PlanBackend, Protocol):
    """What the vehicle says to its plans."""

    def authorize_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        """ACCEPTED, or the answer to who may not change this plan now."""

    def handle_plan_rejected(
        self, kind: MissionType, wrong: tuple[int, MissionItem] | None, verdict: MissionResult, now: float
    ) -> None:
        """A plan was refused for this item, with its number, or as a whole: MISSION_ACK does not say which."""

    def set_current_item(self, sequence: int, received: Received, now: float) -> None:
        """Go on with this item of the mission, or tell the driver why not."""

    def build_mission_current(self) -> m.MissionCurrent:
        """Where the mission stands."""


@dataclass(frozen=True, slots=True)
class _EndedUpload:
    """The end of an upload, to be said again when it got lost."""

    sender: Sender
    last: int
    at: float
    ack: Outgoing


class MissionServer:
    """Keeps the plans of one system and component. `rules` has a line for each kind of plan that is offered."""

    def __init__(
        self,
        planner: MissionBackend,
        rules: Mapping[MissionType, PlanRules],
        *,
        system: int,
        component: int,
        pacer: BulkPacer | None = None,
    ) -> None:
        self._planner = planner
        self._rules = rules
        self._ids = (system, component)
        self._shelf = PlanTable(rules)
        self._changes = PlanChanges(self._shelf, planner)
        self._downloads = PlanDownloads(
            self._shelf, pacer or BulkPacer(), lambda: int(planner.build_mission_current().seq)
        )
        self._uploads: dict[MissionType, PlanUpload] = {}
        self._ended: dict[MissionType, _EndedUpload] = {}
        self._now = 0.0
        """Of the newest tick."""

    def plan(self, kind: MissionType) -> Items:
        """The plan in force."""
        return self._shelf[kind]

    def plan_id(self, kind: MissionType) -> int:
        """Its id: another one for another plan, 0 for none."""
        return self._shelf.get_id(kind)

    @property
    def has_pending_changes(self) -> bool:
        """A plan is on its way to where it is kept."""
        return any(map(self._changes.pending, self._rules))

    def load(self, kind: MissionType, items: Sequence[MissionItem]) -> MissionResult:
        """Put a saved plan in force, where it passes the rules; the planner is not told."""
        verdict = self._rules[kind].validate(items)
        if verdict is MissionResult.ACCEPTED:
            self._shelf.set(kind, items)
        return verdict

    def replace(
        self, plans: Mapping[MissionType, Sequence[MissionItem]], allowed: Callable[[MissionType], bool]
    ) -> PlanChange | None:
        """Change plans in another way than by upload, e.g. as files: how that goes. None where it breaks the rules, of
        which the planner is told, or where somebody is changing one of them.
        """
        for kind, items in plans.items():
            verdict = self._rules[kind].validate(items)
            if verdict is not MissionResult.ACCEPTED:
                self._planner.handle_plan_rejected(kind, self._rules[kind].first_invalid(items), verdict, self._now)
                return None
        if any(self._uploads.get(kind) or self._changes.pending(kind) for kind in plans):
            return None
        change = PlanChange(
            {kind: tuple(items) for kind, items in plans.items()},
            lambda now: MissionResult.ACCEPTED if all(map(allowed, plans)) else MissionResult.DENIED,
        )
        self._changes.begin(change, self._now)  # it answers nobody
        return change

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing where it is not for us or its sender may not ask."""
        message = received.message
        target = (getattr(message, "target_system", None), getattr(message, "target_component", None))
        if not received.may_ask or target[0] != self._ids[0] or target[1] not in (0, self._ids[1]):
            return []
        answer = self._downloads.receive(received)
        if answer is not None:
            return answer
        return self._handle_write(received, now) if received.introduced else []

    def tick(self, now: float) -> list[Outgoing]:
        """Ask again for what did not come, give up what does not come at all."""
        self._now = now
        outgoing = self._downloads.tick(now) + self._changes.tick(now)
        for kind, upload in list(self._uploads.items()):
            if upload.is_overdue(now):
                del self._uploads[kind]
                outgoing.append(ack(upload.sender, kind, MissionResult.CANCELLED))
            else:
                outgoing += upload.repeat_request(now)
        return outgoing

    def _handle_write(self, received: Received, now: float) -> list[Outgoing]:
        match received.message:
            case m.MissionCount() | m.MissionWritePartialList() | m.MissionClearAll() as message:
                return self._begin(message, received, now)
            case m.MissionItem() | m.MissionItemInt() as message:
                return self._handle_item(message, received, now)
            case m.MissionAck() as message if message.type != MissionResult.ACCEPTED:
                return self._handle_ack(message, sender_of(received), now)
            case m.MissionSetCurrent() as message:
                self._planner.set_current_item(message.seq, received, now)
                return [Outgoing(self._planner.build_mission_current())]
        return []

    def _begin(self, message: _Begin, received: Received, now: float) -> list[Outgoing]:
        sender, number = sender_of(received), message.mission_type
        kinds = [kind for kind in self._rules if number == kind]
        if number == MissionType.ALL and isinstance(message, m.MissionClearAll):
            kinds = list(self._rules)
        if not kinds:
            return [ack(sender, number, MissionResult.UNSUPPORTED)]
        if any(self._is_saving(kind, message, sender) for kind in kinds):
            return []
        verdict = _first_refusal(self._may_begin(kind, received, now) for kind in kinds)
        if verdict is not MissionResult.ACCEPTED:
            return [ack(sender, number, verdict)]
        match message:
            case m.MissionClearAll():
                return self._clear(message, kinds, received, now)
            case m.MissionCount():
                return self._begin_upload(message, received, kinds[0], now)
            case _:
                return [self._begin_partial_upload(message, sender, kinds[0], now)]

    def _is_saving(self, kind: MissionType, message: _Begin, sender: Sender) -> bool:
        """A sender whose last change is not kept yet waits: it says this again. An answer to the change would look like
        one to this, so there is none any more, unless this asks for the same.
        """
        change = self._changes.pending(kind)
        if change is None or change.sender != sender:
            return False
        if not change.is_repeat(message):
            change.build_reply = lambda verdict, now: []
        return True

    def _may_begin(self, kind: MissionType, received: Received, now: float) -> MissionResult:
        """The same sender may begin again at any time."""
        busy = self._changes.pending(kind) or self._uploads.get(kind)
        if busy and busy.sender != sender_of(received):
            return MissionResult.DENIED
        return self._planner.authorize_write(received, kind, now)

    def _begin_upload(
        self, message: m.MissionCount, received: Received, kind: MissionType, now: float
    ) -> list[Outgoing]:
        sender, rules = sender_of(received), self._rules[kind]
        if message.count > rules.capacity:
            return [ack(sender, kind, MissionResult.NO_SPACE)]
        upload = PlanUpload(sender, kind, rules, end=message.count, now=now)
        if not message.count:
            return self._end(upload, rules.check(()), received, now)
        self._uploads[kind] = upload
        return [upload.request_item(now)]

    def _begin_partial_upload(
        self, message: m.MissionWritePartialList, sender: Sender, kind: MissionType, now: float
    ) -> Outgoing:
        items, first, last = self.plan(kind), message.start_index, message.end_index
        if not 0 <= first <= last < len(items):
            return ack(sender, kind, MissionResult.INVALID_SEQUENCE)
        upload = PlanUpload(sender, kind, self._rules[kind], items=items, first=first, end=last + 1, now=now)
        self._uploads[kind] = upload
        return upload.request_item(now)

    def _handle_item(self, message: _Item, received: Received, now: float) -> list[Outgoing]:
        sender, kind = sender_of(received), self._shelf.kind(message.mission_type)
        if kind is None:
            return []
        upload = self._uploads.get(kind)
        if upload is None or upload.sender != sender:
            return self._said_again(self._ended.get(kind), message, sender, now)
        answer = upload.handle_item(message, now)
        if isinstance(answer, list):
            return answer
        if answer is not MissionResult.ACCEPTED:
            self._planner.handle_plan_rejected(kind, upload.invalid_item, answer, now)
        return self._end(upload, answer, received, now)

    def _end(self, upload: PlanUpload, verdict: MissionResult, received: Received, now: float) -> list[Outgoing]:
        """The last item has come, or one that is wrong."""
        kind, message = upload.kind, received.message
        self._uploads.pop(kind, None)
        self._ended.pop(kind, None)
        last = getattr(message, "seq", -1)

        def told(verdict: MissionResult, now: float) -> list[Outgoing]:
            answer = ack(upload.sender, kind, verdict, self.plan_id(kind) if verdict is MissionResult.ACCEPTED else 0)
            self._ended[kind] = _EndedUpload(upload.sender, last, now, answer)
            return [answer]

        if verdict is not MissionResult.ACCEPTED:
            return told(verdict, now)
        # Since it began, the vehicle may have set off by the old plan.
        change = PlanChange(
            {kind: upload.items},
            lambda now: self._planner.authorize_write(received, kind, now),
            told,
            upload.sender,
            message,
        )
        return self._changes.begin(change, now)

    def _handle_ack(self, message: m.MissionAck, sender: Sender, now: float) -> list[Outgoing]:
        """Whoever uploads has thought better of it, or wants to be asked in another way."""
        kind = self._shelf.kind(message.mission_type)
        upload = None if kind is None else self._uploads.get(kind)
        if kind is None or upload is None or upload.sender != sender:
            return []
        if message.type == MissionResult.UNSUPPORTED and upload.float_requested:
            return upload.use_int_only(now)
        del self._uploads[kind]
        return []

    @staticmethod
    def _said_again(ended: _EndedUpload | None, message: _Item, sender: Sender, now: float) -> list[Outgoing]:
        if ended is None or ended.sender != sender or message.seq != ended.last or now - ended.at > REPEAT_WINDOW:
            return []
        return [ended.ack]

    def _clear(
        self, message: m.MissionClearAll, kinds: Sequence[MissionType], received: Received, now: float
    ) -> list[Outgoing]:
        for kind in kinds:
            self._uploads.pop(kind, None)
            self._ended.pop(kind, None)
        sender = sender_of(received)
        change = PlanChange(
            dict.fromkeys(kinds, ()),
            lambda now: _first_refusal(self._planner.authorize_write(received, kind, now) for kind in kinds),
            lambda verdict, now: [ack(sender, message.mission_type, verdict)],
            sender,
            message,
        )
        return self._changes.begin(change, now)


def _first_refusal(verdicts: Iterable[MissionResult]) -> MissionResult:
    """ACCEPTED where there is none."""
    return next((verdict for verdict in verdicts if verdict is not MissionResult.ACCEPTED), MissionResult.ACCEPTED)
