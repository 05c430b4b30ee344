"""Detects a low or critical battery and a silent sensor; the failsafes act on it."""

from __future__ import annotations

import math

from vehicle.params import Params

CRITICAL_TIMER = 3.0
"""s below BATT_CRT_VOLT: shorter than BATT_LOW_TIMER, because a lithium cell is damaged at that voltage."""
SENSOR_TIMEOUT = 5.0
"""s without a reading (ArduPilot's battery sensor timeout)."""


class BatteryMonitor:
    """Remembers when the voltage fell below each limit."""

    def __init__(self, params: Params) -> None:
        self._params = params
        self._low: float | None = None
        self._critical: float | None = None
        self._seen: float | None = None
        self._expected = False

    @property
    def present(self) -> bool:
        """True if there is a battery sensor, or the configuration names one."""
        return self._expected or self._seen is not None

    @property
    def counting(self) -> bool:
        """Whether the voltage is below a limit, so that a timer runs or has ended."""
        return self._low is not None or self._critical is not None

    def update(self, voltage: float | None, now: float, *, expected: bool = False) -> None:
        """Handle a reading; None and values that are not finite are not a reading.

        `expected`: the configuration names a battery sensor.
        """
        self._expected = expected
        if voltage is None or not math.isfinite(voltage):
            return
        self._seen = now
        self._low = self._low_since(self._low, voltage < self._params["BATT_LOW_VOLT"], now)
        self._critical = self._low_since(self._critical, voltage < self._params["BATT_CRT_VOLT"], now)

    def low_since(self, now: float) -> float | None:
        """Return when the failsafe "battery low" began, or None."""
        return self._timer_end(self._low, self._params["BATT_LOW_TIMER"], now)

    def critical_since(self, now: float) -> float | None:
        """Return when the failsafe "battery critical" began, or None."""
        return self._timer_end(self._critical, CRITICAL_TIMER, now)

    def is_silent(self, now: float) -> bool:
        """Return True if a sensor that was present or is expected has sent nothing for SENSOR_TIMEOUT."""
        return self._expected if self._seen is None else now - self._seen > SENSOR_TIMEOUT

    @staticmethod
    def _low_since(since: float | None, low: bool, now: float) -> float | None:
        if not low:
            return None
        return now if since is None else since

    @staticmethod
    def _timer_end(since: float | None, timer: float, now: float) -> float | None:
        return since + timer if since is not None and now >= since + timer else None
