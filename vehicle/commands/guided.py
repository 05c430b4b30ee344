"""Commands and setpoints that make the vehicle drive by itself. Arming, stops and modes are in vehicle/commands/arming.py.

Only the ground station in control may give them; pausing is a stop and open to everybody.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Command, Result, Severity
from dialects.modes import Mode
from link.core import Received
from link.services.command.server import CommandHandler, CommandRequest, RunCommand, value_or_default
from vehicle.autonomy.navigator import DEFAULT_SPEED, Navigator
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
    CommandAccess,
    is_invalid_position,
    parse_altitude,
    parse_position,
)
from vehicle.drive.control import Control
from vehicle.modes import MODES
from vehicle.navigation.geo import Home
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

CHANGE_MODE = 1
"""MAV_DO_REPOSITION_FLAGS_CHANGE_MODE"""
AIRSPEED, GROUNDSPEED = 0, 1
"""SPEED_TYPE; a rover's are the same."""
KEEP_SPEED = -1
"""A speed of DO_CHANGE_SPEED and DO_REPOSITION that is none."""


class GuidedCommands:
    """Translates them into the verbs of Navigator and Safety."""

    def __init__(
        self, params: Params, safety: Safety, control: Control, navigator: Navigator, texts: StatusTextQueue
    ) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._asking = CommandAccess(control, texts)
        self._navigator = navigator
        self._texts = texts
        self._clock = SenderClock()
        self._mode_generation = -1

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        mine: dict[int, RunCommand] = {
            Command.DO_REPOSITION: self._reposition,
            Command.DO_CHANGE_SPEED: self._change_speed,
            Command.DO_SET_REVERSE: self._reverse,
            Command.DO_SET_HOME: self._set_home,
            Command.NAV_RETURN_TO_LAUNCH: self._return,
        }
        table = {command: self._asking.require_control(run) for command, run in mine.items()}
        return {**table, Command.DO_PAUSE_CONTINUE: CommandHandler(self._pause)}

    # Setpoints

    def handle_setpoint(self, received: Received, message: Setpoint, now: float) -> bool:
        """Take a setpoint; True where it is in force now. A refusal is told once."""
        system = self._control.system
        if message.target_system not in (0, system) or message.target_component not in (0, 1):
            return False
        if not received.introduced:
            return False
        target = self._rejection(received) or self._check_age(message, now)
        if target is None:  # overtaken by a newer one
            return False
        if isinstance(target, SetpointRejection):
            key = f"setpoint {received.system} {target.reason}"
            text = f"Setpoint of GCS {received.system} ignored: {target.reason}"
            self._texts.send_once(key, Severity.WARNING, text, now)
            return False
        self._texts.reset_once("setpoint")
        self._navigator.set_target(target, now)
        self._safety.confirm_autonomy()
        return True

    def _rejection(self, received: Received) -> SetpointRejection | None:
        if self._control.owner != received.system:
            return SetpointRejection(
                self._control.denial_reason(received.system) or "nobody is in control, arm to take it"
            )
        if self._safety.mode is not Mode.GUIDED:
            return SetpointRejection(f"mode is {self._safety.mode.name}, not GUIDED")
        if not self._safety.armed:
            return SetpointRejection("not armed")
        return None

    def _check_age(self, message: Setpoint, now: float) -> Target | SetpointRejection | None:
        """None for one that was overtaken. A clock is learnt anew with each choice of a mode, and arming."""
        if self._mode_generation != self._safety.mode_generation:
            self._mode_generation = self._safety.mode_generation
            self._clock = SenderClock()
        age = self._clock.age(message.time_boot_ms, now)
        if age is None:
            return None
        return (
            SetpointRejection("it is old, by its sender's clock") if age > SETPOINT_MAX_AGE else self._target(message)
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
        """A place that is one: may it be driven to?"""
        estimate = self._navigator.estimate
        point = global_to_local(request.x, request.y, estimate)
        if point is None or not estimate.good:
            return self._asking.reject(request, "position is not known", now)
        if not self._safety.armed:
            return self._asking.reject(request, "not armed", now)
        barred = self._navigator.fence_avoidance.rejection(point)
        if barred:
            return self._asking.reject(request, barred, now)
        if self._safety.mode is not Mode.GUIDED and (refusal := self._safety.choose_mode(Mode.GUIDED, now)):
            return self._asking.reject(request, refusal, now)
        self._navigator.restart_mode(self._safety, now)  # GUIDED begins, and forgets older targets
        self._navigator.set_target(PositionTarget(point, speed), now)
        self._safety.confirm_autonomy()
        return Result.ACCEPTED

    def _change_speed(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: which speed; 2: m/s, -1 no change, -2 the usual one."""
        kind, speed = request.params[:2]
        if kind not in (AIRSPEED, GROUNDSPEED):
            return Result.DENIED
        if speed == KEEP_SPEED:
            return Result.ACCEPTED
        if speed == DEFAULT_SPEED:
            self._navigator.speed_override = None
            return Result.ACCEPTED
        if not 0.0 <= speed < math.inf:
            return Result.DENIED
        largest = self._params["SPEED_MAX"]
        if speed > largest:
            self._texts.send(Severity.WARNING, f"Speed {speed:g} m/s cut to {largest:g} (SPEED_MAX)", now)
        self._navigator.speed_override = min(speed, largest)
        return Result.ACCEPTED

    def _reverse(self, request: CommandRequest, now: float) -> Result:
        """1: backwards along the path, 0: forwards."""
        if request.params[0] not in (0, 1):
            return Result.DENIED
        self._navigator.guide.reverse = bool(request.params[0])
        return Result.ACCEPTED

    def _set_home(self, request: CommandRequest, now: float) -> Result:
        """Parameter 1: 1 is here; else the place in 5..7."""
        here = request.params[0]
        if here not in (0, 1):
            return Result.DENIED
        navigator, estimate = self._navigator, self._navigator.estimate
        if not estimate.good or estimate.lat_lon is None:
            return self._asking.reject(request, "position is not known", now)
        if here:
            before = navigator.home.altitude if navigator.home else 0.0
            altitude = before if navigator.altitude is None else navigator.altitude
            navigator.home = Home(*estimate.lat_lon, altitude, *estimate.place)
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
        navigator.home = Home(latitude / 1e7, longitude / 1e7, altitude, *point)
        return Result.ACCEPTED

    def _return(self, request: CommandRequest, now: float) -> Result:
        refusal = self._safety.choose_mode(Mode.RTL, now)
        return self._asking.reject(request, refusal, now) if refusal else Result.ACCEPTED

    def _pause(self, request: CommandRequest, now: float) -> Result:
        """0: stand, 1: go on. Where nothing drives by itself a wish to stop is HOLD."""
        wish = request.params[0]
        if wish not in (0, 1):
            return Result.DENIED
        own = MODES[self._safety.mode].autonomous
        if wish == 0:
            self._safety.end_motor_test()
        if wish == 0 and not own:
            self._safety.choose_mode(Mode.HOLD, now)
            return Result.ACCEPTED
        if wish == 1:
            refusal = self._asking.denial_reason(request) or (None if own else f"mode is {self._safety.mode.name}")
            if refusal:
                return self._asking.reject(request, refusal, now)
        self._navigator.paused = wish == 0
        return Result.ACCEPTED
