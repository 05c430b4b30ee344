"""Runs the controller against real or simulated motors and sensors, and stops the motors on any error.

It is a core like the rover inside it, so that tests run it in virtual time. Its rules:
- what the rover decides when a message arrives is written to the motors before `receive` returns, not at the next tick;
- a motor driver that fails is stopped first, and reported to the rover after that;
- the emergency-stop input is read and the motors are written each cycle, and an input that cannot be read counts as
  pressed; sensors and all that follows from them may be left out in a short cycle (Controller.tick_outputs);
- while no motor has power cycles may be left out (`rest_period`), but not before a message that may need them;
- an exception of any kind stops the motors before it propagates;
- once closed, no motor turns again, whatever the outputs of the rover are.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from typing import Protocol

from link.core import Core, LinkReport, Outgoing, Peer, PeerReservation, Received, TimeTeller
from vehicle.drive.gate import Outputs
from vehicle.motors import MotorError, Motors, StopPressedError
from vehicle.readings import Readings
from vehicle.sensors import Sensors

CYCLE = 0.02
"""s between two cycles, unless the controller rests: 50 Hz is the rate of servos and motor controllers of this size."""
MOTOR_RETRY_TIME = 1.0
"""s after a motor failure until the motors are tested again, at neutral: a driver may recover from a short loss of its
bus, and must not be tried so often that the bus stays busy."""


class Controller(Core, TimeTeller, PeerReservation, Protocol):
    """Decides the motor outputs; vehicle.rover.Rover is one."""

    @property
    def outputs(self) -> Outputs:
        """The outputs that the motors must get now."""

    def sense(self, readings: Readings, now: float) -> None:
        """Store the readings of the sensors, each cycle before the tick."""

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """Set why the emergency-stop input stops the motors, or None while it is closed; each cycle before the tick.

        Also called at once if the motors refuse outputs because of it; they are stopped by then.
        """

    def motor_failed(self, reason: str, now: float) -> None:
        """Handle a failure of the motors, which are stopped by now."""

    def motor_repaired(self, now: float) -> None:
        """Handle a motor driver that works again; the motors are still stopped."""

    def tick_outputs(self, now: float, *, powered: bool) -> bool:
        """Bring the outputs up to date and return True if `sense` and `tick` can wait for a later cycle.

        False: nothing was done, and this cycle is a whole one. `powered`: the motors have power, or may have it.
        """

    def rest_period(self, now: float) -> float | None:
        """Return the s between cycles that are enough until the next message, as long as no motor has power.

        None: all cycles are needed.
        """

    def shutdown(self, now: float) -> None:
        """Queue the last messages; the motors are stopped by now."""


class Drivetrain:
    """Writes Outputs to the motors: enabled and written when something changes, disabled after any failure."""

    def __init__(self, motors: Motors, prove: Callable[[], None]) -> None:
        self.prove = prove
        """Raises MotorError while the motors must not be armed."""
        self._motors = motors
        self._neutral = (0.0,) * motors.count
        self._powered = False
        self._written: tuple[float, ...] | None = None

    def follow(self, outputs: Outputs, *, refresh: bool) -> None:
        """Write `outputs`, with `refresh` even if unchanged. Raises MotorError after stopping the motors."""
        try:
            if outputs.enabled:
                self._power()
                self._write(outputs.throttles, refresh=refresh)
            elif self._powered:
                self._unpower()
        except MotorError:
            self._stop()
            raise

    @property
    def powered(self) -> bool:
        """Whether the motors have power, or may have it."""
        return self._powered

    def self_test(self) -> None:
        """Write neutral to disabled motors. Raises MotorError."""
        self._unpower()
        self.prove()
        self._motors.set(self._neutral)

    def close(self) -> None:
        """Set neutral, disable and close the motors; each step is tried even if the one before raised.

        Raises what `disable` or `close` raise: the motors may still turn then. A failure to set neutral is ignored,
        because disabled motors do not turn.
        """
        with contextlib.ExitStack() as steps:  # runs last in, first out
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
        """Disable the motors after a failure. If that fails they count as enabled, so that each cycle tries again."""
        self._powered, self._written = True, None
        with contextlib.suppress(MotorError):
            self._unpower()


class ControlLoop:
    """A `link.core.Core` that owns the motors."""

    def __init__(
        self,
        controller: Controller,
        motors: Motors,
        sensors: Sensors,
        *,
        stop_input: Callable[[], str | None] = lambda: None,
        prove: Callable[[], None] = lambda: None,
        completed: Callable[[float], None] = lambda now: None,
    ) -> None:
        """Check that the driver has as many motors as the DRIVE_TYPE of the rover, or raise MotorError.

        `stop_input` reads the emergency-stop input (vehicle.motors.estop_reader), `prove` checks that the motors may be
        armed (vehicle.motors.arming_check). `completed` is called with the time of each whole control cycle after the
        motors are written.
        """
        needed = len(controller.outputs.throttles)
        if motors.count != needed:
            raise MotorError(f"the motor driver has {motors.count} motors, this drive needs {needed}")
        self._controller = controller
        self._drivetrain = Drivetrain(motors, prove)
        self._proven = False
        self._sensors = sensors
        self._stop_input = stop_input
        self._completed = completed
        self._retry_due: float | None = None
        self._whole = True
        """Whether the newest cycle was a whole one."""
        self._cycled = 0.0
        """Time of the newest cycle."""
        self._closed = False

    @property
    def rest_period(self) -> float | None:
        """Time between cycles, s, that is enough until the next message; None: a motor has power, or there is work."""
        if self._drivetrain.powered or self._retry_due is not None:
            return None
        return self._controller.rest_period(self._cycled)

    @property
    def reserved_ids(self) -> tuple[int, int] | None:
        """Ids of the ground station in control, for which each link keeps places."""
        return self._controller.reserved_ids

    def tell_time(self, peer: Peer, now: float) -> None:
        """Answer a sender who signs with a wrong time with a HEARTBEAT."""
        self._guard(lambda: self._controller.tell_time(peer, now), now)

    def receive(self, received: Received, now: float) -> None:
        """Act on one message, down to the motors. A cycle that a rest has left out comes before it."""
        pause = now - self._cycled
        # A pause that is longer than the rest is a late cycle, which the controller must see.
        if pause > CYCLE and (rest := self.rest_period) is not None and pause < rest + CYCLE:
            self._guard(lambda: self._cycle(now), now)
        self._guard(lambda: self._controller.receive(received, now), now)

    def tick(self, now: float) -> None:
        """Run one control cycle: read the emergency-stop input and the sensors, decide, write the motors.

        Enabled motors are written each cycle, changed or not: a driver with a timeout of its own stops by itself when
        the cycles end.
        """
        self._guard(lambda: self._cycle(now), now, refresh=True)
        if not self._closed and self._whole:
            self._completed(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the reports of the links."""
        self._guard(lambda: self._controller.observe(reports, now), now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return what the rover sends now and forget it."""
        try:
            return self._controller.messages_to_send()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        """Stop the motors for good. May be called twice. Raises if they may still turn, after trying every step."""
        if not self._closed:
            self._closed = True
            self._drivetrain.close()

    def shutdown(self, now: float) -> None:
        """Close, then let the rover queue its last messages."""
        try:
            self.close()
        finally:
            self._controller.shutdown(now)

    def abort(self, error: BaseException, now: float) -> None:
        """Shut down because of `error`, which propagates after this; it gets a note if the motors may still turn."""
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
        self._cycled = now
        self._controller.update_estop_input(self._stop_reason(), now)
        self._whole = not self._controller.tick_outputs(now, powered=self._drivetrain.powered)
        if self._whole:
            self._controller.sense(self._sensors.read(now), now)
            self._controller.tick(now)
        if not self._proven:
            self._prove(now)
        if self._retry_due is not None and now >= self._retry_due and not self._closed:
            self._retry(now)

    def _prove(self, now: float) -> None:
        """Check once, in the first cycle, that the motors may be armed; the self-test repeats it after a failure."""
        self._proven = True
        try:
            self._drivetrain.prove()
        except MotorError as error:
            self._handle_motor_failure(str(error), now)

    def _handle_motor_failure(self, reason: str, now: float) -> None:
        self._retry_due = now + MOTOR_RETRY_TIME
        self._controller.motor_failed(reason, now)

    def _stop_reason(self) -> str | None:
        try:
            return self._stop_input()
        except MotorError as error:
            return str(error)

    def _drive(self, now: float, *, refresh: bool) -> None:
        if self._closed:
            return
        try:
            self._drivetrain.follow(self._controller.outputs, refresh=refresh)
        except StopPressedError as error:  # pressed after the input was read in this cycle
            self._controller.update_estop_input(str(error), now)
        except MotorError as error:
            if self._retry_due is None:  # reported once, not in each cycle until it is repaired
                self._handle_motor_failure(str(error), now)

    def _retry(self, now: float) -> None:
        try:
            self._drivetrain.self_test()
        except MotorError:
            self._retry_due = now + MOTOR_RETRY_TIME
        else:
            self._retry_due = None
            self._controller.motor_repaired(now)
