"""The vehicle's plans: who may change them and when, where they go, and the commands that start and steer a mission."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result, Severity
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command.server import CommandRequest, Handler, Run, given
from link.services.ftp.files import Folder
from link.services.mission.commit import Change, Keeping
from link.services.mission.files import PlanFolder
from link.services.mission.items import Items, MissionItem, in_words
from link.services.mission.server import MissionServer
from link.services.pacing import Pacer
from vehicle.autonomy.mission.item_reached import Reached
from vehicle.autonomy.mission.rules import rules
from vehicle.autonomy.navigator import Navigator, PlanIds
from vehicle.commands import accessory_items
from vehicle.commands.access import Asking
from vehicle.commands.accessories import AccessoryOrders
from vehicle.drive.control import Control
from vehicle.navigation.fence import without_effect
from vehicle.safety.state_machine import Safety
from vehicle.statustext import Texts
from vehicle.storage.plan_keeping import NoPlanKeeper, PlanKeeper
from vehicle.telemetry.build_navigation import mission_state

REMIND = 30.0
"""s between two texts that a kept plan is lost, as ArduPilot repeats what forbids to arm."""
THIS_ITEM = -1
"""Sequence of DO_SET_MISSION_CURRENT that leaves the item as it is."""


class Plans:
    """Fits `link.services.mission.server.Planner`, and drives the server that asks it."""

    def __init__(
        self,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        texts: Texts,
        servos: tuple[int, ...],
        accessories: AccessoryOrders,
        *,
        pacer: Pacer,
        keeper: PlanKeeper | None = None,
    ) -> None:
        """`servos` are the outputs that motors are at; `accessories` do what a mission says of them; `pacer` says how
        fast plans are told.

        Without a `keeper` they end with the program.
        """
        self._safety = safety
        self._control = control
        self._asking = Asking(control, texts)
        self._navigator = navigator
        self._texts = texts
        self._accessories = accessories
        self._keeper = keeper or NoPlanKeeper()
        self._damage: dict[MissionType, str] = {}
        self._remind_due = -math.inf
        self._outbox: list[Outgoing] = []
        self._news: list[str] = []
        self._rules = rules(servos)
        self._reached = Reached()
        self._server = MissionServer(self, self._rules, system=control.system, component=1, pacer=pacer)
        self._restore()

    def handlers(self) -> dict[int, Handler]:
        """The table for link.services.command.server.CommandServer."""
        mine: dict[int, Run] = {
            Command.MISSION_START: self._start,
            Command.DO_SET_MISSION_CURRENT: self._set_current,
            Command.DO_FENCE_ENABLE: self._enable_fence,
        }
        return {command: self._asking.of_owner(run) for command, run in mine.items()}

    def folder(self) -> Folder:
        """The plans as files; who may write files at all is for the file server to say."""
        return PlanFolder(self._server, self._in_use, self._tell_refused)

    @property
    def forgets(self) -> bool:
        """Plans end with the program."""
        return isinstance(self._keeper, NoPlanKeeper)

    @property
    def problem(self) -> str | None:
        """Why they are not kept, one line."""
        return self._keeper.problem

    @property
    def idle(self) -> bool:
        """Nothing is being written."""
        return self._keeper.idle and not self._server.changing

    def save(self) -> None:
        """Once more: what is in force was written already, where the disk took it."""
        for kind in self._rules:
            self._rewrite(kind)

    def erase(self) -> Change | None:
        """All three shall be empty; None while somebody is changing one."""
        return self._server.replace(dict.fromkeys(self._rules, ()), lambda kind: not self._safety.armed)

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer a message of the mission protocol."""
        return self._server.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """What uploads need, and what the mission has reached."""
        self._remind(now)
        mission = self._navigator.mission
        self._news += accessory_items.run(self._accessories, mission.for_accessories, now)
        mission.for_accessories.clear()
        self._tell_news(now)
        outgoing = self._server.tick(now) + self._outbox
        self._outbox.clear()
        outgoing += self._reached.tick(mission.reached, now)
        mission.reached.clear()
        return outgoing

    # What the server asks

    def may_write(self, received: Received, kind: MissionType, now: float) -> MissionResult:
        """Only the driver, and nothing that the rover drives by at the moment."""
        refusal = self._control.stranger(received.system) or self._in_use(kind)
        if refusal is None:
            return MissionResult.ACCEPTED
        text = f"GCS {received.system}: {kind.name.lower()} not changed: {refusal}"
        self._texts.say(Severity.WARNING, text, now)
        return MissionResult.DENIED

    def unfit(
        self, kind: MissionType, wrong: tuple[int, MissionItem] | None, verdict: MissionResult, now: float
    ) -> None:
        """Say which item it is: a ground station shows no more than the verdict."""
        self._texts.say(Severity.WARNING, f"{kind.name.capitalize()} refused: {in_words(wrong, verdict)}", now)

    def keep(self, kind: MissionType, items: Items) -> Keeping:
        """Have it written."""
        return self._keeper.keep(kind, items)

    def changed(self, kind: MissionType, items: Items) -> None:
        """Put it in force."""
        self._damage.pop(kind, None)
        self._use(kind, items)
        if kind is MissionType.MISSION:
            self._news += accessory_items.impossible(self._accessories, items)
        elif kind is MissionType.FENCE:
            self._news += without_effect(items)

    def stays(self, kind: MissionType, items: Items, why: str | None) -> None:
        """The disk may hold the other one, or not."""
        self._rewrite(kind)
        if why:
            self._news.append(f"{kind.name.capitalize()} not changed, it could not be saved: {why}")

    def select(self, sequence: int, received: Received, now: float) -> None:
        """MISSION_SET_CURRENT."""
        refusal = self._control.stranger(received.system)
        if refusal is None and not self._selected(sequence, anew=False):
            refusal = f"there is no item {sequence}"
        if refusal:
            text = f"GCS {received.system}: item {sequence} not chosen: {refusal}"
            self._texts.say(Severity.WARNING, text, now)

    def current(self) -> m.MissionCurrent:
        """MISSION_CURRENT."""
        return mission_state(self._navigator, self._safety.mode)

    # What was kept

    def _restore(self) -> None:
        keeper = self._keeper
        for kind in self._rules:
            damage = keeper.damage.get(kind)
            if damage is None and self._server.load(kind, keeper.plans.get(kind, ())) is not MissionResult.ACCEPTED:
                damage = f"saved {kind.name.lower()} is not one for this version"
            if damage is not None:
                self._damage[kind] = damage
            self._use(kind, self._server.plan(kind))

    def _rewrite(self, kind: MissionType) -> None:
        """What is in force; in the place of a damaged plan nothing is."""
        if kind not in self._damage:
            self._keeper.keep(kind, self._server.plan(kind))

    def _use(self, kind: MissionType, items: Items) -> None:
        navigator = self._navigator
        navigator.plan_ids = PlanIds(**{each.name.lower(): self._server.plan_id(each) for each in self._rules})
        if kind is MissionType.MISSION:
            self._reached.forget()
            navigator.mission.load(items, self._damage.get(kind))
        elif kind is MissionType.FENCE:
            navigator.boundary.fence.load(items, self._damage.get(kind))
        else:
            navigator.havens.load(items)

    def _remind(self, now: float) -> None:
        """Nobody may have listened when the vehicle started."""
        if now < self._remind_due:
            return
        self._remind_due = now + REMIND
        if not self._safety.armed:
            for damage in self._damage.values():
                self._texts.say(Severity.WARNING, f"{damage[0].upper()}{damage[1:]}: upload it again", now)
        if self._keeper.problem:
            text = f"Plans are not saved: {self._keeper.problem}"
            self._texts.say_once(f"plans {self._keeper.problem}", Severity.WARNING, text, now)

    def _tell_news(self, now: float) -> None:
        for text in self._news:
            self._texts.say(Severity.WARNING, text, now)
        self._news.clear()

    def _tell_refused(self, kind: MissionType, why: str) -> None:
        self._news.append(f"File of the {kind.name.lower()} not taken: {why}")

    def _in_use(self, kind: MissionType) -> str | None:
        if not self._safety.armed:
            return None
        if kind is MissionType.MISSION and self._safety.mode is Mode.AUTO:
            return "AUTO drives by it"
        return "disarm first" if kind is MissionType.FENCE and self._navigator.boundary.fence.enabled else None

    def _selected(self, index: float, *, anew: bool) -> bool:
        mission = self._navigator.mission
        if not (math.isfinite(index) and index == int(index) and 0 <= index < len(mission.items)):
            return False
        self._reached.forget()
        mission.select(int(index), anew=anew)
        return True

    # Commands

    def _start(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: the first item; 2, the last one, is not offered and must be 0 or the end."""
        first = request.params[0]
        mission = self._navigator.mission
        if not mission.items:
            return self._asking.refuse(request, mission.missing, now)
        if not self._safety.armed:
            return self._asking.refuse(request, "not armed", now)
        last = given(request.params[1])
        if not (0 <= first < len(mission.items) and first == int(first)) or last not in (-1, 0, len(mission.items) - 1):
            return Result.DENIED
        if first:
            self._reached.forget()
            mission.select(int(first))
        refusal = self._safety.choose_mode(Mode.AUTO, now)
        return self._asking.refuse(request, refusal, now) if refusal else Result.ACCEPTED

    def _set_current(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: -1 is the item under way; 2: 1 forgets the jumps made. Everybody is told the item then."""
        index, anew = request.params[0], given(request.params[1])
        index = self._navigator.mission.current if index == THIS_ITEM else index
        if anew not in (0, 1) or not self._selected(index, anew=bool(anew)):
            return Result.DENIED
        self._outbox.append(Outgoing(self.current()))
        return Result.ACCEPTED

    def _enable_fence(self, request: CommandRequest, now: float) -> Result:
        """0 off, 1 on; 2, "the floor only", means nothing to a rover. Nobody takes it away from under way."""
        wish = request.params[0]
        if wish == 2:
            return Result.UNSUPPORTED
        if wish not in (0, 1):
            return Result.DENIED
        if wish == 1 and self._navigator.boundary.fence.damage:
            return self._asking.refuse(request, self._navigator.boundary.fence.damage, now)
        if wish == 0 and self._safety.armed and self._navigator.boundary.fence.enabled:
            return self._asking.refuse(request, "disarm first", now)
        refusal = self._navigator.boundary.fence.enable(bool(wish))
        return self._asking.refuse(request, refusal, now) if refusal else Result.ACCEPTED
