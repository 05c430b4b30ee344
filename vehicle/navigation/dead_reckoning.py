"""Dead reckoning: a position made of small steps, pulled to fixes, and corrected afterwards.

Heading and wheel scale are learned while the rover drives, when a part of the position is already made with wrong
values: 1 degree is 0.7 m after 40 m. That part is known, so that each learned correction is applied to it, too; the
covariance of a Kalman filter has the same effect.
"""

from __future__ import annotations

import math

from vehicle.navigation.geo import Point


class AveragingGain:
    """Gain of the n-th measurement: a mean at first, settling at a time constant of `time` s.

    The initial value is worth `credit` measurements.
    """

    def __init__(self, time: float, credit: int = 0) -> None:
        self.time = time
        self._count = credit

    def next(self, dt: float) -> float:
        """Return the gain of the next measurement, `dt` s after the one before."""
        self._count += 1
        return max(1.0 / self._count, dt / (self.time + dt))


class DeadReckoning:
    """A position, and the part of it that was driven and that no fix has replaced yet. m, rad."""

    def __init__(self) -> None:
        self.north = self.east = 0.0
        self._driven_north = self._driven_east = 0.0

    @property
    def place(self) -> Point:
        """The position."""
        return Point(self.north, self.east)

    def set_position(self, place: Point) -> None:
        """Set the position in relation to a new origin; the rover has not moved."""
        self.north, self.east = place

    def advance(self, way: float, yaw: float) -> None:
        """Add a distance of `way` m along `yaw`."""
        north, east = way * math.cos(yaw), way * math.sin(yaw)
        self.north += north
        self.east += east
        self._driven_north += north
        self._driven_east += east

    def correct_position(self, north: float, east: float, gain: float) -> None:
        """Move the position toward a fix that is off by `north` and `east` m, by `gain`, 0..1."""
        self.north += gain * north
        self.east += gain * east
        self._driven_north *= 1.0 - gain
        self._driven_east *= 1.0 - gain

    def correct_heading(self, angle: float) -> None:
        """Turn the driven part by a small `angle`, the error of the heading so far."""
        self._correct(-angle * self._driven_east, angle * self._driven_north)

    def correct_scale(self, factor: float) -> None:
        """Scale the driven part by `factor`, the error of the wheels so far."""
        self._correct((factor - 1.0) * self._driven_north, (factor - 1.0) * self._driven_east)

    def _correct(self, north: float, east: float) -> None:
        self.north += north
        self.east += east
        self._driven_north += north
        self._driven_east += east
