"""The interface of an autonomous mode, and what its constructor gets."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import msgspec

from vehicle.autonomy.trail import Trail
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Point
from vehicle.navigation.guidance import PathFollower
from vehicle.navigation.rally import ReturnPoint
from vehicle.navigation.speed_control import DesiredMotion
from vehicle.params import Params


class ModeFinished(msgspec.Struct, frozen=True):
    """Result of a step: the mode is done, and HOLD follows."""

    reason: str


class ModeContext(msgspec.Struct, frozen=True):
    """The parts of the vehicle that a mode may use."""

    params: Params
    guide: PathFollower
    find_return_point: Callable[[Estimate], ReturnPoint | None]
    trail: Trail


class AutonomousMode(Protocol):
    """A mode that drives without an operator."""

    @property
    def goal(self) -> Point | None:
        """The place that the mode drives to."""

    def unready(self, estimate: Estimate) -> str | None:
        """Return why the mode cannot begin, besides what its ModeSpec requires, or None."""

    def begin(self, estimate: Estimate, now: float) -> None:
        """Begin anew: the mode was chosen, or the vehicle was armed or stopped."""

    def step(self, estimate: Estimate, speed: float, now: float) -> DesiredMotion | ModeFinished | None:
        """Return the motion of this cycle; None if there is no valid target."""
