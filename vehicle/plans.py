"""The vehicle's plans: who may change them and when, where they go, and the commands that start and steer a mission."""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType, Result, Severity
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command import CommandRequest, Handler, Run
from link.services.ftp_files import Folder
from link.services.mission import MissionServer
from link.services.mission_files import PlanFolder
from link.services.mission_items import Items
from link.services.pacing import Pacer
from vehicle.asking import Asking
from vehicle.control import Control
from vehicle.navigator import Navigator, PlanIds
from vehicle.params import Params
from vehicle.plan import RULES
from vehicle.safety import Safety
from vehicle.texts import Texts

SERVOS = 16
THIS_ITEM = -1
"""Sequence of DO_SET_MISSION_CURRENT that leaves the item as it is."""


class Plans:
    """Fits `link.services.mission.Planner`, and drives the server that asks it."""

    def __init__(
        self,
        params: Params,
        safety: Safety,
        control: Control,
        navigator: Navigator,
        texts: Texts,
        servos: tuple[int, ...],
        pacer: Pacer,
    ) -> None:
        """`servos` are the outputs that motors are at; `pacer` says how fast plans are told."""
        self._params = params
        self._safety = safety
        self._control = control
        self._asking = Asking(control, texts)
        self._navigator = navigator
        self._texts = texts
        self._servos = servos
        self._outbox: list[Outgoing] = []
        self._server = MissionServer(self, RULES, system=control.system, component=1, pacer=pacer)

    def handlers(self) -> dict[int, Handler]:
        """The table for link.services.command.CommandServer."""
        mine: dict[int, Run] = {
            Command.MISSION_START: self._start,
            Command.DO_SET_MISSION_CURRENT: self._set_current,
            Command.DO_FENCE_ENABLE: self._enable_fence,
            Command.DO_SET_SERVO: self._accessory,
            Command.DO_SET_RELAY: self._accessory,
        }
        return {command: self._asking.of_owner(run) for command, run in mine.items()}

    def folder(self) -> Folder:
        """The plans as files; who may write files at all is for the file server to say."""
        return PlanFolder(self._server, lambda kind: self._in_use(kind) is None)

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer a message of the mission protocol."""
        return self._server.receive(received, now)

    def tick(self, now: float) -> list[Outgoing]:
        """What uploads need, and what the mission has reached."""
        mission, outgoing = self._navigator.mission, self._server.tick(now) + self._outbox
        self._outbox.clear()
        if mission.reached:
            outgoing += [Outgoing(m.MissionItemReached(index)) for index in mission.reached]
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

    def changed(self, kind: MissionType, items: Items) -> None:
        """Put it in force."""
        self._navigator.plan_ids = PlanIds(**{each.name.lower(): self._server.plan_id(each) for each in RULES})
        if kind is MissionType.MISSION:
            self._navigator.mission.load(items)
        elif kind is MissionType.FENCE:
            self._navigator.fence.load(items)

    def select(self, sequence: int, received: Received, now: float) -> None:
        """MISSION_SET_CURRENT."""
        refusal = self._control.stranger(received.system)
        if refusal is None and not self._selected(sequence):
            refusal = f"there is no item {sequence}"
        if refusal:
            text = f"GCS {received.system}: item {sequence} not chosen: {refusal}"
            self._texts.say(Severity.WARNING, text, now)

    def current(self) -> m.MissionCurrent:
        """MISSION_CURRENT."""
        return self._navigator.mission_current(self._safety.mode)

    def _in_use(self, kind: MissionType) -> str | None:
        if not self._safety.armed:
            return None
        if kind is MissionType.MISSION and self._safety.mode is Mode.AUTO:
            return "AUTO drives by it"
        return "disarm first" if kind is MissionType.FENCE and self._navigator.fence.enabled else None

    def _selected(self, index: float) -> bool:
        mission = self._navigator.mission
        if not (math.isfinite(index) and index == int(index) and 0 <= index < len(mission.items)):
            return False
        mission.select(int(index))
        return True

    # Commands

    def _start(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: the first item; 2, the last one, is not offered and must be 0 or the end."""
        first = request.params[0]
        mission = self._navigator.mission
        if not mission.items:
            return self._asking.refuse(request, "there is no mission", now)
        if not self._safety.armed:
            return self._asking.refuse(request, "not armed", now)
        last = request.params[1]
        if not (0 <= first < len(mission.items) and first == int(first)) or last not in (-1, 0, len(mission.items) - 1):
            return Result.DENIED
        if first:
            mission.select(int(first))
        refusal = self._safety.choose_mode(Mode.AUTO, now)
        return self._asking.refuse(request, refusal, now) if refusal else Result.ACCEPTED

    def _set_current(self, request: CommandRequest, now: float) -> Result:
        """-1 is the item under way, begun anew. Everybody is told the new item, as the specification wants."""
        index = request.params[0]
        if not self._selected(self._navigator.mission.current if index == THIS_ITEM else index):
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
        if wish == 0 and self._safety.armed and self._navigator.fence.enabled:
            return self._asking.refuse(request, "disarm first", now)
        self._params.set("FENCE_ENABLE", wish)
        return Result.ACCEPTED

    def _accessory(self, request: CommandRequest, now: float) -> Result:
        """DO_SET_SERVO, DO_SET_RELAY: motors are not for them, and there is nothing else at the outputs."""
        number = request.params[0]
        if not math.isfinite(number) or not 0 <= number <= SERVOS:
            return Result.DENIED
        if request.command == Command.DO_SET_SERVO and number in self._servos:
            return Result.DENIED
        return self._asking.refuse(request, f"there is no accessory {number:g}", now)
