"""How fast a copter moves that should stand: the wind, a bad position or a compass carries it away."""

from __future__ import annotations

SETTLED = 8.0
"""s with the sticks at rest: a copter brakes from full speed in less."""
SLOWEST = 1.0
"""m/s from which on it drifts; the noise of a GPS is less."""


class Drift:
    """Follows one vehicle."""

    def __init__(self) -> None:
        self._rests_since: float | None = None
        self._speed: float | None = None

    def add(self, speed: float | None, now: float, *, rests: bool) -> None:
        """Take its speed over ground in m/s. `rests`: it flies, and our demands ask for no motion."""
        self._speed = speed
        if not rests:
            self._rests_since = None
        elif self._rests_since is None:
            self._rests_since = now

    def speed(self, now: float) -> float | None:
        """Return the m/s of its drift; None: it does not drift, or that cannot be told."""
        settled = self._rests_since is not None and now - self._rests_since >= SETTLED
        return self._speed if settled and self._speed is not None and self._speed >= SLOWEST else None
