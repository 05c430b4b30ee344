"""Wheel odometry for the estimator, with a wheel scale that is learned from the GPS speed."""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.navigation.dead_reckoning import AveragingGain
from vehicle.readings import Readings

SCALE_TIME = 120.0
"""s of straight driving until the scale of the wheels is learned."""
SCALE_CREDIT = 25
"""Measurements that the initial scale is worth: 5 s, or else the first one would change the scale by 7 %."""
SCALE_MAX = 0.2
"""Largest correction; wheels that are off by more slip, or SPEED_MAX is wrong."""
FASTEST = 50.0
"""m/s; a larger value is not the speed of a rover's wheel."""


class WheelOdometry:
    """Speeds in m/s from readings."""

    def __init__(self, aside: Sequence[float] = ()) -> None:
        """Create the odometry.

        `aside`: factor of each wheel for motion to the right, if the drive can (vehicle/drive/mixer.py, FOUR_WHEELS).
        """
        self._aside = tuple(aside)
        self._scale = 1.0
        self._gain = AveragingGain(SCALE_TIME, SCALE_CREDIT)

    def speed(self, readings: Readings) -> float | None:
        """Return the m/s forward; None if not measured."""
        return self._scaled(readings.speed)

    def sideways_speed(self, readings: Readings) -> float | None:
        """Return the m/s to the right; None if not measured, which takes an encoder on each wheel."""
        if not self._aside:
            return 0.0
        wheels = readings.wheel_speeds
        if len(wheels) != len(self._aside):
            return None
        return self._scaled(sum(wheel * part for wheel, part in zip(wheels, self._aside, strict=True)) / len(wheels))

    def update_scale(self, along: float, speed: float, period: float) -> float:
        """Correct the scale and return the factor of the change.

        The GPS measures `along`, the wheels `speed`, once each `period` s.
        """
        before = self._scale
        scale = before + (along - speed) / speed * before * self._gain.next(period)
        self._scale = max(1.0 - SCALE_MAX, min(1.0 + SCALE_MAX, scale))
        return self._scale / before

    def _scaled(self, speed: float | None) -> float | None:
        return speed * self._scale if speed is not None and -FASTEST <= speed <= FASTEST else None
