"""Commands and mission items for relays and servos: who may, what they ask for, and what stops an accessory.

An accessory needs no arming, as in ArduPilot: it moves no wheel, and a lamp or a camera is of use while the rover
stands. What is dangerous by itself, a blade or a pump, says so in the file (`until = "disarm"`). Repeats go on beside
everything else; whatever is asked of the same output next ends them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from typing import NamedTuple

from dialects.enums import Command, Result, Severity
from link.services.command.server import PROGRESS_TIMEOUT, CommandHandler, CommandRequest
from link.services.mission.items import MissionItem
from vehicle.accessories import PERIOD_MAX, TIMES_MAX
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.accessories.output import AccessoryOutput, Until
from vehicle.commands.access import CommandAccess
from vehicle.drive.control import Control
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import SafetyState
from vehicle.statustext import StatusTextQueue

PERIOD_MIN = 0.1
"""s; a shorter one is made longer, as ArduPilot does: relays wear out."""


class AccessoryRequest(NamedTuple):
    """What a command or an item asks for, whichever it was."""

    kind: str
    number: float
    value: float | None
    """Of a relay 0 or 1, of a servo us; None is the other state of a relay."""
    times: float | None = None
    """None: stay there."""
    period: float = 0.0

    def problem(self, outlet: AccessoryOutput) -> str | None:
        """Why `outlet` cannot do that, or None."""
        if self.value is not None and (why := _unfit(self.value, outlet)):
            return why
        if self.times is not None and not (1 <= self.times <= TIMES_MAX and self.times == int(self.times)):
            return f"times {self.times:g} is no whole number from 1 to {TIMES_MAX}"
        if not 0.0 <= self.period <= PERIOD_MAX:
            return f"period {self.period:g} s is not 0 to {PERIOD_MAX:g}"
        return None


def _unfit(value: float, outlet: AccessoryOutput) -> str | None:
    pulses = outlet.spec.pulses
    if pulses is None:
        return None if value in (0, 1) else f"{value:g} is neither 0 nor 1"
    return None if pulses.low <= value <= pulses.high else f"{value:g} us is not {pulses.low} to {pulses.high}"


REQUEST_PARSERS: dict[int, Callable[[float, float, float, float], AccessoryRequest]] = {
    Command.DO_SET_RELAY: lambda one, two, three, four: AccessoryRequest("relay", one, two),
    Command.DO_REPEAT_RELAY: lambda one, two, three, four: AccessoryRequest("relay", one, None, two, three),
    Command.DO_SET_SERVO: lambda one, two, three, four: AccessoryRequest("servo", one, two),
    Command.DO_REPEAT_SERVO: lambda one, two, three, four: AccessoryRequest("servo", one, two, three, four),
}
"""Command -> what its parameters 1..4 mean."""


class AccessoryCommands:
    """Obeys them. `step` each cycle, when the motors have what they are to have."""

    def __init__(
        self, rack: AccessorySet, safety: Safety, control: Control, texts: StatusTextQueue, motors: Collection[int]
    ) -> None:
        """`motors` are the servo outputs that motors are at: nobody's servos, whatever the rack holds."""
        self._rack = rack
        self._safety = safety
        self._asking = CommandAccess(control, texts)
        self._texts = texts
        self._motors = motors
        self._newest: dict[str, tuple[object, float]] = {}
        """Output -> the newest command that it obeyed, and when it came."""
        self._told: dict[str, str] = {}
        """Output -> its fault, as the driver has read it."""

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        return {command: self._asking.require_control(self._command) for command in REQUEST_PARSERS}

    def unsupported_reason(self, item: MissionItem) -> str | None:
        """Why there is no way to do what an item says, or None; that something forbids it now is none."""
        wish = REQUEST_PARSERS[item.command](*item.params)
        outlet = self._find(wish)
        return outlet if isinstance(outlet, str) else wish.problem(outlet)

    def execute_item(self, item: MissionItem, now: float) -> str | None:
        """It is an item's turn. Returns why it was passed over."""
        wish = REQUEST_PARSERS[item.command](*item.params)
        outlet = self._find(wish)
        if isinstance(outlet, str):
            return outlet
        why = wish.problem(outlet) or self._secured(outlet.spec.until, now)
        if why is None:
            self._obey(outlet, wish, now)
        return why

    def update(self, now: float) -> None:
        """What time and the state of the vehicle do to the accessories, down to the hardware."""
        for outlet, why in self._rack.update(lambda until: self._secured(until, now), now):
            self._newest.pop(outlet.spec.name, None)
            words = outlet.spec.format_value(outlet.target)
            self._texts.send(Severity.NOTICE, f"{outlet.spec.name.capitalize()}: {words} ({why})", now)
        for outlet in self._rack:
            self._tell(outlet, now)

    def _command(self, request: CommandRequest, now: float) -> Result:
        """DENIED for what can never be; FAILED where something must be put right first."""
        one, two, three, four = request.params[:4]
        wish = REQUEST_PARSERS[request.command](one, two, three, four)
        outlet = self._find(wish)
        if isinstance(outlet, str):
            return self._denied(request, outlet, now)
        if why := wish.problem(outlet):
            return self._denied(request, f"{outlet.spec.name}: {why}", now)
        if why := self._secured(outlet.spec.until, now):
            return self._asking.reject(request, f"{outlet.spec.name}: {why}", now)
        key = (request.system, request.component, request.command, request.params)
        if wish.times is None or not self._said_again(outlet, key, now):
            self._obey(outlet, wish, now)
            self._newest[outlet.spec.name] = (key, now)
        if outlet.fault:  # what was asked for last counts all the same, when it works again
            return self._asking.reject(request, f"{outlet.spec.name}: {outlet.fault}", now)
        return Result.ACCEPTED

    def _find(self, wish: AccessoryRequest) -> AccessoryOutput | str:
        """The output; or why there is none."""
        if wish.kind == "servo" and wish.number in self._motors:
            return f"servo {wish.number:g} is a motor"
        outlet = self._rack.find(wish.kind, wish.number)
        if outlet is None:
            return f"there is no {wish.kind} {wish.number:g}"
        return outlet

    def _said_again(self, outlet: AccessoryOutput, key: object, now: float) -> bool:
        """Because its answer was lost: a repeat that runs, or has just ended, must not begin anew."""
        newest = self._newest.get(outlet.spec.name)
        return newest is not None and newest[0] == key and now - newest[1] < PROGRESS_TIMEOUT

    def _obey(self, outlet: AccessoryOutput, wish: AccessoryRequest, now: float) -> None:
        self._newest.pop(outlet.spec.name, None)
        value = None if wish.value is None else round(wish.value)
        if wish.times is not None:
            outlet.start_repeat(value, int(wish.times), max(PERIOD_MIN, wish.period), now)
        elif value is not None:
            outlet.set_value(value)

    def _secured(self, until: Until, now: float) -> str | None:
        """Why accessories that keep what they have until then must be safe at this moment, or None."""
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

    def _denied(self, request: CommandRequest, why: str, now: float) -> Result:
        self._asking.reject(request, why, now)
        return Result.DENIED

    def _tell(self, outlet: AccessoryOutput, now: float) -> None:
        """A fault, once; and its end."""
        name, fault = outlet.spec.name, outlet.fault
        if fault == self._told.get(name):
            return
        if fault is None:
            del self._told[name]
            self._texts.send(Severity.NOTICE, f"{name.capitalize()} works again", now)
        else:
            self._told[name] = fault
            self._texts.send(Severity.WARNING, f"{name.capitalize()}: {fault}", now)
