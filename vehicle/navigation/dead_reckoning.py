"""Dead reckoning for the estimator: a place made of small steps, pulled to fixes, corrected for what is learned late.

Heading and wheels are learned while the rover drives, and by then a part of the place was reckoned with wrong ones: 1
degree is 0.7 m after 40 m. That part is known, so what is learned corrects it, too; a Kalman filter's covariance does
the same.
"""

from __future__ import annotations

import math

from vehicle.navigation.geo import Point


class AveragingGain:
    """How much of an error is taken away by the n-th of measurements that come each `dt`: a mean, settling at `time` s.

    What it begins with is worth `credit` measurements.
    """

    def __init__(self, time: float, credit: int = 0) -> None:
        self.time = time
        self._count = credit

    def next(self, dt: float) -> float:
        """Of the next measurement."""
        self._count += 1
        return max(1.0 / self._count, dt / (self.time + dt))


class DeadReckoning:
    """A place, and the part of it that was driven and that no fix has replaced yet. m, rad."""

    def __init__(self) -> None:
        self.north = self.east = 0.0
        self._driven_north = self._driven_east = 0.0

    @property
    def place(self) -> Point:
        """Where we are."""
        return Point(self.north, self.east)

    def set_position(self, place: Point) -> None:
        """Count from elsewhere: it is the same place."""
        self.north, self.east = place

    def advance(self, way: float, yaw: float) -> None:
        """Drive `way` along `yaw`."""
        north, east = way * math.cos(yaw), way * math.sin(yaw)
        self.north += north
        self.east += east
        self._driven_north += north
        self._driven_east += east

    def correct_position(self, north: float, east: float, gain: float) -> None:
        """A fix lies that far off and is believed by `gain`, 0..1."""
        self.north += gain * north
        self.east += gain * east
        self._driven_north *= 1.0 - gain
        self._driven_east *= 1.0 - gain

    def correct_heading(self, angle: float) -> None:
        """It was driven with a heading that was wrong by a small `angle`."""
        self._correct(-angle * self._driven_east, angle * self._driven_north)

    def correct_scale(self, factor: float) -> None:
        """It was driven with wheels that were wrong by `factor`."""
        self._correct((factor - 1.0) * self._driven_north, (factor - 1.0) * self._driven_east)

    def _correct(self, north: float, east: float) -> None:
        self.north += north
        self.east += east
        self._driven_north += north
        self._driven_east += east
