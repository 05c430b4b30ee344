"""How fast the battery of one vehicle empties while it is armed, from the charge that it reports in whole percent."""

from __future__ import annotations

from collections import deque

LEAST_DROP = 0.02
"""Share of the charge between the first and the last step from which on a rate is told: two whole percent."""
SPAN = 1800.0
"""s armed that the rate is taken from."""
CHARGED = 0.05
"""Rise of the charge that means another battery; a smaller one is the voltage that recovers while the motors stand."""
GAP = 5.0
"""Longest s between two readings that count: the vehicle was silent for longer."""


class BatteryUse:
    """Measures between the moments at which the charge falls by a step: those are exact, the charge between is not."""

    def __init__(self) -> None:
        self._steps: deque[tuple[float, float]] = deque()
        """s armed and the charge 0..1 that was reported for the first time then."""
        self._least: float | None = None
        self._armed = 0.0
        self._seen_at: float | None = None

    def add(self, charge: float | None, now: float, *, armed: bool) -> None:
        """Take a reading of the charge, 0..1; None: not reported."""
        if armed and self._seen_at is not None:
            self._armed += max(0.0, min(GAP, now - self._seen_at))
        self._seen_at = now
        if charge is None:
            return
        if self._least is None or charge > self._least + CHARGED:
            self._steps.clear()
            self._least = charge
        elif charge < self._least:
            self._least = charge
            self._steps.append((self._armed, charge))
            while self._armed - self._steps[0][0] > SPAN:
                self._steps.popleft()

    @property
    def rate(self) -> float | None:
        """Share of the charge that is used in a second of being armed; None: too little was used to tell."""
        if len(self._steps) < 2:
            return None
        (begun, full), (ended, rest) = self._steps[0], self._steps[-1]
        if full - rest < LEAST_DROP - 1e-9 or ended <= begun:
            return None
        return (full - rest) / (ended - begun)
