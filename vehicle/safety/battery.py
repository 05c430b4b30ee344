"""Is the battery low, critical or silent? Judged from readings over time; what follows is vehicle/safety/failsafe.py's."""

from __future__ import annotations

import math

from vehicle.params import Params

CRITICAL_TIMER = 3.0
"""s below BATT_CRT_VOLT: shorter than BATT_LOW_TIMER, because a lithium cell is damaged there."""
SENSOR_TIMEOUT = 5.0
"""s without a reading (ArduPilot's battery sensor timeout)."""


class BatteryMonitor:
    """Times since when the voltage has been too low, None while it is not."""

    def __init__(self, params: Params) -> None:
        self._params = params
        self._low: float | None = None
        self._critical: float | None = None
        self._seen: float | None = None
        self._expected = False

    @property
    def present(self) -> bool:
        """There is a battery sensor, or should be."""
        return self._expected or self._seen is not None

    def update(self, voltage: float | None, now: float, *, expected: bool = False) -> None:
        """Take a reading; None or a bad number is no reading. `expected`: the vehicle should have this sensor."""
        self._expected = expected
        if voltage is None or not math.isfinite(voltage):
            return
        self._seen = now
        self._low = self._began(self._low, voltage < self._params["BATT_LOW_VOLT"], now)
        self._critical = self._began(self._critical, voltage < self._params["BATT_CRT_VOLT"], now)

    def low_since(self, now: float) -> float | None:
        """When the failsafe "battery low" began, or None."""
        return self._after(self._low, self._params["BATT_LOW_TIMER"], now)

    def critical_since(self, now: float) -> float | None:
        """When the failsafe "battery critical" began, or None."""
        return self._after(self._critical, CRITICAL_TIMER, now)

    def is_silent(self, now: float) -> bool:
        """A battery sensor that there should be has never answered, or one that there was has stopped."""
        return self._expected if self._seen is None else now - self._seen > SENSOR_TIMEOUT

    @staticmethod
    def _began(since: float | None, low: bool, now: float) -> float | None:
        if not low:
            return None
        return now if since is None else since

    @staticmethod
    def _after(since: float | None, timer: float, now: float) -> float | None:
        return since + timer if since is not None and now >= since + timer else None
