"""Setpoints of GUIDED, and DO_REPOSITION, DO_CHANGE_SPEED, DO_SET_HOME, DO_PAUSE_CONTINUE and their like.

Only the ground station in control may send them. Pausing is a stop and open to anyone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from dialects import messages as m
from dialects.enums import Command, Result, Severity
from dialects.modes import Mode
from link.core import Received
from link.services.command.request import CommandRequest, value_or_default
from link.services.mission.items import ItemRule, MissionItem
from vehicle.autonomy.mission.rules import DoItem
from vehicle.autonomy.navigator import Navigator
from vehicle.autonomy.setpoints import (
    SETPOINT_MAX_AGE,
    PositionTarget,
    SenderClock,
    Setpoint,
    SetpointRejection,
    Target,
    global_to_local,
    parse_attitude_target,
    parse_position_target,
)
from vehicle.commands.access import (
    ALTITUDE_MAX,
    GLOBAL_FRAMES,
    Access,
    is_invalid_position,
    parse_altitude,
    parse_position,
)
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import COMPONENT, Context
from vehicle.commands.inbound import Effect, InboundMessage, InboundTable
from vehicle.modes import MODES
from vehicle.navigation.geo import Home

CHANGE_MODE = 1
"""MAV_DO_REPOSITION_FLAGS_CHANGE_MODE"""
AIRSPEED, GROUNDSPEED = 0, 1
"""SPEED_TYPE; the same for a rover."""
KEEP_SPEED = -1
"""Speed of DO_CHANGE_SPEED and DO_REPOSITION that changes nothing."""
DEFAULT_SPEED = -2
"""Speed of DO_CHANGE_SPEED that restores WP_SPEED."""
SPEED_RANGE = (DEFAULT_SPEED, 100.0)
"""m/s; of a DO_CHANGE_SPEED item."""
PAUSE, CONTINUE = 0, 1
"""Parameter 1 of DO_PAUSE_CONTINUE."""


class GuidedCommands:
    """Handles setpoints and commands that call Navigator and Safety."""

    def __init__(self, context: Context) -> None:
        self._params = context.params
        self._safety = context.safety
        self._control = context.control
        self._access = context.access
        self._navigator = context.navigator
        self._texts = context.statustext
        self._clock = SenderClock()
        self._mode_generation = -1

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        driver = Access.DRIVER_OR_UNCLAIMED
        return (
            CommandSpec(Command.DO_REPOSITION, self._reposition, driver,
                        "COMMAND_INT; 1: m/s, -1 WP_SPEED; 2: 1 changes to GUIDED; x, y: position"),
            CommandSpec(Command.DO_CHANGE_SPEED, self._change_speed, driver,
                        "1: 0 or 1; 2: m/s, -1 no change, -2 WP_SPEED",
                        item=DoItem(ItemRule(ranges={1: (0.0, 1.0), 2: SPEED_RANGE}), self._run_speed_item)),
            CommandSpec(Command.DO_SET_REVERSE, self._reverse, driver,
                        "1: 1 backwards along the path, 0 forwards",
                        item=DoItem(ItemRule(ranges={1: (0.0, 1.0)}), self._run_reverse_item)),
            CommandSpec(Command.DO_SET_HOME, self._set_home, driver,
                        "1: 1 the position of the rover, 0 the position in 5 to 7"),
            CommandSpec(Command.NAV_RETURN_TO_LAUNCH, self._return, driver, "changes to RTL"),
            CommandSpec(Command.DO_PAUSE_CONTINUE, self._pause, driver, "1: 0 pause, 1 continue", stops=_pauses),
        )  # fmt: skip

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return tuple(
            InboundMessage(message, Access.DRIVER, "setpoint of GUIDED", self._handle_setpoint, Effect.MOTION)
            for message in (m.SetPositionTargetLocalNed, m.SetPositionTargetGlobalInt, m.SetAttitudeTarget)
        )

    # Setpoints

    def _handle_setpoint(self, received: Received, message: Setpoint, now: float) -> None:
        """Put a setpoint in force. A rejection is reported once."""
        if message.target_system not in (0, self._control.system) or message.target_component not in (0, COMPONENT):
            return
        target = self._rejection(received, now) or self._check_age(message, now)
        if target is None:  # overtaken by a newer one
            return
        if isinstance(target, SetpointRejection):
            key = f"setpoint {received.system} {target.reason}"
            text = f"Setpoint of GCS {received.system} ignored: {target.reason}"
            self._texts.reply_once(key, received, Severity.WARNING, text, now)
            return
        self._texts.reset_once("setpoint")
        self._use(target, now)

    def drive_to(self, message: m.SetPositionTargetGlobalInt, received: Received, now: float) -> str | None:
        """Put a position setpoint without a clock in force; return why it is refused, or None."""
        target = self._rejection(received, now) or self._target(message)
        if isinstance(target, SetpointRejection):
            return target.reason
        self._use(target, now)
        return None

    def _use(self, target: Target, now: float) -> None:
        self._navigator.set_target(target, now)
        self._safety.confirm_autonomy()
        self._navigator.step(self._safety, now)

    def _rejection(self, received: Received, now: float) -> SetpointRejection | None:
        if denial := self._control.ownership.setpoint_denial_reason(received, now):
            return SetpointRejection(denial)
        if self._safety.mode is not Mode.GUIDED:
            return SetpointRejection(f"mode is {self._safety.mode.name}, not GUIDED")
        if not self._safety.armed:
            return SetpointRejection("not armed")
        return None

    def _check_age(self, message: Setpoint, now: float) -> Target | SetpointRejection | None:
        """Return None for a setpoint that a newer one overtook. A change of mode, or arming, resets the clock."""
        if self._mode_generation != self._safety.mode_generation:
            self._mode_generation = self._safety.mode_generation
            self._clock = SenderClock()
        age = self._clock.age(message.time_boot_ms, now)
        if age is None:
            return None
        return (
            SetpointRejection("too old by the clock of its sender") if age > SETPOINT_MAX_AGE else self._target(message)
        )

    def _target(self, message: Setpoint) -> Target | SetpointRejection:
        if isinstance(message, m.SetAttitudeTarget):
            return parse_attitude_target(message, self._navigator.cruise_speed())
        target = parse_position_target(message, self._navigator.estimate)
        barred = self._navigator.fence_avoidance.rejection(target.point) if isinstance(target, PositionTarget) else None
        return SetpointRejection(barred) if barred else target

    # Commands

    def _reposition(self, request: CommandRequest, now: float) -> Result:
        if not request.is_int:
            return Result.INT_ONLY
        if request.frame not in GLOBAL_FRAMES:
            return Result.UNSUPPORTED_FRAME
        speed, flags = value_or_default(request.params[0], KEEP_SPEED), value_or_default(request.params[1])
        changes = flags == CHANGE_MODE
        if flags not in (0, CHANGE_MODE) or not (changes or self._safety.mode is Mode.GUIDED):
            return Result.DENIED
        if not (speed == KEEP_SPEED or 0.0 < speed <= 1e3):
            return Result.DENIED
        if is_invalid_position(request.x, request.y):
            return Result.DENIED
        return self._go(request, speed if speed > 0.0 else None, now)

    def _go(self, request: CommandRequest, speed: float | None, now: float) -> Result:
        """Drive to a valid position, unless something forbids it."""
        estimate = self._navigator.estimate
        point = global_to_local(request.x, request.y, estimate)
        if point is None or not estimate.good:
            return self._access.reject(request, "position is not known", now)
        if not self._safety.armed:
            return self._access.reject(request, "not armed", now)
        barred = self._navigator.fence_avoidance.rejection(point)
        if barred:
            return self._access.reject(request, barred, now)
        if self._safety.mode is not Mode.GUIDED and (refusal := self._safety.choose_mode(Mode.GUIDED, now)):
            return self._access.reject(request, refusal, now)
        self._navigator.restart_mode(self._safety, now)  # GUIDED begins, and forgets older targets
        self._navigator.set_target(PositionTarget(point, speed), now)
        self._safety.confirm_autonomy()
        return Result.ACCEPTED

    def _change_speed(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: SPEED_TYPE; 2: m/s, -1 no change, -2 WP_SPEED."""
        kind, speed = request.params[:2]
        if kind not in (AIRSPEED, GROUNDSPEED):
            return Result.DENIED
        if speed == KEEP_SPEED:
            return Result.ACCEPTED
        if speed == DEFAULT_SPEED:
            self._navigator.set_speed(None)
            return Result.ACCEPTED
        if not 0.0 <= speed < math.inf:
            return Result.DENIED
        largest = self._params["SPEED_MAX"]
        if speed > largest:
            self._texts.reply(request, Severity.WARNING, f"Speed {speed:g} m/s limited to {largest:g} (SPEED_MAX)", now)
        self._navigator.set_speed(min(speed, largest))
        return Result.ACCEPTED

    def _run_speed_item(self, item: MissionItem, now: float) -> None:
        speed = item.params[1]
        if speed >= 0.0:
            self._navigator.set_speed(speed)
        elif speed == DEFAULT_SPEED:
            self._navigator.set_speed(None)

    def _reverse(self, request: CommandRequest, now: float) -> Result:
        if request.params[0] not in (0, 1):
            return Result.DENIED
        self._navigator.set_reverse(bool(request.params[0]))
        return Result.ACCEPTED

    def _run_reverse_item(self, item: MissionItem, now: float) -> None:
        self._navigator.set_reverse(bool(item.params[0]))

    def _set_home(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: 1 is the position of the rover; 0 the position in 5 to 7."""
        here = request.params[0]
        if here not in (0, 1):
            return Result.DENIED
        navigator, estimate = self._navigator, self._navigator.estimate
        if not estimate.good or estimate.lat_lon is None:
            return self._access.reject(request, "position is not known", now)
        if here:
            before = navigator.home.altitude if navigator.home else 0.0
            altitude = before if navigator.altitude is None else navigator.altitude
            navigator.set_home(Home(*estimate.lat_lon, altitude, *estimate.place))
            return Result.ACCEPTED
        return self._home_at(request, navigator)

    @staticmethod
    def _home_at(request: CommandRequest, navigator: Navigator) -> Result:
        place = parse_position(request)
        if isinstance(place, Result):
            return place
        altitude = parse_altitude(request, navigator.home)
        if altitude is None:
            altitude = navigator.home.altitude if navigator.home else 0.0
        latitude, longitude = place
        point = global_to_local(latitude, longitude, navigator.estimate)
        if point is None or not abs(altitude) < ALTITUDE_MAX:
            return Result.DENIED
        navigator.set_home(Home(latitude / 1e7, longitude / 1e7, altitude, *point))
        return Result.ACCEPTED

    def _return(self, request: CommandRequest, now: float) -> Result:
        refusal = self._safety.choose_mode(Mode.RTL, now)
        return self._access.reject(request, refusal, now) if refusal else Result.ACCEPTED

    def _pause(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: 0 pauses, 1 continues. Outside of autonomous modes a pause changes to HOLD."""
        action = request.params[0]
        if action not in (PAUSE, CONTINUE):
            return Result.DENIED
        autonomous = MODES[self._safety.mode].autonomous
        if action == CONTINUE:
            if not autonomous:
                return self._access.reject(request, f"mode is {self._safety.mode.name}", now)
            self._navigator.resume()
            return Result.ACCEPTED
        self._safety.end_motor_test()
        if autonomous:
            self._navigator.pause()
        else:
            self._safety.choose_mode(Mode.HOLD, now)
        return Result.ACCEPTED


def _pauses(params: Sequence[float]) -> bool:
    return params[0] == PAUSE
