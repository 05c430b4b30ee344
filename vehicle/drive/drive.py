"""From a demand to motor values: dead band, expo, limits, mixer, ramps, scaling and the last gate."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from dialects.enums import DriveLimit, DriveType
from vehicle.drive.demand import Demand
from vehicle.drive.gate import DRIVE, NONE, TEST, Clearance, Gate, MotorTest, Outputs
from vehicle.drive.mixer import FOUR_WHEELS, MIXERS, MixerLimits, clamp, deadband, expo, pivot_scale
from vehicle.drive.output_scaling import build_output_scaling, is_unscaled, scale_outputs
from vehicle.drive.slew import Slew, SlewLimits
from vehicle.params import Params

ShareOfWheels = Callable[[Sequence[float], Sequence[float]], tuple[float, int]]
"""Takes wanted and present values of the wheels; returns the allowed share of the wanted ones, and a DriveLimit."""
SATURATED, SPEED, SLEW, REVERSE_DELAY, FRESHNESS = (
    each.value
    for each in (
        DriveLimit.SATURATED, DriveLimit.SPEED, DriveLimit.SLEW, DriveLimit.REVERSE_DELAY, DriveLimit.FRESHNESS
    )
)  # fmt: skip
"""Flags as plain numbers: adding IntFlags costs a microsecond each, and a demand shall reach the motors within 30."""
LIMITED_THROTTLE_MAX = 0.5
"""Largest throttle while a failsafe limits the speed (docs/safety.md, battery low)."""


class Drive:
    """The motor outputs, updated with each demand and in each cycle.

    Ramps are per motor, so that after a stop every motor's value falls from the first cycle on. Ramps before the mixer
    would leave a saturated motor at full for a while.
    """

    def __init__(self, params: Params, now: float) -> None:
        self.kind = DriveType(int(params["DRIVE_TYPE"]))
        self.mixer = MIXERS[self.kind]
        self._limits = 0
        self.outputs = Outputs((0.0,) * len(self.mixer.motors), enabled=False)
        self._params = params
        self._slews = [Slew() for _ in self.mixer.motors]
        self._driven = self.mixer.driven_count
        self.avoiding_speed = math.inf
        """m/s that are allowed before obstacles now; infinite while nothing is limited."""
        self._gate = Gate(len(self._slews), self._driven)
        self._load_params()
        self._wanted: tuple[object, ...] = ()
        """What the wanted values of the wheels were computed of last, and what came out, with the limits."""
        self._wheels_wanted: tuple[tuple[float, ...], int] = (), 0
        self._tested: int | None = None
        """Index of the motor that a motor test turns, or None."""
        self._at = now

    @property
    def limits(self) -> DriveLimit:
        """Why the outputs differ from the demand, as far as this module limits them."""
        return DriveLimit(self._limits)

    @property
    def wheels(self) -> tuple[float, ...]:
        """Value of each wheel now, -1..1, positive forward or to the right.

        The motor values in `outputs` differ by the wiring of the motors.
        """
        return self._gate.wheels

    @property
    def driven_wheels(self) -> tuple[float, ...]:
        """The values of the wheels that are driven, without a steering servo."""
        return self._gate.wheels[: self._driven]

    @property
    def rejected_cycles(self) -> int:
        """Cycles in a row in which the gate rejected the values."""
        return self._gate.refused

    @property
    def travel(self) -> float:
        """Share of the top speed at which the wheels shall move the rover now, whatever the direction."""
        return self._travel_of(self._gate.wheels)

    def _travel_of(self, wheels: Sequence[float]) -> float:
        if self._driven < len(wheels):
            return abs(wheels[0])
        ahead = sum(wheels) / len(wheels)
        return math.hypot(ahead, sum(self._aside(wheels))) if self.mixer.sideways else abs(ahead)

    def update(
        self, demand: Demand | None, clearance: Clearance, *, limited: bool, now: float, fresh_speed: float = math.inf,
        avoid: ShareOfWheels | None = None,
    ) -> Outputs:  # fmt: skip
        """Return the outputs of this moment.

        `limited`: a failsafe limits the throttle to one half. `fresh_speed`: m/s that the age of the commands allows.
        `avoid` limits the wheels before obstacles.
        """
        permit = clearance.permit
        dt, self._at = max(0.0, now - self._at), now
        self._limits = 0
        if self._params_generation != self._params.generation:
            self._load_params()
        trial = clearance.motor_test if permit is TEST else None
        motor = None if trial is None else trial.motor
        if permit is NONE or motor != self._tested:  # a motor test ends without a ramp
            for slew in self._slews:
                slew.reset()
        self._tested = motor
        wanted = demand if permit is DRIVE else None
        if trial is None:
            targets = self._avoiding(self._targets(wanted, limited, fresh_speed), avoid)
        else:
            targets = self._tested_motor(trial)
        wheels = self._ramped(targets, dt)
        motors = wheels if self._unscaled else scale_outputs(wheels, self._driven, self._scalings)
        self.outputs = self._gate.filter(wheels, motors, permit, self._fall_time, now, trial)
        if self.wheels != wheels:  # rejected: no ramp continues from there
            for slew in self._slews:
                slew.reset()
        return self.outputs

    def _targets(self, demand: Demand | None, limited: bool, fresh_speed: float) -> tuple[float, ...]:
        if demand is None:
            return (0.0,) * len(self._slews)
        fresh = fresh_speed / self._top
        asked = demand.axes, demand.direct, limited, fresh
        if asked != self._wanted:  # a demand is repeated 20 times a second, and used in each cycle
            self._wheels_wanted = self._mixed(demand, limited, fresh), self._limits
            self._wanted = asked
        wheels, self._limits = self._wheels_wanted
        return wheels

    def _mixed(self, demand: Demand, limited: bool, fresh: float) -> tuple[float, ...]:
        throttle, steering, sideways = shape_demand(demand, self._params)
        largest = min(self._largest, LIMITED_THROTTLE_MAX) if limited else self._largest
        if math.hypot(throttle, sideways) > fresh:
            self._limits |= FRESHNESS
            share = fresh / math.hypot(throttle, sideways)
            throttle, sideways = throttle * share, sideways * share
        if abs(throttle) > largest or abs(sideways) > largest:
            self._limits |= SPEED
            throttle, sideways = clamp(throttle, largest), clamp(sideways, largest)
        mixed = self.mixer.mix(throttle, steering, sideways, self._at_limit)
        if mixed.saturated:
            self._limits |= SATURATED
        if self._driven < len(self._slews):
            return mixed.throttles
        if self._pivot == 1.0 and not sideways:  # a share of one; one that is not a number must spoil all values
            return mixed.throttles
        share = pivot_scale(throttle, steering, sideways, self._pivot)
        return tuple([share * value for value in mixed.throttles])

    def _avoiding(self, targets: tuple[float, ...], avoid: ShareOfWheels | None) -> tuple[float, ...]:
        """Return the wanted values, made smaller before obstacles: never larger, and never in another direction."""
        self.avoiding_speed = math.inf
        if avoid is None or not any(targets):
            return targets
        share, reason = avoid(targets, self._gate.wheels)
        if share >= 1.0:
            return targets
        self._limits |= reason
        share = max(0.0, share)  # 0 of a share that is not a number; a target that is not one goes on to the gate
        slower = tuple(share * value if at < self._driven else value for at, value in enumerate(targets))
        self.avoiding_speed = self._travel_of(slower) * self._top
        return slower

    @staticmethod
    def _aside(wheels: Sequence[float]) -> list[float]:
        """Return the share of each wheel in the motion to the right."""
        return [wheel * side / len(wheels) for wheel, (_, _, side) in zip(wheels, FOUR_WHEELS, strict=True)]

    def _tested_motor(self, trial: MotorTest) -> tuple[float, ...]:
        """Return the throttle of the tested motor and zero for the others."""
        return tuple(trial.throttle if index == trial.motor else 0.0 for index in range(len(self._slews)))

    def _ramped(self, targets: Sequence[float], dt: float) -> tuple[float, ...]:
        wheels = []
        for slew, target, rates in zip(self._slews, targets, self._rates, strict=True):
            wheels.append(slew.step(target, dt, rates))
            if slew.limited:
                self._limits |= SLEW
            if slew.waiting:
                self._limits |= REVERSE_DELAY
        return tuple(wheels)

    def _load_params(self) -> None:
        """Cache what depends on parameters, until one of them changes."""
        params, self._params_generation = self._params, self._params.generation
        self._wanted = ()
        self._top = params["SPEED_MAX"]
        self._scalings = build_output_scaling(params)
        self._unscaled = self._driven == len(self._slews) and is_unscaled(self._driven, self._scalings)
        self._largest, self._pivot = params["MOT_THR_MAX"] / 100, params["MOT_PIVOT_MAX"] / 100
        self._fall_time = 100 / params["MOT_DECEL"]
        self._at_limit = MixerLimits(params["MOT_STR_THR_MIX"], params["MOT_THST_ASYM"])
        accel, decel = params["MOT_SLEWRATE"] / 100, params["MOT_DECEL"] / 100
        wheel = SlewLimits(accel, decel, params["MOT_REV_DELAY"])
        servo = SlewLimits(accel, decel)  # a servo may reverse at once, and a delay would delay the turn
        self._rates = [wheel if at < self._driven else servo for at in range(len(self._slews))]


def shape_demand(demand: Demand, params: Params) -> tuple[float, float, float]:
    """Return throttle, steering and sideways after dead band and expo."""
    throttle, steering, sideways = demand.throttle or 0.0, demand.steering or 0.0, demand.sideways or 0.0
    if demand.direct:
        return throttle, steering, sideways
    band, softness = params["MAN_DEADBAND"] / 100, params["MANUAL_EXPO"]
    steered = params["MANUAL_STR_EXPO"]
    throttle, steering = deadband(throttle, band), deadband(steering, band)
    return (
        expo(throttle, softness) if softness else throttle,
        expo(steering, steered) if steered else steering,
        expo(deadband(sideways, band), softness) if sideways else 0.0,
    )
