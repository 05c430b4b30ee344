"""DO_MOTOR_TEST and ACTUATOR_TEST: run one motor of a disarmed rover slowly, for 3 s at most.

Both commands start the same test: at most 3 s and MOT_TEST_MAX, one motor at a time. The last gate
(vehicle/drive/gate.py) enforces both limits with a timer of its own. The test ends with its time, with any change of
safety state or mode (every command that stops, arming, a motor fault), with a late control cycle, and when its sender
is silent. Unlike ArduRover's motor test it neither arms the vehicle nor disables a failsafe.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import msgspec

from dialects.enums import Command, Result, Severity
from link.core import Received
from link.services.command.request import PROGRESS_TIMEOUT, CommandRequest
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.command_table import CommandSpec, CommandTable
from vehicle.commands.context import Context
from vehicle.drive.conversation import Conversation
from vehicle.drive.gate import MOTOR_TEST_TIME_MAX, MotorTest
from vehicle.drive.mixer import clamp
from vehicle.safety.states import SafetyState

REQUESTER_TIMEOUT = 1.5
"""s without a frame of the sender that end its test. Some ground stations send nothing but a HEARTBEAT a second, which
leaves 0.5 s for delays. A test that ended because of a lost HEARTBEAT can be sent again."""
THROTTLE_PERCENT = 0
"""MOTOR_TEST_THROTTLE_PERCENT; MOTOR_TEST_THROTTLE_PWM and _PILOT are not offered."""

PERCENT_TOLERANCE = 1e-4
"""%; 0.3 as float32 is slightly more than 30 %."""


class ActuatorTestRequest(msgspec.Struct, frozen=True):
    """The parameters of either command."""

    motor: int
    """Index, from 0."""
    throttle: float
    time: float
    """s; 0 ends a test."""


RequestKey = tuple[int, int, int, ActuatorTestRequest]
"""Identifies a repeated request: system, component, command, parameters."""


class ActiveTest(msgspec.Struct):
    """The test under way."""

    test: MotorTest
    request: CommandRequest
    until: float
    last_heard: float
    mode_generation: int
    """`Safety.mode_generation` at its start."""


class ActuatorTest:
    """Runs one test at a time."""

    def __init__(self, context: Context) -> None:
        self._params = context.params
        self._safety = context.safety
        self._access = context.access
        self._texts = context.statustext
        self._motors = context.mixer.motors
        self._run: ActiveTest | None = None
        self._number = 0
        self._last: tuple[RequestKey, float] | None = None
        """The newest accepted request, and when it came."""

    @property
    def running(self) -> bool:
        """Whether a test was accepted and has not ended."""
        return self._run is not None

    def commands(self) -> CommandTable:
        """Return the rows of the commands handled here."""
        return (
            CommandSpec(Command.DO_MOTOR_TEST, partial(self._handle_command, _parse_motor_test),
                        Access.DRIVER_OR_UNCLAIMED,
                        "disarmed; 1: motor from 1, 2: 0 (percent), 3: percent, 4: s up to 3",
                        role=SigningRole.SET_UP),
            CommandSpec(Command.ACTUATOR_TEST, partial(self._handle_command, _parse_actuator_test),
                        Access.DRIVER_OR_UNCLAIMED,
                        "disarmed; 1: -1..1, NaN stops, 2: s up to 3, 0 stops, 5: motor from 1",
                        role=SigningRole.SET_UP),
        )  # fmt: skip

    def update_liveness(self, received: Received, now: float) -> None:
        """Note a frame of the conversation that sent the command."""
        run = self._run
        if run and Conversation.of(received) == Conversation.of(run.request):
            run.last_heard = now

    def current_test(self, now: float, *, late: bool) -> MotorTest | None:
        """Return the test that may run now, for the last gate."""
        run = self._run
        if run is None:
            return None
        end_reason = self._end_reason(run, now, late=late)
        if end_reason is None:
            return run.test
        self._run = None
        self._texts.send_change(Severity.INFO, f"Motor test over: {end_reason}", now)
        return None

    def _end_reason(self, run: ActiveTest, now: float, *, late: bool) -> str | None:
        """Return why a test ends now, or None."""
        if run.mode_generation != self._safety.mode_generation:
            return "stopped"
        if late:
            return "control loop was late"
        if now >= run.until:
            return "time is up"
        return f"GCS {run.request.system} is silent" if now - run.last_heard > REQUESTER_TIMEOUT else None

    def _handle_command(
        self, parse: Callable[[CommandRequest], ActuatorTestRequest | None], request: CommandRequest, now: float
    ) -> Result:
        if self._safety.armed:
            return Result.TEMPORARILY_REJECTED
        test = parse(request)
        if test is None or not 0 <= test.motor < len(self._motors):
            return Result.DENIED
        if test.time == 0.0:
            if self._run:
                self._run.until = now
            return Result.ACCEPTED
        largest = self._params["MOT_TEST_MAX"]
        if abs(test.throttle) * 100 > largest + PERCENT_TOLERANCE:
            text = f"Motor test refused: more than {largest:g} % (MOT_TEST_MAX)"
            self._texts.reply(request, Severity.WARNING, text, now)
            return Result.DENIED
        if self._safety.state is not SafetyState.SAFE:
            return self._access.reject(request, f"vehicle is in state {self._safety.state.value}", now)
        return self._begin(request, test, now)

    def _begin(self, request: CommandRequest, test: ActuatorTestRequest, now: float) -> Result:
        self.current_test(now, late=False)  # ends a test whose time is up
        key = (request.system, request.component, request.command, test)
        if self._run is None:
            if self._last and self._last[0] == key and now - self._last[1] < PROGRESS_TIMEOUT:
                # The acknowledgement was lost and the command came again: the motor has run already.
                text = f"Motor test: repeated too soon, wait {PROGRESS_TIMEOUT:g} s"
                self._texts.reply(request, Severity.NOTICE, text, now)
                return Result.ACCEPTED
            description = f"{self._motors[test.motor]} at {test.throttle:+.0%} for {test.time:g} s"
            self._texts.send_change(Severity.WARNING, f"Motor test: {description}, by GCS {request.system}", now)
        elif (self._run.request.system, self._run.test.motor) != (request.system, test.motor):
            return Result.TEMPORARILY_REJECTED
        self._last = (key, now)
        self._number += 1
        motor_test = MotorTest(self._number, test.motor, clamp(test.throttle, self._params["MOT_TEST_MAX"] / 100))
        self._run = ActiveTest(motor_test, request, now + test.time, now, self._safety.mode_generation)
        return Result.ACCEPTED


def _parse_motor_test(request: CommandRequest) -> ActuatorTestRequest | None:
    """1: motor from 1, 2: MOTOR_TEST_THROTTLE_TYPE, 3: percent, 4: s, 5: number of motors in sequence, 1 at most."""
    instance, kind, percent, seconds, count = request.params[:5]
    if (
        kind != THROTTLE_PERCENT
        or count not in (0, 1)
        or not math.isfinite(percent)
        or not 0.0 < seconds <= MOTOR_TEST_TIME_MAX
    ):
        return None
    return _build_request(instance, percent / 100, seconds)


def _parse_actuator_test(request: CommandRequest) -> ActuatorTestRequest | None:
    """1: -1..1, NaN stops, 2: s, 0 stops, 5: motor from 1 (ACTUATOR_OUTPUT_FUNCTION_MOTOR1)."""
    value, seconds, function = request.params[0], request.params[1], request.params[4]
    if not 0.0 <= seconds <= MOTOR_TEST_TIME_MAX or math.isinf(value):
        return None
    return _build_request(function, 0.0 if math.isnan(value) else value, 0.0 if math.isnan(value) else seconds)


def _build_request(number: float, throttle: float, seconds: float) -> ActuatorTestRequest | None:
    whole = math.isfinite(number) and number == int(number)
    return ActuatorTestRequest(int(number) - 1, throttle, seconds) if whole else None
