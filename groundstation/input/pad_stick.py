"""The gamepad in the station: its newest demand, valid while the dead-man button is held and the pad is being read."""

from __future__ import annotations

import math

from dialects.axes import NEUTRAL, Axes
from groundstation.intents.driving import PAD_WINDOW, DrivePad


class PadStick:
    """One gamepad. Times are of one monotonic clock, s."""

    def __init__(self) -> None:
        self._until = -math.inf
        """Until when its newest demand counts; in the past when it does not drive."""
        self._axes = NEUTRAL

    def push(self, push: DrivePad, now: float) -> bool:
        """Handle a demand. Returns False if it does not count: the dead-man button must be pressed again."""
        until = min(push.read_at, now) + PAD_WINDOW
        if (push.repeat and not self.held(now)) or not now < until or not _is_finite(push):
            self.release()
            return False
        self._until, self._axes = until, Axes(*map(_unit, (push.throttle, push.steering, push.side, push.climb)))
        return True

    def release(self) -> None:
        """Go neutral: the dead-man button was released, or must be pressed again."""
        self._until, self._axes = -math.inf, NEUTRAL

    def held(self, now: float) -> bool:
        """Return whether the gamepad drives."""
        return now < self._until

    @property
    def until(self) -> float:
        """When its newest demand ends, unless another one follows."""
        return self._until

    @property
    def axes(self) -> Axes:
        """The demand, -1..1; ask `held` first."""
        return self._axes


def _is_finite(push: DrivePad) -> bool:
    return all(map(math.isfinite, (push.throttle, push.steering, push.side, push.climb)))


def _unit(value: float) -> float:
    return max(-1.0, min(1.0, value))
