"""Server half of the mission protocol: upload, download and clear of mission, fence and rally plans.

Rules (https://mavlink.io/en/services/mission.html): the items of an upload are requested one by one, and the plan
counts only when it is complete and valid; until then the old plan stays. One upload of a plan at a time: a second
sender is DENIED. The sender may end an upload with a MISSION_ACK that holds an error. The backend (the vehicle)
interprets and saves plans; the final MISSION_ACK waits for that (commit.py). Downloads: download.py; ids: plans.py.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Protocol

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.core import OtherPeers, Outgoing, Received
from link.services.mission.commit import PlanBackend, PlanChange, PlanChanges
from link.services.mission.download import PlanDownloads
from link.services.mission.items import ItemRequest, Items, MissionItem, PlanRules, from_message, item_request
from link.services.mission.plans import PlanSet
from link.services.mission.upload import EndedUpload, MissionPeer, PlanUpload, ack, sender_of
from link.services.pacing import BulkPacer

_Begin = m.MissionCount | m.MissionWritePartialList | m.MissionClearAll
_Item = m.MissionItem | m.MissionItemInt


class MissionBackend(PlanBackend, Protocol):
    """What the vehicle provides."""

    def authorize_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        """Return ACCEPTED, or why this sender may not change this plan now."""

    def handle_plan_rejected(
        self,
        kind: MissionType,
        wrong: tuple[int, MissionItem] | None,
        verdict: MissionResult,
        received: Received | None,
        now: float,
    ) -> None:
        """Report a rejected plan, with its invalid item and the item's number, if there is one.

        MISSION_ACK does not name the item. `received` is the last message of the upload; None for a file.
        """

    def set_current_item(self, sequence: int, received: Received, now: float) -> None:
        """Continue with this item of the mission, or report why not."""

    def handle_item_request(
        self, request: ItemRequest, item: MissionItem, received: Received, now: float
    ) -> MissionResult:
        """Handle an item that is not part of a plan; return the result for its MISSION_ACK."""

    def build_mission_current(self) -> m.MissionCurrent:
        """Return MISSION_CURRENT."""


class MissionServer:
    """Holds the plans of one system and component. `rules` has a row for each supported plan type.

    `other_peers` returns where else the sender of a message is: over several links it is one client.
    """

    def __init__(
        self,
        backend: MissionBackend,
        rules: Mapping[MissionType, PlanRules],
        *,
        system: int,
        component: int,
        pacer: BulkPacer | None = None,
        other_peers: OtherPeers = lambda received, now: (),
    ) -> None:
        self._backend, self._other_peers = backend, other_peers
        self._rules = rules
        self._ids = (system, component)
        self._plans = PlanSet(rules)
        self._changes = PlanChanges(self._plans, backend)
        self._downloads = PlanDownloads(
            self._plans, pacer or BulkPacer(), lambda: int(backend.build_mission_current().seq)
        )
        self._uploads: dict[MissionType, PlanUpload] = {}
        self._ended: dict[MissionType, EndedUpload] = {}
        self._now = 0.0
        """Time of the last tick."""

    def plan(self, kind: MissionType) -> Items:
        """Return the plan in force."""
        return self._plans[kind]

    def plan_id(self, kind: MissionType) -> int:
        """Return its id: different for another plan, 0 for an empty one."""
        return self._plans.get_id(kind)

    @property
    def has_pending_changes(self) -> bool:
        """Whether a plan is being written."""
        return any(map(self._changes.pending, self._rules))

    def load(self, kind: MissionType, items: Sequence[MissionItem]) -> MissionResult:
        """Put a saved plan in force if it is valid; the backend is not notified."""
        verdict = self._rules[kind].validate(items)
        if verdict is MissionResult.ACCEPTED:
            self._plans.set(kind, items)
        return verdict

    def replace(
        self, plans: Mapping[MissionType, Sequence[MissionItem]], allowed: Callable[[MissionType], bool]
    ) -> PlanChange | None:
        """Change plans other than by upload, e.g. as files, and return the change.

        Returns None for an invalid plan, which the backend is notified of, or while one of the plans is being changed.
        """
        for kind, items in plans.items():
            verdict = self._rules[kind].validate(items)
            if verdict is not MissionResult.ACCEPTED:
                wrong = self._rules[kind].first_invalid(items)
                self._backend.handle_plan_rejected(kind, wrong, verdict, None, self._now)
                return None
        if any(self._uploads.get(kind) or self._changes.pending(kind) for kind in plans):
            return None
        change = PlanChange(
            {kind: tuple(items) for kind, items in plans.items()},
            lambda: MissionResult.ACCEPTED if all(map(allowed, plans)) else MissionResult.DENIED,
        )
        self._changes.begin(change, self._now)  # has no reply
        return change

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing if it is not for us or its sender may not ask."""
        if not received.may_ask or not self._is_target(received.message):
            return []
        answer = self._downloads.receive(received)
        if answer is not None:
            return answer
        return self._handle_write(received, now) if received.introduced else []

    def tick(self, now: float) -> list[Outgoing]:
        """Request missing items again; cancel uploads that have stopped."""
        self._now = now
        outgoing = self._downloads.tick(now) + self._changes.tick(now)
        for kind, upload in list(self._uploads.items()):
            if upload.is_overdue(now):
                del self._uploads[kind]
                outgoing.append(ack(upload.sender, kind, MissionResult.CANCELLED))
            else:
                outgoing += upload.repeat_request(now)
        return outgoing

    def _is_target(self, message: m.Message) -> bool:
        """Return whether a message is for us. A request may go to all systems, as DroneKit's simple_goto does."""
        system, component = getattr(message, "target_system", None), getattr(message, "target_component", None)
        to_all = system == 0 and isinstance(message, _Item) and item_request(message)
        return bool(system == self._ids[0] or to_all) and component in (0, self._ids[1])

    def _handle_write(self, received: Received, now: float) -> list[Outgoing]:
        self._follow(received, now)
        match received.message:
            case m.MissionCount() | m.MissionWritePartialList() | m.MissionClearAll() as message:
                return self._begin(message, received, now)
            case m.MissionItem() | m.MissionItemInt() as message:
                return self._handle_item(message, received, now)
            case m.MissionAck() as message if message.type != MissionResult.ACCEPTED:
                return self._handle_ack(message, sender_of(received), now)
            case m.MissionSetCurrent() as message:
                self._backend.set_current_item(message.seq, received, now)
                return [Outgoing(self._backend.build_mission_current())]
        return []

    def _follow(self, received: Received, now: float) -> None:
        """Go on with an upload over the link on which its sender is now."""
        sender = sender_of(received)
        for peer in self._other_peers(received, now):
            before = sender._replace(peer=peer)
            for kind in self._rules:
                upload, change, ended = self._uploads.get(kind), self._changes.pending(kind), self._ended.get(kind)
                if upload is not None and upload.sender == before:
                    upload.move(sender)
                if change is not None and change.sender == before:
                    change.sender = sender
                if ended is not None and ended.sender == before:
                    self._ended[kind] = ended.move(sender)

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

    def _is_saving(self, kind: MissionType, message: _Begin, sender: MissionPeer) -> bool:
        """Return whether the sender's last change is still being written; it will repeat this request.

        A reply to that change would look like one to this request, so there is none any more, unless this one repeats
        it.
        """
        change = self._changes.pending(kind)
        if change is None or change.sender != sender:
            return False
        if not change.is_repeat(message):
            change.build_reply = lambda verdict, now: []
        return True

    def _may_begin(self, kind: MissionType, received: Received, now: float) -> MissionResult:
        """Return ACCEPTED if an upload may start. The same sender may start again at any time."""
        busy = self._changes.pending(kind) or self._uploads.get(kind)
        if busy and busy.sender != sender_of(received):
            return MissionResult.DENIED
        return self._backend.authorize_write(received, kind, now)

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
        self, message: m.MissionWritePartialList, sender: MissionPeer, kind: MissionType, now: float
    ) -> Outgoing:
        items, first, last = self.plan(kind), message.start_index, message.end_index
        if not 0 <= first <= last < len(items):
            return ack(sender, kind, MissionResult.INVALID_SEQUENCE)
        upload = PlanUpload(sender, kind, self._rules[kind], items=items, first=first, end=last + 1, now=now)
        self._uploads[kind] = upload
        return upload.request_item(now)

    def _handle_item(self, message: _Item, received: Received, now: float) -> list[Outgoing]:
        sender, kind = sender_of(received), self._plans.kind(message.mission_type)
        if kind is None:
            return []
        if request := item_request(message):
            verdict = self._backend.handle_item_request(request, from_message(message), received, now)
            return [ack(sender, kind, verdict)]
        upload = self._uploads.get(kind)
        if upload is None or upload.sender != sender:
            ended = self._ended.get(kind)
            return ended.repeat_ack(message.seq, sender, now) if ended else []
        answer = upload.handle_item(message, now)
        if isinstance(answer, list):
            return answer
        if answer is not MissionResult.ACCEPTED:
            self._backend.handle_plan_rejected(kind, upload.invalid_item, answer, received, now)
        return self._end(upload, answer, received, now)

    def _end(self, upload: PlanUpload, verdict: MissionResult, received: Received, now: float) -> list[Outgoing]:
        """End an upload: its last item has come, or an invalid one."""
        kind, message = upload.kind, received.message
        self._uploads.pop(kind, None)
        self._ended.pop(kind, None)
        last = getattr(message, "seq", -1)

        def reply(verdict: MissionResult, now: float, sender: MissionPeer = upload.sender) -> list[Outgoing]:
            answer = ack(sender, kind, verdict, self.plan_id(kind) if verdict is MissionResult.ACCEPTED else 0)
            self._ended[kind] = EndedUpload(sender, last, now, answer)
            return [answer]

        if verdict is not MissionResult.ACCEPTED:
            return reply(verdict, now)
        # The vehicle may have started to use the old plan since the upload began.
        change = PlanChange(
            {kind: upload.items},
            lambda: self._backend.authorize_write(received, kind, now),
            sender=upload.sender,
            cause=message,
        )
        change.build_reply = lambda verdict, now: reply(verdict, now, change.sender or upload.sender)
        return self._changes.begin(change, now)

    def _handle_ack(self, message: m.MissionAck, sender: MissionPeer, now: float) -> list[Outgoing]:
        """Handle an error from the uploader: it cancels, or wants requests of the other kind."""
        kind = self._plans.kind(message.mission_type)
        upload = None if kind is None else self._uploads.get(kind)
        if kind is None or upload is None or upload.sender != sender:
            return []
        if message.type == MissionResult.UNSUPPORTED and upload.float_requested:
            return upload.use_int_only(now)
        del self._uploads[kind]
        return []

    def _clear(
        self, message: m.MissionClearAll, kinds: Sequence[MissionType], received: Received, now: float
    ) -> list[Outgoing]:
        for kind in kinds:
            self._uploads.pop(kind, None)
            self._ended.pop(kind, None)
        sender = sender_of(received)
        change = PlanChange(
            dict.fromkeys(kinds, ()),
            lambda: _first_refusal(self._backend.authorize_write(received, kind, now) for kind in kinds),
            sender=sender,
            cause=message,
        )
        change.build_reply = lambda verdict, now: [ack(change.sender or sender, message.mission_type, verdict)]
        return self._changes.begin(change, now)


def _first_refusal(verdicts: Iterable[MissionResult]) -> MissionResult:
    """Return the first verdict that is not ACCEPTED, or ACCEPTED."""
    return next((verdict for verdict in verdicts if verdict is not MissionResult.ACCEPTED), MissionResult.ACCEPTED)
