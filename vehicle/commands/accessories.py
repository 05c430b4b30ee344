"""DO_SET_RELAY, DO_REPEAT_RELAY, DO_SET_SERVO and DO_REPEAT_SERVO, as commands and as mission items.

An accessory needs no arming, as in ArduPilot: it moves no wheel, and a lamp or a camera is useful while the rover
stands. An accessory that is dangerous, such as a blade or a pump, has `until = "disarm"` in rover.toml. A repeat runs
beside everything else; the next command for the same output ends it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

from dialects.enums import Command, Result, Severity, command_name
from link.services.command.request import PROGRESS_TIMEOUT, CommandRequest
from link.services.mission.items import ItemRule, MissionItem
from vehicle.accessories import LARGEST_RELAY, LARGEST_SERVO, PERIOD_MAX, TIMES_MAX
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.accessories.output import AccessoryOutput, Until
from vehicle.autonomy.mission.rules import DoItem
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.states import SafetyState

PERIOD_MIN = 0.1
"""s; a shorter one is made longer, as in ArduPilot: relays wear out."""
Range = tuple[float, float]
SERVOS: Range = (1.0, LARGEST_SERVO)
RELAYS: Range = (0.0, LARGEST_RELAY)
PULSES: Range = (500.0, 2500.0)
"""us; what any servo takes. The range of one servo is in rover.toml."""
TIMES: Range = (1.0, TIMES_MAX)
PERIODS: Range = (0.0, PERIOD_MAX)


class AccessoryRequest(NamedTuple):
    """The parameters of a command or a mission item."""

    kind: str
    number: float
    value: float | None
    """0 or 1 for a relay, us for a servo; None toggles a relay."""
    times: float | None = None
    """None: no repeat."""
    period: float = 0.0

    def problem(self, outlet: AccessoryOutput) -> str | None:
        """Return why `outlet` cannot do this, or None."""
        if self.value is not None and (why := _unfit(self.value, outlet)):
            return why
        if self.times is not None and not (1 <= self.times <= TIMES_MAX and self.times == int(self.times)):
            return f"times {self.times:g} is not a whole number from 1 to {TIMES_MAX}"
        if not 0.0 <= self.period <= PERIOD_MAX:
            return f"period {self.period:g} s is not 0 to {PERIOD_MAX:g}"
        return None


def _unfit(value: float, outlet: AccessoryOutput) -> str | None:
    pulses = outlet.spec.pulses
    if pulses is None:
        return None if value in (0, 1) else f"{value:g} is neither 0 nor 1"
    return None if pulses.low <= value <= pulses.high else f"{value:g} us is not {pulses.low} to {pulses.high}"


ParseRequest = Callable[[Sequence[float]], AccessoryRequest]
"""Reads parameters 1 to 4."""


def _parse_set_relay(params: Sequence[float]) -> AccessoryRequest:
    return AccessoryRequest("relay", params[0], params[1])


def _parse_repeat_relay(params: Sequence[float]) -> AccessoryRequest:
    return AccessoryRequest("relay", params[0], None, params[1], params[2])


def _parse_set_servo(params: Sequence[float]) -> AccessoryRequest:
    return AccessoryRequest("servo", params[0], params[1])


def _parse_repeat_servo(params: Sequence[float]) -> AccessoryRequest:
    return AccessoryRequest("servo", params[0], params[1], params[2], params[3])


class AccessoryCommands:
    """Sets relays and servos. Call `update` each cycle, after the motors are written."""

    def __init__(self, context: Context, rack: AccessorySet) -> None:
        self._rack = rack
        self._safety = context.safety
        self._access = context.access
        self._texts = context.statustext
        self._motors = context.mixer.servos
        """Servo outputs that motors use: never accessories, whatever `rack` holds."""
        self._newest: dict[str, tuple[object, float]] = {}
        """Output -> its newest accepted command, and when it came."""
        self._reported: dict[str, str] = {}
        """Output -> the fault that was reported."""

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            self._row(Command.DO_SET_SERVO, "1: output, 2: us; motor outputs are denied",
                      _parse_set_servo, {1: SERVOS, 2: PULSES}),
            self._row(Command.DO_REPEAT_SERVO, "1: output, 2: us, 3: cycles, 4: s between two changes",
                      _parse_repeat_servo, {1: SERVOS, 2: PULSES, 3: TIMES, 4: PERIODS}),
            self._row(Command.DO_SET_RELAY, "1: relay, 2: 0 or 1", _parse_set_relay, {1: RELAYS, 2: (0.0, 1.0)}),
            self._row(Command.DO_REPEAT_RELAY, "1: relay, 2: cycles, 3: s between two changes",
                      _parse_repeat_relay, {1: RELAYS, 2: TIMES, 3: PERIODS}),
        )  # fmt: skip

    def _row(self, command: Command, text: str, parse: ParseRequest, ranges: dict[int, Range]) -> CommandSpec:
        item = DoItem(
            ItemRule(ranges=ranges),
            partial(self._run_item, parse),
            accepts=partial(self._accepts_item, parse),
            unsupported_reason=partial(self._unsupported_reason, parse),
        )
        return CommandSpec(command, partial(self._handle_command, parse), Access.DRIVER_OR_UNCLAIMED, text, item=item)

    def _accepts_item(self, parse: ParseRequest, item: MissionItem) -> bool:
        """Reject a plan that moves a motor, or whose output is not a whole number."""
        request = parse(item.params)
        return request.number == int(request.number) and not self._is_motor(request)

    def _unsupported_reason(self, parse: ParseRequest, item: MissionItem) -> str | None:
        """Return why this vehicle can never run an item, or None."""
        request = parse(item.params)
        outlet = self._find(request)
        return outlet if isinstance(outlet, str) else request.problem(outlet)

    def _run_item(self, parse: ParseRequest, item: MissionItem, now: float) -> None:
        """Run an item, or report why it is skipped."""
        request = parse(item.params)
        outlet = self._find(request)
        if isinstance(outlet, str):
            reason: str | None = outlet
        else:
            reason = request.problem(outlet) or self._safe_reason(outlet.spec.until, now)
            if reason is None:
                self._apply(outlet, request, now)
        if reason:
            text = f"Mission: skipped {command_name(item.command)} {item.params[0]:g}: {reason}"
            self._texts.send(Severity.WARNING, text, now)

    def update(self, now: float) -> None:
        """Advance repeats, make accessories safe when the vehicle state demands it, and write the hardware."""
        for outlet, reason in self._rack.update(lambda until: self._safe_reason(until, now), now):
            self._newest.pop(outlet.spec.name, None)
            value = outlet.spec.format_value(outlet.target)
            self._texts.send(Severity.NOTICE, f"{outlet.spec.name.capitalize()}: {value} ({reason})", now)
        for outlet in self._rack:
            self._report_fault(outlet, now)

    def _handle_command(self, parse: ParseRequest, command: CommandRequest, now: float) -> Result:
        """Return DENIED for what can never work, and FAILED if something must be put right first."""
        request = parse(command.params)
        outlet = self._find(request)
        if isinstance(outlet, str):
            return self._deny(command, outlet, now)
        if reason := request.problem(outlet):
            return self._deny(command, f"{outlet.spec.name}: {reason}", now)
        if reason := self._safe_reason(outlet.spec.until, now):
            return self._access.reject(command, f"{outlet.spec.name}: {reason}", now)
        key = (command.system, command.component, command.command, command.params)
        if request.times is None or not self._is_repeated(outlet, key, now):
            self._apply(outlet, request, now)
            self._newest[outlet.spec.name] = (key, now)
        if outlet.fault:  # the newest command is applied all the same once the output works again
            return self._access.reject(command, f"{outlet.spec.name}: {outlet.fault}", now)
        return Result.ACCEPTED

    def _find(self, request: AccessoryRequest) -> AccessoryOutput | str:
        """Return the output, or why there is none."""
        if self._is_motor(request):
            return f"servo {request.number:g} is a motor"
        outlet = self._rack.find(request.kind, request.number)
        if outlet is None:
            return f"there is no {request.kind} {request.number:g}"
        return outlet

    def _is_motor(self, request: AccessoryRequest) -> bool:
        return request.kind == "servo" and request.number in self._motors

    def _is_repeated(self, outlet: AccessoryOutput, key: object, now: float) -> bool:
        """Return whether a command came again because its answer was lost: its repeat must not start over."""
        newest = self._newest.get(outlet.spec.name)
        return newest is not None and newest[0] == key and now - newest[1] < PROGRESS_TIMEOUT

    def _apply(self, outlet: AccessoryOutput, request: AccessoryRequest, now: float) -> None:
        self._newest.pop(outlet.spec.name, None)
        value = None if request.value is None else round(request.value)
        if request.times is not None:
            outlet.start_repeat(value, int(request.times), max(PERIOD_MIN, request.period), now)
        elif value is not None:
            outlet.set_value(value)

    def _safe_reason(self, until: Until, now: float) -> str | None:
        """Return why accessories with this `until` must be in their safe state now, or None."""
        safety = self._safety
        if until == "end":
            return None
        if safety.state is SafetyState.ESTOP:
            return "emergency stop"
        if until == "stop":
            return None
        if not safety.armed:
            return "not armed"
        stops = safety.failsafes.lasting_action(now) >= FailsafeAction.NEUTRAL or safety.failsafes.latched
        return "failsafe" if stops else None

    def _deny(self, command: CommandRequest, reason: str, now: float) -> Result:
        self._access.reject(command, reason, now)
        return Result.DENIED

    def _report_fault(self, outlet: AccessoryOutput, now: float) -> None:
        """Report the start and the end of a fault, once each."""
        name, fault = outlet.spec.name, outlet.fault
        if fault == self._reported.get(name):
            return
        if fault is None:
            del self._reported[name]
            self._texts.send(Severity.NOTICE, f"{name.capitalize()} works again", now)
        else:
            self._reported[name] = fault
            self._texts.send(Severity.WARNING, f"{name.capitalize()}: {fault}", now)
