"""The rover joined to its body: sensors in, motors out, each cycle and on each message; no input or output of its own.

It is a core like the rover inside it, so tests drive it in virtual time. Its rules:
what the rover decides on arrival of a message goes to the motors before `receive` returns, and not at the next tick;
a motor driver that fails is stopped first and told to the rover after;
the emergency stop beside the motors is asked each cycle, and one that cannot be read is open;
an exception of any kind stops the motors before it goes on;
once closed, nothing turns again, whatever the rover still says.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import Protocol

from link.core import Core, LinkReport, Outgoing, Received
from vehicle.drive.gate import Outputs
from vehicle.motors import MotorError, Motors, StopPressedError
from vehicle.readings import Readings
from vehicle.sensors import Sensors

MOTOR_RETRY_TIME = 1.0
"""s after a motor failure until the motors are tried again, standing still: a driver that lost its bus for a moment may
come back, and one that did not must not be asked so often that the bus stays busy."""


class Controller(Core, Protocol):
    """What decides; vehicle.rover.Rover is one."""

    @property
    def outputs(self) -> Outputs:
        """What the motors must get now."""

    def sense(self, readings: Readings, now: float) -> None:
        """Take what the sensors say, each cycle before the tick."""

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """Why the emergency stop beside the motors stops them, or None while it is closed; each cycle before the tick.

        Also at once where the motors refuse because of it; they are stopped already then.
        """

    def motor_failed(self, reason: str, now: float) -> None:
        """The motors did not take their outputs and are stopped."""

    def motor_repaired(self, now: float) -> None:
        """The motors, still stopped, obey again."""

    def shutdown(self, now: float) -> None:
        """Prepare the last messages; the motors are stopped already."""


class Drivetrain:
    """Motors that follow Outputs: powered and written when something changes, without power after any failure."""

    def __init__(self, motors: Motors, prove: Callable[[], None]) -> None:
        self.prove = prove
        """Raises MotorError as long as the motors must not be armed."""
        self._motors = motors
        self._neutral = (0.0,) * motors.count
        self._powered = False
        self._written: tuple[float, ...] | None = None

    def follow(self, outputs: Outputs, *, refresh: bool) -> None:
        """Bring the motors to `outputs`; with `refresh` even unchanged ones. Raises MotorError; then they stand."""
        try:
            if outputs.enabled:
                self._power()
                self._write(outputs.throttles, refresh=refresh)
            elif self._powered:
                self._unpower()
        except MotorError:
            self._stop()
            raise

    def self_test(self) -> None:
        """Write neutral to motors without power. Raises MotorError."""
        self._unpower()
        self.prove()
        self._motors.set(self._neutral)

    def close(self) -> None:
        """Neutral, disabled, let go; each step is tried even where the one before raised.

        Raises what `disable` or `close` raise: then the motors may still turn. A driver that does not even take neutral
        any more is no matter as long as it gives up the power.
        """
        with contextlib.ExitStack() as steps:  # last in, first out
            steps.callback(self._motors.close)
            steps.callback(self._motors.disable)
            with contextlib.suppress(Exception):
                self._motors.set(self._neutral)

    def _power(self) -> None:
        if not self._powered:
            self._motors.enable()
            self._powered, self._written = True, None

    def _unpower(self) -> None:
        self._motors.disable()
        self._powered, self._written = False, None

    def _write(self, throttles: tuple[float, ...], *, refresh: bool) -> None:
        if refresh or throttles != self._written:
            self._motors.set(throttles)
            self._written = throttles

    def _stop(self) -> None:
        """After a failure. Where even this fails they count as powered, so that each cycle tries again."""
        self._powered, self._written = True, None
        with contextlib.suppress(MotorError):
            self._unpower()


class ControlLoop:
    """A `link.core.Core` that owns its motors."""

    def __init__(
        self,
        mind: Controller,
        motors: Motors,
        sensors: Sensors,
        *,
        stop_input: Callable[[], str | None] = lambda: None,
        prove: Callable[[], None] = lambda: None,
        completed: Callable[[float], None] = lambda now: None,
    ) -> None:
        """`stop_input` asks the emergency stop beside the motors (vehicle.motors.stop_input), `prove` if they may be
        armed (vehicle.motors.proof); `completed` is told the time of each control cycle that came to its end, down to
        the motors.

        Raises MotorError where the driver has another number of motors than the rover's kind of drive.
        """
        wanted = len(mind.outputs.throttles)
        if motors.count != wanted:
            raise MotorError(f"the motor driver has {motors.count} motors, this drive needs {wanted}")
        self._mind = mind
        self._drivetrain = Drivetrain(motors, prove)
        self._proven = False
        self._sensors = sensors
        self._stop_input = stop_input
        self._completed = completed
        self._retry_due: float | None = None
        self._closed = False

    def receive(self, received: Received, now: float) -> None:
        """Act on one message, down to the motors."""
        self._guard(lambda: self._mind.receive(received, now), now)

    def tick(self, now: float) -> None:
        """One control cycle: sense, decide, drive.

        Motors with power are written each cycle, changed or not: a driver with a timeout of its own then stops by
        itself when the cycles end.
        """
        self._guard(lambda: self._cycle(now), now, refresh=True)
        if not self._closed:
            self._completed(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Act on what the links say of themselves."""
        self._guard(lambda: self._mind.observe(reports, now), now)

    def messages_to_send(self) -> list[Outgoing]:
        """What the rover says; empties what it returns."""
        try:
            return self._mind.messages_to_send()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop the motors for good. May come twice. Raises where they may still turn, after every step was tried."""
        if not self._closed:
            self._closed = True
            self._drivetrain.close()

    def shutdown(self, now: float) -> None:
        """Close, then let the rover prepare its last messages."""
        try:
            self.close()
        finally:
            self._mind.shutdown(now)

    def abort(self, error: BaseException, now: float) -> None:
        """Shut down because of `error`, which goes on after this: it gets a note where the motors may still turn."""
        if self._closed:
            return
        try:
            self.shutdown(now)
        except Exception as second:
            error.add_note(f"while stopping: {second!r}")

    def _guard(self, decide: Callable[[], None], now: float, *, refresh: bool = False) -> None:
        try:
            decide()
            self._drive(now, refresh=refresh)
        except BaseException as error:
            self.abort(error, now)
            raise

    def _cycle(self, now: float) -> None:
        self._mind.update_estop_input(self._stop_reason(), now)
        self._mind.sense(self._sensors.read(now), now)
        self._mind.tick(now)
        if not self._proven:
            self._prove(now)
        if self._retry_due is not None and now >= self._retry_due and not self._closed:
            self._retry(now)

    def _prove(self, now: float) -> None:
        """Once, in the first cycle; then it belongs to the test after each failure."""
        self._proven = True
        try:
            self._drivetrain.prove()
        except MotorError as error:
            self._handle_motor_failure(str(error), now)

    def _handle_motor_failure(self, reason: str, now: float) -> None:
        self._retry_due = now + MOTOR_RETRY_TIME
        self._mind.motor_failed(reason, now)

    def _stop_reason(self) -> str | None:
        try:
            return self._stop_input()
        except MotorError as error:
            return str(error)

    def _drive(self, now: float, *, refresh: bool) -> None:
        if self._closed:
            return
        try:
            self._drivetrain.follow(self._mind.outputs, refresh=refresh)
        except StopPressedError as error:  # pressed since this cycle asked
            self._mind.update_estop_input(str(error), now)
        except MotorError as error:
            if self._retry_due is None:  # told once, not each cycle until it is repaired
                self._handle_motor_failure(str(error), now)

    def _retry(self, now: float) -> None:
        try:
            self._drivetrain.self_test()
        except MotorError:
            self._retry_due = now + MOTOR_RETRY_TIME
        else:
            self._retry_due = None
            self._mind.motor_repaired(now)
