"""What the wheels say of the motion, for the estimator, and how far their scale is off, which GPS speed teaches."""

from __future__ import annotations

from collections.abc import Sequence

from vehicle.navigation.dead_reckoning import AveragingGain
from vehicle.readings import Readings

SCALE_TIME = 120.0
"""s of straight driving until the scale of the wheels is learned."""
SCALE_CREDIT = 25
"""Courses that the wheels' own word is worth: 5 s, or the first one would change it by 7 %."""
SCALE_MAX = 0.2
"""Wheels that are off by more slip, or are set wrongly: SPEED_MAX is for that."""
FASTEST = 50.0
"""m/s; more is no speed of a rover's wheel."""


class WheelOdometry:
    """Readings in, m/s out."""

    def __init__(self, aside: Sequence[float] = ()) -> None:
        """`aside`: what a motion to the right gives to each wheel, of a drive that can (vehicle/drive/mixer.py, FOUR_WHEELS)."""
        self._aside = tuple(aside)
        self._scale = 1.0
        self._gain = AveragingGain(SCALE_TIME, SCALE_CREDIT)

    def speed(self, readings: Readings) -> float | None:
        """Along the nose; None where it is not measured."""
        return self._sane(readings.speed)

    def sideways_speed(self, readings: Readings) -> float | None:
        """To the right; None where it is not measured: that takes an encoder on each wheel."""
        if not self._aside:
            return 0.0
        wheels = readings.wheel_speeds
        if len(wheels) != len(self._aside):
            return None
        return self._sane(sum(wheel * part for wheel, part in zip(wheels, self._aside, strict=True)) / len(wheels))

    def update_scale(self, along: float, speed: float, period: float) -> float:
        """GPS says `along` where the wheels say `speed`, once each `period` s. The factor of their new scale."""
        before = self._scale
        scale = before + (along - speed) / speed * before * self._gain.next(period)
        self._scale = max(1.0 - SCALE_MAX, min(1.0 + SCALE_MAX, scale))
        return self._scale / before

    def _sane(self, speed: float | None) -> float | None:
        return speed * self._scale if speed is not None and -FASTEST <= speed <= FASTEST else None
