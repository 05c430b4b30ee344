"""What one motor needs to obey like its neighbour: direction, dead zone, largest output; and limits of a known car.

Pure arithmetic on values the rover has decided already. Zero stays zero whatever is set here.
A motor that runs faster than the other gets a smaller `maximum`; the centre of a servo is the trim of its pulse.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated

import msgspec

from vehicle.motors import Motors, MotorSettingsError, checked

Share = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]


class Shape(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """How one motor's throttle becomes its output."""

    reversed: bool = False
    """The motor is wired or mounted the other way round."""
    minimum: Share = 0.0
    """Output of the smallest throttle that is not zero: what the motor needs to turn at all (MOT_THR_MIN)."""
    maximum: Share = 1.0
    """Output of full throttle."""

    def __post_init__(self) -> None:
        if self.minimum >= self.maximum:
            raise ValueError(f"minimum {self.minimum:g} must be smaller than maximum {self.maximum:g}")


class Limits(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Largest outputs of a left and a right motor: both the same way, and against each other."""

    driving: Share = 1.0
    turning: Share = 1.0


def shaped(throttle: float, shape: Shape) -> float:
    """`throttle` -1..1 in the motor's own range."""
    if throttle == 0.0:
        return 0.0
    size = min(shape.maximum, shape.minimum + (shape.maximum - shape.minimum) * abs(throttle))  # min: rounding
    return math.copysign(size, -throttle if shape.reversed else throttle)


def limited(left: float, right: float, limits: Limits) -> tuple[float, float]:
    """Both cut by the same factor: `driving` straight on, `turning` on the spot, in between by how much of each."""
    straight, turn = abs(left + right), abs(left - right)
    if straight + turn == 0.0:
        return 0.0, 0.0
    factor = min(1.0, (limits.driving * straight + limits.turning * turn) / (straight + turn))
    return left * factor, right * factor


class ShapedMotors:
    """Any motors, each with its shape. Fits `vehicle.motors.Motors`."""

    def __init__(self, motors: Motors, shapes: Sequence[Shape] = (), limits: Limits | None = None) -> None:
        """Raises MotorSettingsError where the counts do not fit."""
        if shapes and len(shapes) != motors.count:
            raise MotorSettingsError(f"motor settings: {len(shapes)} shapes for {motors.count} motors")
        if limits is not None and motors.count != 2:
            raise MotorSettingsError(f"motor settings: limits are for 2 motors, left and right, not {motors.count}")
        self.count = motors.count
        self._motors = motors
        self._shapes = tuple(shapes) or (Shape(),) * motors.count
        self._limits = limits

    def enable(self) -> None:
        """Enable the motors."""
        self._motors.enable()

    def disable(self) -> None:
        """Disable the motors."""
        self._motors.disable()

    def set(self, throttles: Sequence[float]) -> None:
        """Set the motors to what `throttles` come to."""
        values = checked(throttles, self.count)
        if self._limits is not None:
            values = limited(values[0], values[1], self._limits)
        self._motors.set([shaped(value, shape) for value, shape in zip(values, self._shapes, strict=True)])

    def close(self) -> None:
        """Close the motors."""
        self._motors.close()
