"""The simulated battery: charge and voltage from the current, with voltage sag, recovery and discharge."""

from __future__ import annotations

import math
from bisect import bisect_right

NOMINAL_VOLTAGE = 11.1
"""V, a pack of three lithium cells: the voltage at which the motors reach their top speed."""

REST_VOLTAGES: tuple[tuple[float, float], ...] = (
    (0.0, 9.0), (0.05, 10.2), (0.1, 10.6), (0.2, 10.95), (0.5, 11.4), (0.8, 12.0), (1.0, 12.6),
)  # fmt: skip
"""(charge 0..1, V at rest) of three lithium-polymer cells: steep at both ends, flat in between."""


class Battery:
    """A pack of `capacity` Ah. 2.2 Ah drives this rover for about three quarters of an hour."""

    RESISTANCE = 0.06
    """ohm, of cells, leads and switch: the voltage drop that follows the current at once."""
    POLARISATION = 0.04
    """ohm: the voltage drop that follows the current with the time constant RECOVERY."""
    RECOVERY = 20.0
    """s: time constant of the slow drop, because of which a rested battery looks fuller than it is."""

    def __init__(self, remaining: float = 1.0, capacity: float = 2.2) -> None:
        self.remaining = remaining
        """Charge, 0..1."""
        self.current = 0.0
        """Present current, A."""
        self._capacity = capacity * 3600  # As
        self._slow_drop = 0.0

    def step(self, current: float, dt: float) -> None:
        """Draw `current` A for `dt` s."""
        self.current = current
        self.remaining = max(0.0, self.remaining - current * dt / self._capacity)
        final = current * self.POLARISATION
        self._slow_drop = final + (self._slow_drop - final) * math.exp(-dt / self.RECOVERY)

    @property
    def voltage(self) -> float:
        """V at the terminals, under the present load."""
        return max(0.0, _rest_voltage(self.remaining) - self.current * self.RESISTANCE - self._slow_drop)


def _rest_voltage(remaining: float) -> float:
    index = min(bisect_right(REST_VOLTAGES, (remaining, math.inf)), len(REST_VOLTAGES) - 1)
    (charge_0, volt_0), (charge_1, volt_1) = REST_VOLTAGES[index - 1], REST_VOLTAGES[index]
    return volt_0 + (volt_1 - volt_0) * (remaining - charge_0) / (charge_1 - charge_0)
