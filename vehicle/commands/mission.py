"""The mission service: who may change mission, fence and rally plans and when, saving them, and MISSION_START.

The protocol itself is link/services/mission/server.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result, Severity
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command.request import CommandRequest, value_or_default
from link.services.command.server import CommandReply
from link.services.ftp.files import Folder
from link.services.mission.commit import PendingPlanWrite, PlanChange
from link.services.mission.files import PlanFolder
from link.services.mission.items import ItemRequest, Items, MissionItem, describe_rejection
from link.services.mission.server import MissionServer
from link.signing.role import SigningRole
from vehicle.autonomy.mission.item_reached import ItemReachedSender
from vehicle.autonomy.mission.rules import DoItem, find_unsupported_items, plan_rules
from vehicle.autonomy.navigator import PlanIds
from vehicle.commands.access import Access, CommandResult
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable, from_server
from vehicle.drive.roles import role_denial
from vehicle.navigation.fence import find_ineffective_items
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry.build_navigation import mission_state

REMIND_PERIOD = 30.0
"""s between two texts that a saved plan is lost, as ArduPilot repeats PreArm texts."""
CURRENT_ITEM = -1
"""Sequence of DO_SET_MISSION_CURRENT that keeps the current item."""

HandleItemRequest = Callable[[ItemRequest, MissionItem, Received, float], MissionResult]


class MissionService:
    """Owns the mission server and is its `link.services.mission.server.MissionBackend`."""

    def __init__(
        self,
        context: Context,
        do_items: Mapping[int, DoItem],
        handle_item_request: HandleItemRequest,
        store: PlanStore | None = None,
    ) -> None:
        """Without a `store`, plans end with the program. `handle_item_request` takes items that are in no plan."""
        self.handle_item_request = handle_item_request
        self._safety = context.safety
        self._control = context.control
        self._access = context.access
        self._navigator = context.navigator
        self._texts = context.statustext
        self._do_items = do_items
        self._store = store or PlanStore()
        self._damage: dict[MissionType, str] = {}
        self._remind_due = -math.inf
        self._notices: list[str] = []
        self._changes: list[str] = []
        self._sizes = dict.fromkeys(MissionType, 0)
        self._rules = plan_rules(do_items)
        self._reached = ItemReachedSender()
        system, component = context.ids
        self._server = MissionServer(
            self,
            self._rules,
            system=system,
            component=component,
            pacer=context.pacer,
            other_peers=context.control.ownership.other_peers,
        )
        context.navigator.mission.set_do_items(do_items)
        self._restore()

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.MISSION_START, self._start, Access.DRIVER_OR_UNCLAIMED, "1: first item"),
            CommandSpec(Command.DO_SET_MISSION_CURRENT, self._set_current, Access.DRIVER_OR_UNCLAIMED,
                        "1: item, -1 the current one; 2: 1 resets the jump counters"),
        )  # fmt: skip

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        reads = (
            (m.MissionRequestList, "MISSION_COUNT"),
            (m.MissionRequestInt, "MISSION_ITEM_INT"),
            (m.MissionRequest, "MISSION_ITEM"),
            (m.MissionRequestPartialList, "the items of a part"),
        )
        writes = (
            (m.MissionCount, "starts an upload: MISSION_REQUEST_INT"),
            (m.MissionWritePartialList, "starts an upload of a part"),
            (m.MissionClearAll, "clears one plan or all"),
            (m.MissionSetCurrent, "chooses the next item: MISSION_CURRENT"),
        )
        items = (m.MissionItemInt, m.MissionItem)
        item = "item of an upload; current 2: drives there in GUIDED"
        serve = from_server(self._server.receive)
        change = self._access.await_proof(serve)
        return (
            *(InboundMessage(message, Access.CONNECTED, text, serve) for message, text in reads),
            *(InboundMessage(message, Access.DRIVER_OR_UNCLAIMED, text, change) for message, text in writes),
            *(InboundMessage(message, Access.DRIVER_OR_UNCLAIMED, item, change, Effect.MOTION) for message in items),
            InboundMessage(m.MissionAck, Access.INTRODUCED, "ends an upload of its sender", serve),
        )

    def folder(self) -> Folder:
        """Return the plans as files; the file server checks who may write."""
        return PlanFolder(self._server, self._in_use, self._notify_rejected_file)

    @property
    def is_volatile(self) -> bool:
        """Plans end with the program."""
        return self._store.is_volatile

    @property
    def problem(self) -> str | None:
        """Why plans are not saved, one line, or None."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """No write is pending."""
        return self._store.idle and not self._server.has_pending_changes

    def save(self) -> None:
        """Queue all plans for saving again: each was queued already when it changed."""
        for kind in self._rules:
            self._rewrite(kind)

    def clear(self) -> PlanChange | None:
        """Erase all three plans; None while an upload is under way."""
        return self._server.replace(dict.fromkeys(self._rules, ()), lambda kind: not self._safety.armed)

    def tick(self, now: float) -> list[Outgoing]:
        """Return what uploads and downloads need, and MISSION_ITEM_REACHED."""
        self._remind(now)
        self._send_notices(now)
        reached = self._navigator.mission.pop_reached_items()
        return self._server.tick(now) + self._reached.tick(reached, now)

    # MissionBackend

    def authorize_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        """Accept a change from the driver only, and of no plan that is in use."""
        denial = role_denial(received, SigningRole.SET_UP) or self._control.ownership.denial_reason(received, now)
        denial = denial or self._in_use(kind)
        if denial is None:
            return MissionResult.ACCEPTED
        text = f"GCS {received.system}: {kind.name.lower()} not changed: {denial}"
        self._texts.reply(received, Severity.WARNING, text, now)
        return MissionResult.DENIED

    def handle_plan_rejected(
        self,
        kind: MissionType,
        wrong: tuple[int, MissionItem] | None,
        verdict: MissionResult,
        received: Received | None,
        now: float,
    ) -> None:
        """Report the rejected item as STATUSTEXT: ground stations show only the MAV_MISSION_RESULT."""
        text = f"{kind.name.capitalize()} refused: {describe_rejection(wrong, verdict)}"
        if received is None:
            self._texts.send(Severity.WARNING, text, now)
        else:
            self._texts.reply(received, Severity.WARNING, text, now)

    def write_plan(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Queue a plan for writing. Return a handle that reports completion."""
        return self._store.save(kind, items)

    def handle_plan_changed(self, kind: MissionType, items: Items) -> None:
        """Put a plan in force, and report it to all: it may be another ground station's."""
        self._damage.pop(kind, None)
        if items or self._sizes[kind]:
            self._changes.append(
                f"{kind.name.capitalize()} " + (f"changed, items: {len(items)}" if items else "cleared")
            )
        self._apply(kind, items)
        if kind is MissionType.MISSION:
            self._notices += find_unsupported_items(items, self._do_items)
        elif kind is MissionType.FENCE:
            self._notices += find_ineffective_items(items)

    def handle_change_failed(self, kind: MissionType, items: Items, why: str | None) -> None:
        """Write the plan in force again: the disk may hold the new one, or not."""
        self._rewrite(kind)
        if why:
            self._notices.append(f"{kind.name.capitalize()} not changed, it could not be saved: {why}")

    def set_current_item(self, sequence: int, received: Received, now: float) -> None:
        """Handle MISSION_SET_CURRENT."""
        denial = self._control.ownership.denial_reason(received, now)
        if denial is None and not self._selected(sequence, anew=False):
            denial = f"there is no item {sequence}"
        if denial:
            text = f"GCS {received.system}: item {sequence} not set: {denial}"
            self._texts.reply(received, Severity.WARNING, text, now)

    def build_mission_current(self) -> m.MissionCurrent:
        """Build MISSION_CURRENT."""
        return mission_state(self._navigator, self._safety.mode)

    # Saved plans

    def _restore(self) -> None:
        store = self._store
        for kind in self._rules:
            damage = store.damage.get(kind)
            if damage is None and self._server.load(kind, store.plans.get(kind, ())) is not MissionResult.ACCEPTED:
                damage = f"saved {kind.name.lower()} does not fit this version"
            if damage is not None:
                self._damage[kind] = damage
            self._apply(kind, self._server.plan(kind))

    def _rewrite(self, kind: MissionType) -> None:
        """Save the plan in force; a damaged file is left as it is."""
        if kind not in self._damage:
            self._store.save(kind, self._server.plan(kind))

    def _apply(self, kind: MissionType, items: Items) -> None:
        navigator = self._navigator
        self._sizes[kind] = len(items)
        navigator.set_plan_ids(PlanIds(**{each.name.lower(): self._server.plan_id(each) for each in self._rules}))
        if kind is MissionType.MISSION:
            self._reached.reset()
            navigator.mission.load(items, self._damage.get(kind))
        elif kind is MissionType.FENCE:
            navigator.fence_avoidance.fence.load(items, self._damage.get(kind))
        else:
            navigator.return_points.load(items)

    def _remind(self, now: float) -> None:
        """Repeat that saved plans are lost: no ground station may have been connected at the start."""
        if now < self._remind_due:
            return
        self._remind_due = now + REMIND_PERIOD
        if not self._safety.armed:
            for damage in self._damage.values():
                self._texts.send(Severity.WARNING, f"{damage[0].upper()}{damage[1:]}: upload it again", now)
        if self._store.problem:
            text = f"Plans are not saved: {self._store.problem}"
            self._texts.send_once(f"plans {self._store.problem}", Severity.WARNING, text, now)

    def _send_notices(self, now: float) -> None:
        for text in self._changes:
            self._texts.send_change(Severity.NOTICE, text, now)
        self._changes.clear()
        for text in self._notices:
            self._texts.send(Severity.WARNING, text, now)
        self._notices.clear()

    def _notify_rejected_file(self, kind: MissionType, why: str) -> None:
        self._notices.append(f"{kind.name.capitalize()} file rejected: {why}")

    def _in_use(self, kind: MissionType) -> str | None:
        if not self._safety.armed:
            return None
        if kind is MissionType.MISSION and self._safety.mode is Mode.AUTO:
            return "AUTO drives by it"
        return "disarm first" if kind is MissionType.FENCE and self._navigator.fence_avoidance.fence.enabled else None

    def _selected(self, index: float, *, anew: bool) -> bool:
        mission = self._navigator.mission
        if not (math.isfinite(index) and index == int(index) and 0 <= index < len(mission.items)):
            return False
        self._reached.reset()
        mission.set_current(int(index), anew=anew)
        return True

    # Commands

    def _start(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: the first item; 2, the last item, must be 0, -1 or the end of the mission."""
        first = request.params[0]
        mission = self._navigator.mission
        if not mission.items:
            return self._access.reject(request, mission.missing_reason, now)
        if not self._safety.armed:
            return self._access.reject(request, "not armed", now)
        last = value_or_default(request.params[1])
        if not (0 <= first < len(mission.items) and first == int(first)) or last not in (-1, 0, len(mission.items) - 1):
            return Result.DENIED
        if first:
            self._reached.reset()
            mission.set_current(int(first))
        denial = self._safety.choose_mode(Mode.AUTO, now)
        return self._access.reject(request, denial, now) if denial else Result.ACCEPTED

    def _set_current(self, request: CommandRequest, now: float) -> CommandResult:
        """Parameter 1: item, -1 keeps the current one; 2: 1 resets the jump counters. Sends MISSION_CURRENT to all."""
        index, anew = request.params[0], value_or_default(request.params[1])
        index = self._navigator.mission.current if index == CURRENT_ITEM else index
        if anew not in (0, 1) or not self._selected(index, anew=bool(anew)):
            return Result.DENIED
        return CommandReply(Result.ACCEPTED, (Outgoing(self.build_mission_current()),))
