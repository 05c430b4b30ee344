"""The last gate before the motors: it refuses what it cannot vouch for, whoever asked for it.

It does not trust the rest of the vehicle: it judges by a few plain facts (Clearance), checks every value, and times
every deceleration and every motor test itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

RAMP_TOLERANCE = 0.05
"""s that a deceleration may take longer than its ramp: two cycles of 20 ms and a little, because it begins in one."""

MOTOR_TEST_THROTTLE_MAX, MOTOR_TEST_TIME_MAX = 0.3, 3.0
"""Throttle and s of a motor test: enough to see a wheel turn, too little to run away with a rover that stands on it.
What the motor gets of it follows its parameters, as when driving."""


class Outputs(NamedTuple):
    """What the motors must get now; made with each demand. `throttles` are -1..1 in motor order: left, right or
    throttle, steering. Each is as its motor is wired (vehicle/drive/output_scaling.py), and all are zero where not enabled."""

    throttles: tuple[float, ...]
    enabled: bool
    """False: the driver's enable line is off too."""


class Permit(Enum):
    """What the motors may do in this cycle."""

    NONE = "none"
    """Zero at once: disarmed, emergency stop, fault, a late cycle."""
    RAMP_DOWN = "fall"
    """Ramp down to zero, nothing else: stale demand, HOLD, failsafe, no neutral seen."""
    DRIVE = "drive"
    """Follow the demand."""
    TEST = "test"
    """Turn one motor, slowly and shortly: the only motion of a vehicle that is not armed."""


@dataclass(frozen=True, slots=True)
class MotorTest:
    """One request to see one motor turn."""

    number: int
    """From 1, larger with each request: the gate gives each its time once."""
    motor: int
    """Its index."""
    throttle: float


class Clearance(NamedTuple):
    """The facts that decide about motion; made with each demand."""

    armed: bool = False
    late: bool = False
    """The control loop was late in this cycle."""
    held: bool = True
    """The mode or a failsafe wants neutral."""
    neutral_seen: bool = False
    demand_age: float | None = None
    """s since the demand in use came from the driver in control; None without one."""
    timeout: float = 0.0
    """s that a demand counts."""
    motor_test: MotorTest | None = None
    """The motor test under way. It means nothing while armed."""

    @property
    def permit(self) -> Permit:
        """Anything unknown or not a number is a no."""
        if self.late:
            return Permit.NONE
        if not self.armed:
            return Permit.NONE if self.motor_test is None else Permit.TEST
        fresh = self.demand_age is not None and 0.0 <= self.demand_age <= self.timeout
        return Permit.DRIVE if fresh and self.neutral_seen and not self.held else Permit.RAMP_DOWN


class Gate:
    """Passes motor values or replaces them by zero. It times what the wheels are to do, and passes what that makes of
    their motors (vehicle/drive/output_scaling.py): a smallest output is a step at zero, which is no stop that takes too long."""

    def __init__(self, motors: int, driven: int | None = None) -> None:
        """`driven` motors, the first ones, turn wheels: all unless told."""
        self.refused = 0
        """Values that were not numbers or out of range, in a row."""
        self.wheels = (0.0,) * motors
        """What the wheels were let do by the last judgement."""
        self._still = self._before = (0.0,) * motors
        self._driven = motors if driven is None else driven
        self._ramp_began: float | None = None
        self._trials = MotorTestTimer()

    def filter(
        self, wheels: Sequence[float], motors: Sequence[float], permit: Permit, fall_time: float, now: float,
        trial: MotorTest | None = None,
    ) -> Outputs:  # fmt: skip
        """What may go to the motors. `fall_time` is the longest a deceleration to zero may take, s; `trial` is what
        TEST is for."""
        self._note_ramp(permit, now)
        fits = self._trials.permits(wheels, trial if permit is Permit.TEST else None, now)
        sound = permit is not Permit.NONE and self._sound(wheels, motors)
        passed = sound and (fits if permit is Permit.TEST else self._falling(wheels, fall_time, now))
        self.wheels = tuple(wheels) if passed else self._still
        self._before = self._still if permit is Permit.TEST else self.wheels  # nothing ramps down from a test
        enabled = passed and (permit in (Permit.DRIVE, Permit.TEST) or any(self.wheels))
        return Outputs(tuple(motors) if enabled else self._still, enabled)

    def _sound(self, wheels: Sequence[float], motors: Sequence[float]) -> bool:
        # NaN fails every comparison, so that it is refused here too.
        count = len(self._still)
        sound = len(wheels) == len(motors) == count
        for value in (*wheels, *motors):
            sound = sound and -1.0 <= value <= 1.0
        for each in range(self._driven if sound else 0):
            sound = sound and bool(wheels[each] or not motors[each])
        self.refused = 0 if sound else self.refused + 1
        return sound

    def _note_ramp(self, permit: Permit, now: float) -> None:
        if permit is not Permit.RAMP_DOWN:
            self._ramp_began = None
        elif self._ramp_began is None:
            self._ramp_began = now

    def _falling(self, wheels: Sequence[float], fall_time: float, now: float) -> bool:
        if self._ramp_began is None:
            return True
        smaller = all(abs(new) <= abs(old) for new, old in zip(wheels, self._before, strict=True))
        return smaller and (now - self._ramp_began <= fall_time + RAMP_TOLERANCE or not any(wheels))


class MotorTestTimer:
    """The gate's own watch on motor tests: each request is given its time once, and what was interrupted is over."""

    def __init__(self) -> None:
        self._spent = 0
        """Requests up to this number have had their time."""
        self._number = 0
        self._began = 0.0

    def permits(self, wheels: Sequence[float], trial: MotorTest | None, now: float) -> bool:
        """Called in every cycle; None where none is permitted, which ends the one before."""
        if trial is None or trial.number != self._number:
            self._spent, self._number = max(self._spent, self._number), 0
        if trial is None or trial.number <= self._spent:
            return False
        if not self._number:
            self._number, self._began = trial.number, now
        others = any(value for index, value in enumerate(wheels) if index != trial.motor)
        slow = all(abs(value) <= MOTOR_TEST_THROTTLE_MAX for value in wheels)  # false for NaN
        return slow and not others and 0.0 <= now - self._began < MOTOR_TEST_TIME_MAX
