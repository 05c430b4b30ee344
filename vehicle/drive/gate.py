"""The last gate before the motors: rejects every value that is not proven to be allowed.

The gate does not trust the rest of the vehicle: it decides by a few plain facts (Clearance), checks every value, and
times every deceleration and every motor test itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import msgspec

RAMP_TOLERANCE = 0.05
"""s that a deceleration may exceed its ramp: two cycles of 20 ms and a margin, because it begins within a cycle."""

MOTOR_TEST_THROTTLE_MAX, MOTOR_TEST_TIME_MAX = 0.3, 3.0
"""Throttle and s of a motor test: enough to see a wheel turn, too little to run away with a rover that stands on its
wheels. The motor's value follows from its parameters, as when driving."""


class Outputs(NamedTuple):
    """The motor values, computed with each demand.

    `throttles` are -1..1 in motor order (left, right or throttle, steering), converted to the wiring of each motor
    (vehicle/drive/output_scaling.py), and all zero while not enabled.
    """

    throttles: tuple[float, ...]
    enabled: bool
    """If False, the enable line of the motor driver is off, too."""


class Permit(Enum):
    """What the motors may do in this cycle."""

    NONE = "none"
    """Zero at once: disarmed, emergency stop, fault or a late cycle."""
    RAMP_DOWN = "ramp down"
    """Ramp down to zero only: stale demand, HOLD, failsafe or no neutral demand seen."""
    DRIVE = "drive"
    """Follow the demand."""
    TEST = "test"
    """Turn one motor slowly for a short time: the only motion of a vehicle that is not armed."""


NONE, RAMP_DOWN, DRIVE, TEST = Permit
"""Shortcuts for what runs with each demand: a lookup in the enum costs as much as three comparisons."""


class MotorTest(msgspec.Struct, frozen=True):
    """A request to turn one motor."""

    number: int
    """Counts from 1, larger with each request: the gate gives each request its time once."""
    motor: int
    """Index of the motor."""
    throttle: float


class Clearance(NamedTuple):
    """The facts that decide about motion, collected with each demand."""

    armed: bool = False
    late: bool = False
    """The control loop was late in this cycle."""
    held: bool = True
    """The mode or a failsafe requires neutral."""
    neutral_seen: bool = False
    demand_age: float | None = None
    """s since the demand in use arrived from the ground station in control; None without a demand."""
    timeout: float = 0.0
    """s for which a demand is valid."""
    motor_test: MotorTest | None = None
    """The motor test in progress; ignored while armed."""

    @property
    def permit(self) -> Permit:
        """What the motors may do. A fact that is unknown or not a number forbids motion."""
        if self.late:
            return NONE
        if not self.armed:
            return NONE if self.motor_test is None else TEST
        fresh = self.demand_age is not None and 0.0 <= self.demand_age <= self.timeout
        return DRIVE if fresh and self.neutral_seen and not self.held else RAMP_DOWN


class Gate:
    """Passes motor values or replaces them with zero.

    The gate times the wheel values and passes the motor values made of them (vehicle/drive/output_scaling.py): a
    minimum output is a step to zero, which must not count as a stop that takes too long.
    """

    def __init__(self, motors: int, driven: int | None = None) -> None:
        """Create the gate of `motors` motors, of which the first `driven` turn wheels (default: all)."""
        self.refused = 0
        """Cycles in a row with values that were not numbers or out of range."""
        self.wheels = (0.0,) * motors
        """Wheel values that passed last."""
        self._zero = self._before = (0.0,) * motors
        self._driven = motors if driven is None else driven
        self._ramp_began: float | None = None
        self._test_timer = MotorTestTimer()

    def filter(
        self, wheels: Sequence[float], motors: Sequence[float], permit: Permit, fall_time: float, now: float,
        trial: MotorTest | None = None,
    ) -> Outputs:  # fmt: skip
        """Return what may go to the motors.

        `fall_time` is the longest time of a deceleration to zero, s; `trial` is the motor test that TEST permits.
        """
        self._note_ramp(permit, now)
        test_permitted = self._test_timer.permits(wheels, trial if permit is TEST else None, now)
        valid = permit is not NONE and self._is_valid(wheels, motors)
        passed = valid and (test_permitted if permit is TEST else self._is_falling(wheels, fall_time, now))
        self.wheels = tuple(wheels) if passed else self._zero
        self._before = self._zero if permit is TEST else self.wheels  # no ramp follows a motor test
        enabled = passed and (permit is DRIVE or permit is TEST or any(self.wheels))
        return Outputs(tuple(motors) if enabled else self._zero, enabled)

    def _is_valid(self, wheels: Sequence[float], motors: Sequence[float]) -> bool:
        # NaN fails every comparison, so that it is rejected here, too.
        valid = len(wheels) == len(motors) == len(self._zero)
        for value in wheels:
            valid = valid and -1.0 <= value <= 1.0
        if motors is not wheels:
            for value in motors:
                valid = valid and -1.0 <= value <= 1.0
            for each in range(self._driven if valid else 0):
                valid = valid and bool(wheels[each] or not motors[each])
        self.refused = 0 if valid else self.refused + 1
        return valid

    def _note_ramp(self, permit: Permit, now: float) -> None:
        if permit is not RAMP_DOWN:
            self._ramp_began = None
        elif self._ramp_began is None:
            self._ramp_began = now

    def _is_falling(self, wheels: Sequence[float], fall_time: float, now: float) -> bool:
        if self._ramp_began is None:
            return True
        smaller = all(abs(new) <= abs(old) for new, old in zip(wheels, self._before, strict=True))
        return smaller and (now - self._ramp_began <= fall_time + RAMP_TOLERANCE or not any(wheels))


class MotorTestTimer:
    """The gate's timer of motor tests: each request gets its time once and never resumes."""

    def __init__(self) -> None:
        self._finished = 0
        """Requests up to this number have used their time."""
        self._number = 0
        self._began = 0.0

    def permits(self, wheels: Sequence[float], trial: MotorTest | None, now: float) -> bool:
        """Return True if the motor test may run; call it in every cycle, with None if no test is permitted."""
        if trial is None or trial.number != self._number:
            self._finished, self._number = max(self._finished, self._number), 0
        if trial is None or trial.number <= self._finished:
            return False
        if not self._number:
            self._number, self._began = trial.number, now
        others = any(value for index, value in enumerate(wheels) if index != trial.motor)
        slow = all(abs(value) <= MOTOR_TEST_THROTTLE_MAX for value in wheels)  # false for NaN
        return slow and not others and 0.0 <= now - self._began < MOTOR_TEST_TIME_MAX
