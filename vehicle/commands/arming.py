"""MAV_CMD -> what the vehicle does, for the commands that change it. Questions are in vehicle/commands/requests.py.

Who may: the ground station in control, or any that has shown its HEARTBEAT where nobody is ("ctl"). The stop set
(disarm, emergency stop, HOLD, termination) is open to everybody, so that nobody has to ask before stopping a vehicle.
To add a command, write a handler and add a line to `handlers`. Every command not in a table is answered UNSUPPORTED.
"""

from __future__ import annotations

import math

from dialects.enums import Command, Result, Severity
from dialects.messages import CommandInt, CommandLong, SetMode
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command.server import CommandHandler, CommandRequest, value_or_default
from vehicle.drive.control import Control
from vehicle.modes import describe_mode, parse_mode, standard_mode
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

FORCE_VALUES = (21196, 2989)
"""COMPONENT_ARM_DISARM parameter 2 that skips soft checks: the specification's value and ArduPilot's second one."""
SAFE, DANGEROUS = 0, 1
"""SAFETY_SWITCH_STATE."""
FORWARD_INTERVAL = 3.0
"""s before the owner is asked again on behalf of the same ground station."""


class ArmingCommands:
    """Translates commands into the verbs of Safety and Control."""

    def __init__(self, safety: Safety, control: Control, texts: StatusTextQueue) -> None:
        self._safety = safety
        self._control = control
        self._texts = texts
        self._outbox: list[Outgoing] = []
        self._asked: tuple[int, float] = (0, -math.inf)

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        return {
            Command.COMPONENT_ARM_DISARM: CommandHandler(self._arm_disarm, broadcast=True),
            Command.RUN_PREARM_CHECKS: CommandHandler(self._prearm_checks),
            Command.DO_SET_MODE: CommandHandler(self._set_mode, broadcast=True),
            Command.DO_SET_STANDARD_MODE: CommandHandler(self._set_standard_mode),
            Command.DO_SET_SAFETY_SWITCH_STATE: CommandHandler(self._safety_switch, broadcast=True),
            Command.DO_FLIGHTTERMINATION: CommandHandler(self._terminate, broadcast=True),
            Command.REQUEST_OPERATOR_CONTROL: CommandHandler(self._operator_control),
        }

    def accepts_broadcast(self, message: CommandLong | CommandInt) -> bool:
        """A command to system 0 may stop a vehicle and nothing else: arming all rovers at once is nobody's wish."""
        first, main = message.param1, message.param2
        stops: dict[int, bool] = {
            Command.COMPONENT_ARM_DISARM: first == 0,
            Command.DO_SET_MODE: parse_mode(first, main, message.param3) is Mode.HOLD,
            Command.DO_SET_SAFETY_SWITCH_STATE: first == SAFE,
        }
        return stops.get(message.command, True)

    def messages_to_send(self) -> list[Outgoing]:
        """What handlers want said besides the acknowledgement; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def handle_set_mode(self, received: Received, message: SetMode, now: float) -> None:
        """SET_MODE, the old message without acknowledgement: a refusal is told by a text."""
        asked = (message.base_mode, message.custom_mode)
        self._choose(parse_mode(*asked), describe_mode(*asked), received.system, received.introduced, now)

    def _arm_disarm(self, request: CommandRequest, now: float) -> Result:
        arm, force = request.params[:2]
        if arm not in (0, 1):
            return Result.DENIED
        if not arm:
            self._safety.disarm(f"by GCS {request.system}", now)
            self._safety.end_motor_test()
            return Result.ACCEPTED
        if not request.introduced:
            return self._refuse("arming", request, "no HEARTBEAT heard", now)
        return Result.FAILED if self._safety.arm(request.system, now, force=force in FORCE_VALUES) else Result.ACCEPTED

    def _prearm_checks(self, request: CommandRequest, now: float) -> Result:
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        problems = self._safety.prearm_problems(now)
        for problem in problems:
            self._texts.send(Severity.WARNING, f"PreArm: {problem}", now)
        if not problems:
            self._texts.send(Severity.INFO, "PreArm: ready to arm", now)
        return Result.ACCEPTED

    def _set_mode(self, request: CommandRequest, now: float) -> Result:
        asked = request.params[:3]
        return self._choose(parse_mode(*asked), describe_mode(*asked), request.system, request.introduced, now)

    def _set_standard_mode(self, request: CommandRequest, now: float) -> Result:
        """SAFE_RECOVERY is RTL and MISSION is AUTO; for one that we have not the specification wants FAILED."""
        standard = request.params[0]
        if not math.isfinite(standard):
            return Result.DENIED
        mode = standard_mode(standard)
        if mode is not None:
            return self._choose(mode, mode.name, request.system, request.introduced, now)
        return self._refuse("standard mode", request, f"{standard:g} is not offered", now, Severity.NOTICE)

    def _choose(self, mode: Mode | None, words: str, system: int, introduced: bool, now: float) -> Result:
        if mode is None:
            self._texts.send(Severity.WARNING, f"Refused: {words} is not offered", now)
            return Result.DENIED
        refusal = None
        if mode is not Mode.HOLD:
            refusal = self._stranger(system, introduced)
        refusal = refusal or self._safety.choose_mode(mode, now)
        if refusal:
            self._texts.send(Severity.WARNING, f"Mode {mode.name} refused: {refusal}", now)
        return Result.FAILED if refusal else Result.ACCEPTED

    def _safety_switch(self, request: CommandRequest, now: float) -> Result:
        position = request.params[0]
        if position == SAFE:
            self._safety.emergency_stop(f"GCS {request.system}", now)
            return Result.ACCEPTED
        if position != DANGEROUS:
            return Result.DENIED
        refusal = self._stranger(request.system, request.introduced) or self._safety.release_estop(now)
        return self._refuse("release", request, refusal, now) if refusal else Result.ACCEPTED

    def _terminate(self, request: CommandRequest, now: float) -> Result:
        if request.params[0] > 0.5:  # false for NaN: an unclear wish does not end a drive for good
            self._safety.emergency_stop(f"GCS {request.system}, restart to go on", now, terminate=True)
            return Result.ACCEPTED
        return self._refuse("termination", request, "parameter 1 is not 1", now)

    def _operator_control(self, request: CommandRequest, now: float) -> Result:
        """REQUEST_OPERATOR_CONTROL: 1 request, 0 release; parameter 2: others may take over without asking."""
        action, takeover, gcs = (
            request.params[0],
            value_or_default(request.params[1]),
            value_or_default(request.params[3]),
        )
        if action not in (0, 1) or takeover not in (0, 1) or gcs not in (0, request.system):
            return Result.DENIED
        if not request.introduced:
            return self._refuse("control", request, "no HEARTBEAT heard", now)
        if action == 0:
            return self._give_up(request, now)
        refusal = self._control.takeover_denial_reason(request.system, now)
        if refusal is None:
            self._control.set_owner(request.system, now)
            self._control.takeover_allowed = bool(takeover)
            return Result.ACCEPTED
        self._ask_owner(request, now)
        return self._refuse("control", request, refusal, now)

    def _give_up(self, request: CommandRequest, now: float) -> Result:
        if self._control.owner not in (0, request.system):
            return Result.FAILED
        if self._control.owner:
            self._control.release("gave it up", now)
            self._safety.choose_mode(Mode.HOLD, now)
        return Result.ACCEPTED

    def _ask_owner(self, request: CommandRequest, now: float) -> None:
        """Forward the request: the owner may release, or allow the takeover (development.xml, 32100)."""
        system, at = self._asked
        if not self._control.owner or (system == request.system and now - at < FORWARD_INTERVAL):
            return
        self._asked = (request.system, now)
        params = (*map(value_or_default, request.params[:3]), float(request.system), 0.0, 0.0, 0.0)
        self._outbox.append(Outgoing(CommandLong(self._control.owner, 0, request.command, 0, *params)))

    def _stranger(self, system: int, introduced: bool) -> str | None:
        """Why `system` may not command, or None where it may."""
        if not introduced:
            return "no HEARTBEAT heard"
        return self._control.denial_reason(system)

    def _refuse(self, what: str, request: CommandRequest, why: str, now: float,
                severity: Severity = Severity.WARNING) -> Result:  # fmt: skip
        self._texts.send(severity, f"GCS {request.system}: {what} refused: {why}", now)
        return Result.FAILED
