"""From a demand to motor values: dead band, expo, limits, mixer, ramps, gate. Who may drive is not decided here."""

from __future__ import annotations

from dialects.enums import DriveType, Limit
from vehicle.demand import Demand
from vehicle.mixer import MIXERS, Mixed, clamp, deadband, expo
from vehicle.outputs import Clearance, Gate, Outputs, Permit, Trial
from vehicle.params import Params
from vehicle.slew import Slew, SlewLimits

HALF = 0.5
"""Largest throttle while a failsafe limits the speed (vehicle.md, battery low)."""


class Drive:
    """The motors' side of the rover. Ramps are per motor, so that a stop makes every motor's value fall from the first
    cycle on; ramps before the mixer would leave a saturated motor at full for a while."""

    def __init__(self, params: Params, now: float) -> None:
        self.kind = DriveType(int(params["DRIVE_TYPE"]))
        self.mixer = MIXERS[self.kind]
        self.limits = Limit(0)
        """Why the outputs differ from the demand, as far as this side knows."""
        self.outputs = Outputs((0.0,) * len(self.mixer.motors), enabled=False)
        self._params = params
        self._slews = [Slew() for _ in self.mixer.motors]
        self._gate = Gate(len(self._slews))
        self._tested: int | None = None
        """The motor that a test turns."""
        self._at = now

    @property
    def refused(self) -> int:
        """Cycles in a row in which the gate got values that are no values."""
        return self._gate.refused

    def step(self, demand: Demand | None, clearance: Clearance, *, limited: bool, now: float) -> Outputs:
        """The outputs of this moment. `limited`: a failsafe asks for half speed."""
        permit = clearance.permit
        dt, self._at = max(0.0, now - self._at), now
        self.limits = Limit(0)
        trial = clearance.trial if permit is Permit.TEST else None
        motor = None if trial is None else trial.motor
        if permit is Permit.NONE or motor != self._tested:  # no test ramps down, nor into another one or a drive
            for slew in self._slews:
                slew.reset()
        self._tested = motor
        ramps = self._ramps()
        targets = self._targets(demand if permit is Permit.DRIVE else None, limited) if trial is None else (
            self._alone(trial))  # fmt: skip
        values = [slew.step(target, dt, ramps) for slew, target in zip(self._slews, targets, strict=True)]
        self._note_limits()
        self.outputs = self._gate.judge(values, permit, 1.0 / ramps.decel, now, trial)
        if self.outputs.throttles != tuple(values):  # refused: no ramp goes on from there
            for slew in self._slews:
                slew.reset()
        return self.outputs

    def _targets(self, demand: Demand | None, limited: bool) -> tuple[float, ...]:
        if demand is None:
            return (0.0,) * len(self._slews)
        throttle, steering, sideways = shape(demand, self._params)
        throttle, sideways = self._cap(throttle, limited), self._cap(sideways, limited)
        mixed: Mixed = self.mixer.mix(throttle, steering, self._params["MOT_STR_THR_MIX"], sideways)
        if mixed.saturated:
            self.limits |= Limit.SATURATED
        return mixed.throttles

    def _alone(self, trial: Trial) -> tuple[float, ...]:
        """One motor, the others at rest."""
        return tuple(trial.throttle if index == trial.motor else 0.0 for index in range(len(self._slews)))

    def _cap(self, throttle: float, limited: bool) -> float:
        largest = self._params["MOT_THR_MAX"] / 100
        if limited:
            largest = min(largest, HALF)
        if abs(throttle) > largest:
            self.limits |= Limit.SPEED
        return clamp(throttle, largest)

    def _ramps(self) -> SlewLimits:
        params = self._params
        return SlewLimits(params["MOT_SLEWRATE"] / 100, params["MOT_DECEL"] / 100, params["MOT_REV_DELAY"])

    def _note_limits(self) -> None:
        if any(slew.limited for slew in self._slews):
            self.limits |= Limit.SLEW
        if any(slew.waiting for slew in self._slews):
            self.limits |= Limit.REVERSE_DELAY


def shape(demand: Demand, params: Params) -> tuple[float, float, float]:
    """Throttle, steering and sideways as the driver means them: dead band and softness."""
    throttle, steering, sideways = demand.throttle or 0.0, demand.steering or 0.0, demand.sideways or 0.0
    if demand.direct:
        return throttle, steering, sideways
    band = params["MAN_DEADBAND"] / 100
    return (
        expo(deadband(throttle, band), params["MANUAL_EXPO"]),
        expo(deadband(steering, band), params["MANUAL_STR_EXPO"]),
        deadband(sideways, band),
    )
