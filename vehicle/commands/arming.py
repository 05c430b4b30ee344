"""Arming, modes, emergency stop and operator control: COMPONENT_ARM_DISARM, DO_SET_MODE, REQUEST_OPERATOR_CONTROL, ...

Disarming, the emergency stop, HOLD and flight termination are open to anyone: stopping a vehicle needs no control.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from dialects import messages as m
from dialects.enums import Command, Result, Severity
from dialects.modes import Mode
from link.core import Outgoing, Received
from link.services.command.request import CommandRequest, value_or_default
from link.services.command.server import CommandReply
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable
from vehicle.drive.conversation import Conversation
from vehicle.drive.roles import role_denial
from vehicle.modes import describe_mode, parse_mode, standard_mode
from vehicle.replies import Requester

FORCE_VALUES = (21196, 2989)
"""COMPONENT_ARM_DISARM parameter 2 that skips soft checks: the specification's value and ArduPilot's second one."""
SAFE, DANGEROUS = 0, 1
"""SAFETY_SWITCH_STATE."""
FORWARD_INTERVAL = 3.0
"""s until the request of the same ground station is forwarded to the owner again."""
ANSWER_WITHIN, LEAST_ANSWER, MOST_ANSWER = 10.0, 3.0, 60.0
"""s for which a request for control may be answered, unless its parameter 3 names another time within these limits of
the specification (development.xml, 32100)."""
RELEASE_REPEATED_WITHIN = 10.0
"""s for which a release that is repeated is answered as it was, although another ground station is in control now."""
_STATIONS = range(256)
"""System ids, and 0."""
ASKERS_MAX = 8
"""Ground stations that ask for control at a time; the oldest is forgotten."""


class ArmingCommands:
    """Handles the commands that call Safety and Control."""

    def __init__(self, context: Context) -> None:
        self._safety = context.safety
        self._control = context.control
        self._ownership = context.control.ownership
        self._texts = context.statustext
        self._access = context.access
        self._note = context.arming_note
        self._forwarded: tuple[Conversation | None, float] = (None, -math.inf)
        """Who sent the newest REQUEST_OPERATOR_CONTROL that was forwarded, and when."""
        self._released: tuple[Conversation | None, float] = (None, -math.inf)
        """Who has released control last, and when."""
        self._asking: dict[int, tuple[CommandRequest, float]] = {}
        """System id of a ground station that was refused control -> its request, and until when it is answered; the
        newest last."""

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            # Safety.arm itself checks control: arming may take it over.
            CommandSpec(Command.COMPONENT_ARM_DISARM, self._arm_disarm, Access.INTRODUCED,
                        "1: 1 arm and take control, 0 disarm; 2: 21196 or 2989 skips soft checks",
                        stops=_disarms, broadcast=True),
            CommandSpec(Command.RUN_PREARM_CHECKS, self._run_prearm_checks, Access.ANYONE,
                        "sends what forbids to arm as STATUSTEXT"),
            CommandSpec(Command.DO_SET_MODE, self._set_mode, Access.DRIVER_OR_UNCLAIMED,
                        "1: base mode with bit 0 set; 2: mode, HOLD stops; PX4's pairs in 2 and 3",
                        stops=_holds, broadcast=True),
            CommandSpec(Command.DO_SET_STANDARD_MODE, self._set_standard_mode, Access.DRIVER_OR_UNCLAIMED,
                        "1: MAV_STANDARD_MODE, see modes"),
            CommandSpec(Command.DO_SET_SAFETY_SWITCH_STATE, self._set_safety_switch, Access.DRIVER_OR_UNCLAIMED,
                        "1: 0 emergency stop, 1 release", stops=_is_safe, broadcast=True),
            CommandSpec(Command.DO_FLIGHTTERMINATION, self._terminate, Access.ANYONE,
                        "1: above 0.5 emergency stop until a restart", broadcast=True),
            CommandSpec(Command.REQUEST_OPERATOR_CONTROL, self._request_control, Access.INTRODUCED,
                        "1: 1 request control, 0 give it to who asks (4: to whom); 2: 1 others may take over"),
        )  # fmt: skip

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return (
            InboundMessage(m.SetMode, Access.DRIVER_OR_UNCLAIMED,
                           "as DO_SET_MODE, without COMMAND_ACK; to HOLD: anyone", self._handle_set_mode,
                           Effect.MOTION, checks_sender=True),
        )  # fmt: skip

    def _handle_set_mode(self, received: Received, message: m.SetMode, now: float) -> None:
        """SET_MODE is older than DO_SET_MODE. A denial is reported by a STATUSTEXT only."""
        if message.target_system != self._control.system:
            return
        asked = (message.base_mode, message.custom_mode)
        denial = None if _holds((*asked, 0.0)) else self._access.denial_reason(received, now)
        if denial:
            self._texts.reply(received, Severity.WARNING, f"GCS {received.system}: SET_MODE refused: {denial}", now)
        else:
            self._choose(parse_mode(*asked), describe_mode(*asked), received, now)

    def _arm_disarm(self, request: CommandRequest, now: float) -> Result:
        arm, force = request.params[:2]
        if arm not in (0, 1):
            return Result.DENIED
        if not arm:
            self._safety.disarm(f"by GCS {request.system}", now)
            self._safety.end_motor_test()
            return Result.ACCEPTED
        problems = self._safety.arm(Conversation.of(request), now, force=force in FORCE_VALUES)
        self._report_problems(problems, request, now)
        if not problems and self._note is not None:
            self._texts.send_change(Severity.WARNING, self._note, now)
        return Result.FAILED if problems else Result.ACCEPTED

    def _run_prearm_checks(self, request: CommandRequest, now: float) -> Result:
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        denial = role_denial(request, SigningRole.DRIVE)
        problems = [*([denial] if denial else []), *self._safety.prearm_problems(now)]
        self._report_problems(problems, request, now)
        if not problems:
            self._texts.reply(request, Severity.INFO, "PreArm: ready to arm", now)
        return Result.ACCEPTED

    def _report_problems(self, problems: list[str], request: CommandRequest, now: float) -> None:
        for problem in problems:
            self._texts.reply(request, Severity.WARNING, f"PreArm: {problem}", now)

    def _set_mode(self, request: CommandRequest, now: float) -> Result:
        asked = request.params[:3]
        return self._choose(parse_mode(*asked), describe_mode(*asked), request, now)

    def _set_standard_mode(self, request: CommandRequest, now: float) -> Result:
        """SAFE_RECOVERY is RTL and MISSION is AUTO; the specification wants FAILED for a mode that is not offered."""
        standard = request.params[0]
        if not math.isfinite(standard):
            return Result.DENIED
        mode = standard_mode(standard)
        if mode is not None:
            return self._choose(mode, mode.name, request, now)
        return self._refuse("standard mode", request, f"{standard:g} is not offered", now, Severity.NOTICE)

    def _choose(self, mode: Mode | None, description: str, asker: Requester, now: float) -> Result:
        if mode is None:
            self._texts.reply(asker, Severity.WARNING, f"Refused: {description} is not offered", now)
            return Result.DENIED
        denial = self._safety.choose_mode(mode, now)
        if denial:
            self._texts.reply(asker, Severity.WARNING, f"Mode {mode.name} refused: {denial}", now)
        return Result.FAILED if denial else Result.ACCEPTED

    def _set_safety_switch(self, request: CommandRequest, now: float) -> Result:
        position = request.params[0]
        if position == SAFE:
            self._safety.emergency_stop(f"GCS {request.system}", now)
            return Result.ACCEPTED
        if position != DANGEROUS:
            return Result.DENIED
        denial = self._safety.release_estop(now)
        return self._refuse("release", request, denial, now) if denial else Result.ACCEPTED

    def _terminate(self, request: CommandRequest, now: float) -> Result:
        if request.params[0] > 0.5:  # False for NaN: an unclear command must not end a drive for good
            self._safety.emergency_stop(f"GCS {request.system}, restart to go on", now, terminate=True)
            return Result.ACCEPTED
        return self._refuse("termination", request, "parameter 1 is not 1", now)

    def _request_control(self, request: CommandRequest, now: float) -> Result | CommandReply:
        """Parameter 1: 1 requests control, 0 releases it; 2: 1 lets others take over without asking.

        Parameter 4 of a release names the ground station that gets control, if it asks for it; 0: the newest that does.
        """
        action, takeover, gcs = (
            request.params[0],
            value_or_default(request.params[1]),
            value_or_default(request.params[3]),
        )
        if action not in (0, 1) or takeover not in (0, 1) or gcs not in _STATIONS:
            return Result.DENIED
        if action == 0:
            return self._release_control(request, int(gcs), now)
        if gcs not in (0, request.system):
            return Result.DENIED
        denial = self._ownership.takeover_denial_reason(request, now)
        if denial is None:
            self._control.take(Conversation.of(request), now)
            self._ownership.takeover_allowed = bool(takeover)
            self._asking.pop(request.system, None)
            return Result.ACCEPTED
        self._note_asker(request, now)
        forwarded = self._forward(request, now)
        return CommandReply(self._refuse("control", request, denial, now), forwarded)

    def _release_control(self, request: CommandRequest, station: int, now: float) -> Result:
        """Give control to a ground station that asks for it, in its mode and neutral first; else change to HOLD."""
        if self._ownership.driver is None:
            return Result.ACCEPTED
        if not self._ownership.is_driver(request, now):
            return Result.ACCEPTED if self._has_released(request, now) else Result.FAILED
        self._released = (Conversation.of(request), now)
        asker = self._pop_asker(station if station != request.system else 0, now)
        if asker is not None:
            self._control.take(Conversation.of(asker), now)
            return Result.ACCEPTED
        self._control.release("gave it up", now)
        self._safety.choose_mode(Mode.HOLD, now)
        return Result.ACCEPTED

    def _has_released(self, request: CommandRequest, now: float) -> bool:
        """Return whether a former driver repeats its release, because the acknowledgement was lost."""
        sender, at = self._released
        repeats = sender == Conversation.of(request) and now - at <= RELEASE_REPEATED_WITHIN
        return repeats and not self._ownership.has_driver_ids(request)

    def _note_asker(self, request: CommandRequest, now: float) -> None:
        """Keep who may be given control: one with other ids than the driver, and a key that may drive."""
        if not self._ownership.may_be_given_to(request):
            return
        within = value_or_default(request.params[2])
        within = within if LEAST_ANSWER <= within <= MOST_ANSWER else ANSWER_WITHIN
        self._asking.pop(request.system, None)
        if len(self._asking) >= ASKERS_MAX:
            del self._asking[next(iter(self._asking))]
        self._asking[request.system] = (request, now + within)

    def _pop_asker(self, station: int, now: float) -> CommandRequest | None:
        """Return the request of this ground station, or the newest one (0), that still waits for an answer."""
        waiting = [each for each, until in self._asking.values() if now <= until and station in (0, each.system)]
        self._asking.clear()
        may = [each for each in waiting if self._ownership.may_be_given_to(each)]
        return may[-1] if may else None

    def _forward(self, request: CommandRequest, now: float) -> tuple[Outgoing, ...]:
        """Forward the request to the driver alone, on all its links: it may release control, or allow the takeover.

        (development.xml, 32100)
        """
        asker, at = self._forwarded
        driver = self._ownership.driver
        conversation = Conversation.of(request)
        if driver is None or (asker == conversation and now - at < FORWARD_INTERVAL):
            return ()
        self._forwarded = (conversation, now)
        params = (*map(value_or_default, request.params[:3]), float(request.system), 0.0, 0.0, 0.0)
        system, component = driver.conversation.ids
        command = m.CommandLong(system, component, request.command, 0, *params)
        peers = (driver.conversation.peer, *self._ownership.other_peers(driver.conversation, now))
        return (Outgoing(command, among=peers),)

    def _refuse(self, what: str, request: CommandRequest, why: str, now: float,
                severity: Severity = Severity.WARNING) -> Result:  # fmt: skip
        self._texts.reply(request, severity, f"GCS {request.system}: {what} refused: {why}", now)
        return Result.FAILED


def _disarms(params: Sequence[float]) -> bool:
    return params[0] == 0


def _holds(params: Sequence[float]) -> bool:
    return parse_mode(*params[:3]) is Mode.HOLD


def _is_safe(params: Sequence[float]) -> bool:
    return params[0] == SAFE
