"""DO_MOTOR_TEST and ACTUATOR_TEST: one motor of a disarmed rover turns, slowly and shortly, for who asked.

The two commands are one test: 3 s at most and MOT_TEST_MAX, one motor at a time. The last gate (vehicle/drive/gate.py)
holds both bounds by a watch of its own. The test ends at once with its time, with anything that changes the safety
state or the mode (every command of the stop set, arming, a motor fault), with a late control cycle, and when its asker
falls silent. Unlike ArduRover's it neither arms the vehicle nor turns a failsafe off.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from dialects.enums import Command, Result, Severity
from link.core import Received
from link.services.command.server import PROGRESS_TIMEOUT, CommandHandler, CommandRequest
from vehicle.commands.access import CommandAccess
from vehicle.drive.control import Control
from vehicle.drive.gate import MOTOR_TEST_TIME_MAX, MotorTest
from vehicle.drive.mixer import clamp
from vehicle.params import Params
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import SafetyState
from vehicle.statustext import StatusTextQueue

REQUESTER_TIMEOUT = 1.5
"""s without a frame of the asker that end its test. Ground stations send a HEARTBEAT a second, and some nothing else:
half a second is left for the way. A test that ends early because one was lost can be asked for again."""
THROTTLE_PERCENT = 0
"""MOTOR_TEST_THROTTLE_PERCENT; pulses and the pilot's stick are not offered."""

PERCENT_TOLERANCE = 1e-4
"""%; 30 % as a float32 share is a little more."""


@dataclass(frozen=True, slots=True)
class ActuatorTestRequest:
    """What a command asks for, whichever it was."""

    motor: int
    """Its index."""
    throttle: float
    time: float
    """s; 0 ends a test."""


RequestKey = tuple[int, int, int, ActuatorTestRequest]
"""By which a repeated request is known: system, component, command, what it asks for."""


@dataclass(slots=True)
class ActiveTest:
    """The test under way."""

    test: MotorTest
    asker: CommandRequest
    until: float
    last_heard: float
    mode_generation: int
    """Of the safety state it began in."""


class ActuatorTest:
    """One test at a time."""

    def __init__(
        self, params: Params, safety: Safety, control: Control, texts: StatusTextQueue, motors: Sequence[str]
    ) -> None:
        """`motors` are the names, in the order of the outputs."""
        self._params = params
        self._safety = safety
        self._asking = CommandAccess(control, texts)
        self._texts = texts
        self._motors = motors
        self._run: ActiveTest | None = None
        self._number = 0
        self._last: tuple[RequestKey, float] | None = None
        """The newest request that was obeyed, and when it came."""

    def handlers(self) -> dict[int, CommandHandler]:
        """The table for link.services.command.server.CommandServer."""
        return {
            Command.DO_MOTOR_TEST: self._asking.require_control(
                lambda request, now: self._do(request, _motor_test, now)
            ),
            Command.ACTUATOR_TEST: self._asking.require_control(
                lambda request, now: self._do(request, _actuator_test, now)
            ),
        }

    def update_liveness(self, received: Received, now: float) -> None:
        """Any frame of the asker, on the link that it asked by, is a sign of its life."""
        run = self._run
        if run and received.system == run.asker.system and received.peer == run.asker.peer:
            run.last_heard = now

    def current_test(self, now: float, *, late: bool) -> MotorTest | None:
        """What is permitted at this moment, for the last gate."""
        over = self._over(now, late=late) if self._run else None
        if over:
            self._run = None
            self._texts.send(Severity.INFO, f"Motor test over: {over}", now)
        return self._run.test if self._run else None

    def _over(self, now: float, *, late: bool) -> str | None:
        """Why the test ends, or None."""
        run = self._run
        if run is None:
            return None
        if run.mode_generation != self._safety.mode_generation:
            return "stopped"
        if late:
            return "control loop was late"
        if now >= run.until:
            return "time is up"
        return f"GCS {run.asker.system} is silent" if now - run.last_heard > REQUESTER_TIMEOUT else None

    def _do(
        self, request: CommandRequest, read: Callable[[CommandRequest], ActuatorTestRequest | None], now: float
    ) -> Result:
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        wish = read(request)
        if wish is None or not 0 <= wish.motor < len(self._motors):
            return Result.DENIED
        if wish.time == 0.0:
            if self._run:
                self._run.until = now
            return Result.ACCEPTED
        largest = self._params["MOT_TEST_MAX"]
        if abs(wish.throttle) * 100 > largest + PERCENT_TOLERANCE:
            self._texts.send(Severity.WARNING, f"Motor test refused: more than {largest:g} % (MOT_TEST_MAX)", now)
            return Result.DENIED
        if self._safety.state is not SafetyState.SAFE:
            return self._asking.reject(request, f"vehicle is in state {self._safety.state.value}", now)
        return self._begin(request, wish, now)

    def _begin(self, request: CommandRequest, wish: ActuatorTestRequest, now: float) -> Result:
        self.current_test(now, late=False)  # one whose time is up is none
        key = (request.system, request.component, request.command, wish)
        if self._run is None:
            if self._last and self._last[0] == key and now - self._last[1] < PROGRESS_TIMEOUT:
                # A repeat, because its answer was lost: the wheel has turned already.
                self._texts.send(Severity.NOTICE, f"Motor test: asked a moment ago, wait {PROGRESS_TIMEOUT:g} s", now)
                return Result.ACCEPTED
            words = f"{self._motors[wish.motor]} at {wish.throttle:+.0%} for {wish.time:g} s"
            self._texts.send(Severity.WARNING, f"Motor test: {words}, by GCS {request.system}", now)
        elif (self._run.asker.system, self._run.test.motor) != (request.system, wish.motor):
            return Result.TEMPORARILY_REJECTED
        self._last = (key, now)
        self._number += 1
        trial = MotorTest(self._number, wish.motor, clamp(wish.throttle, self._params["MOT_TEST_MAX"] / 100))
        self._run = ActiveTest(trial, request, now + wish.time, now, self._safety.mode_generation)
        return Result.ACCEPTED


def _motor_test(request: CommandRequest) -> ActuatorTestRequest | None:
    """1: motor from 1, 2: kind of throttle, 3: percent, 4: s, 5: how many motors, one after the other: only one."""
    instance, kind, percent, seconds, count = request.params[:5]
    if (
        kind != THROTTLE_PERCENT
        or count not in (0, 1)
        or not math.isfinite(percent)
        or not 0.0 < seconds <= MOTOR_TEST_TIME_MAX
    ):
        return None
    return _wish(instance, percent / 100, seconds)


def _actuator_test(request: CommandRequest) -> ActuatorTestRequest | None:
    """1: -1..1 and NaN to stop, 2: s, 0 to stop, 5: motor from 1 (ACTUATOR_OUTPUT_FUNCTION_MOTOR1)."""
    value, seconds, function = request.params[0], request.params[1], request.params[4]
    if not 0.0 <= seconds <= MOTOR_TEST_TIME_MAX or math.isinf(value):
        return None
    return _wish(function, 0.0 if math.isnan(value) else value, 0.0 if math.isnan(value) else seconds)


def _wish(number: float, throttle: float, seconds: float) -> ActuatorTestRequest | None:
    whole = math.isfinite(number) and number == int(number)
    return ActuatorTestRequest(int(number) - 1, throttle, seconds) if whole else None
