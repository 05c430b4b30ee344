"""The vehicle's plans: who may change them and when, where they go, and the commands that start and steer a mission."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result, Severity
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command.server import CommandHandler, CommandRequest, RunCommand, value_or_default
from link.services.ftp.files import Folder
from link.services.mission.commit import PendingPlanWrite, PlanChange
from link.services.mission.files import PlanFolder
from link.services.mission.items import Items, MissionItem, describe_rejection
from link.services.mission.server import MissionServer
from link.services.pacing import BulkPacer
from vehicle.autonomy.mission.item_reached import ItemReachedSender
from vehicle.autonomy.mission.rules import plan_rules
from vehicle.autonomy.navigator import Navigator, PlanIds
from vehicle.commands import accessory_items
from vehicle.commands.access import CommandAccess
from vehicle.commands.accessories import AccessoryCommands
from vehicle.drive.control import Control
from vehicle.navigation.fence import find_ineffective_items
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry.build_navigation import mission_state

REMIND_PERIOD = 30.0
"""s between two texts that a kept plan is lost, as ArduPilot repeats what forbids to arm."""
CURRENT_ITEM = -1
"""Sequence of DO_SET_MISSION_CURRENT that leaves the item as it is."""


class MissionService:
    """Fits `link.services.mission.server.MissionBackend`, and drives the server that asks it."""

    def __init__(
        self,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        texts: StatusTextQueue,
        servos: tuple[int, ...],
        accessories: AccessoryCommands,
        *,
        pacer: BulkPacer,
        store: PlanStore | None = None,
    ) -> None:
        """`servos` are the outputs that motors are at; `accessories` do what a mission says of them; `pacer` says how
        fast plans are told.

        Without a `store` they end with the program.
        """
        self._safety = safety
        self._control = control
        self._asking = CommandAccess(control, texts)
        self._navigator = navigator
        self._texts = texts
        self._accessories = accessories
        self._store = store or PlanStore()
        self._damage: dict[MissionType, str] = {}
        self._remind_due = -math.inf
        self._outbox: list[Outgoing] = []
        self._notices: list[str] = []
        self._rules = plan_rules(servos)
        self._reached = ItemReachedSender()
        self._server = MissionServer(self, self._rules, system=control.system, component=1, pacer=pacer)
        self._restore()

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        mine: dict[int, RunCommand] = {
            Command.MISSION_START: self._start,
            Command.DO_SET_MISSION_CURRENT: self._set_current,
            Command.DO_FENCE_ENABLE: self._enable_fence,
        }
        return {command: self._asking.require_control(run) for command, run in mine.items()}

    def folder(self) -> Folder:
        """The plans as files; who may write files at all is for the file server to say."""
        return PlanFolder(self._server, self._in_use, self._notify_rejected_file)

    @property
    def is_volatile(self) -> bool:
        """Plans end with the program."""
        return self._store.is_volatile

    @property
    def problem(self) -> str | None:
        """Why they are not kept, one line."""
        return self._store.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._store.idle and not self._server.has_pending_changes

    def save(self) -> None:
        """Once more: what is in force was written already, where the disk took it."""
        for kind in self._rules:
            self._rewrite(kind)

    def clear(self) -> PlanChange | None:
        """All three shall be empty; None while somebody is changing one."""
        return self._server.replace(dict.fromkeys(self._rules, ()), lambda kind: not self._safety.armed)

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer a message of the mission protocol."""
        return self._server.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """What uploads need, and what the mission has reached."""
        self._remind(now)
        mission = self._navigator.mission
        self._notices += accessory_items.execute_items(self._accessories, mission.pending_accessory_items, now)
        mission.pending_accessory_items.clear()
        self._send_notices(now)
        outgoing = self._server.tick(now) + self._outbox
        self._outbox.clear()
        outgoing += self._reached.tick(mission.reached_items, now)
        mission.reached_items.clear()
        return outgoing

    # What the server asks

    def authorize_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        """Only the driver, and nothing that the rover drives by at the moment."""
        refusal = self._control.denial_reason(received.system) or self._in_use(kind)
        if refusal is None:
            return MissionResult.ACCEPTED
        text = f"GCS {received.system}: {kind.name.lower()} not changed: {refusal}"
        self._texts.send(Severity.WARNING, text, now)
        return MissionResult.DENIED

    def handle_plan_rejected(
        self, kind: MissionType, wrong: tuple[int, MissionItem] | None, verdict: MissionResult, now: float
    ) -> None:
        """Say which item it is: a ground station shows no more than the verdict."""
        self._texts.send(
            Severity.WARNING, f"{kind.name.capitalize()} refused: {describe_rejection(wrong, verdict)}", now
        )

    def write_plan(self, kind: MissionType, items: Items) -> PendingPlanWrite:
        """Have it written."""
        return self._store.save(kind, items)

    def handle_plan_changed(self, kind: MissionType, items: Items) -> None:
        """Put it in force."""
        self._damage.pop(kind, None)
        self._apply(kind, items)
        if kind is MissionType.MISSION:
            self._notices += accessory_items.find_unsupported_items(self._accessories, items)
        elif kind is MissionType.FENCE:
            self._notices += find_ineffective_items(items)

    def handle_change_failed(self, kind: MissionType, items: Items, why: str | None) -> None:
        """The disk may hold the other one, or not."""
        self._rewrite(kind)
        if why:
            self._notices.append(f"{kind.name.capitalize()} not changed, it could not be saved: {why}")

    def set_current_item(self, sequence: int, received: Received, now: float) -> None:
        """MISSION_SET_CURRENT."""
        refusal = self._control.denial_reason(received.system)
        if refusal is None and not self._selected(sequence, anew=False):
            refusal = f"there is no item {sequence}"
        if refusal:
            text = f"GCS {received.system}: item {sequence} not chosen: {refusal}"
            self._texts.send(Severity.WARNING, text, now)

    def build_mission_current(self) -> m.MissionCurrent:
        """MISSION_CURRENT."""
        return mission_state(self._navigator, self._safety.mode)

    # What was kept

    def _restore(self) -> None:
        store = self._store
        for kind in self._rules:
            damage = store.damage.get(kind)
            if damage is None and self._server.load(kind, store.plans.get(kind, ())) is not MissionResult.ACCEPTED:
                damage = f"saved {kind.name.lower()} is not one for this version"
            if damage is not None:
                self._damage[kind] = damage
            self._apply(kind, self._server.plan(kind))

    def _rewrite(self, kind: MissionType) -> None:
        """What is in force; in the place of a damaged plan nothing is."""
        if kind not in self._damage:
            self._store.save(kind, self._server.plan(kind))

    def _apply(self, kind: MissionType, items: Items) -> None:
        navigator = self._navigator
        navigator.plan_ids = PlanIds(**{each.name.lower(): self._server.plan_id(each) for each in self._rules})
        if kind is MissionType.MISSION:
            self._reached.reset()
            navigator.mission.load(items, self._damage.get(kind))
        elif kind is MissionType.FENCE:
            navigator.fence_avoidance.fence.load(items, self._damage.get(kind))
        else:
            navigator.return_points.load(items)

    def _remind(self, now: float) -> None:
        """Nobody may have listened when the vehicle started."""
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
        for text in self._notices:
            self._texts.send(Severity.WARNING, text, now)
        self._notices.clear()

    def _notify_rejected_file(self, kind: MissionType, why: str) -> None:
        self._notices.append(f"File of the {kind.name.lower()} not taken: {why}")

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
        """Parameter 1: the first item; 2, the last one, is not offered and must be 0 or the end."""
        first = request.params[0]
        mission = self._navigator.mission
        if not mission.items:
            return self._asking.reject(request, mission.missing_reason, now)
        if not self._safety.armed:
            return self._asking.reject(request, "not armed", now)
        last = value_or_default(request.params[1])
        if not (0 <= first < len(mission.items) and first == int(first)) or last not in (-1, 0, len(mission.items) - 1):
            return Result.DENIED
        if first:
            self._reached.reset()
            mission.set_current(int(first))
        refusal = self._safety.choose_mode(Mode.AUTO, now)
        return self._asking.reject(request, refusal, now) if refusal else Result.ACCEPTED

    def _set_current(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: -1 is the item under way; 2: 1 forgets the jumps made. Everybody is told the item then."""
        index, anew = request.params[0], value_or_default(request.params[1])
        index = self._navigator.mission.current if index == CURRENT_ITEM else index
        if anew not in (0, 1) or not self._selected(index, anew=bool(anew)):
            return Result.DENIED
        self._outbox.append(Outgoing(self.build_mission_current()))
        return Result.ACCEPTED

    def _enable_fence(self, request: CommandRequest, now: float) -> Result:
        """0 off, 1 on; 2, "the floor only", means nothing to a rover. Nobody takes it away from under way."""
        wish = request.params[0]
        if wish == 2:
            return Result.UNSUPPORTED
        if wish not in (0, 1):
            return Result.DENIED
        if wish == 1 and self._navigator.fence_avoidance.fence.damage:
            return self._asking.reject(request, self._navigator.fence_avoidance.fence.damage, now)
        if wish == 0 and self._safety.armed and self._navigator.fence_avoidance.fence.enabled:
            return self._asking.reject(request, "disarm first", now)
        refusal = self._navigator.fence_avoidance.fence.set_enabled(bool(wish))
        return self._asking.reject(request, refusal, now) if refusal else Result.ACCEPTED
