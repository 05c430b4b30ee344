"""Detects under-voltage and overheating of the Raspberry Pi; the failsafes act on it."""

from __future__ import annotations

import math

from vehicle.params import Params
from vehicle.readings import ComputerReadings
from vehicle.safety.health_notices import HealthNotices
from vehicle.statustext import StatusTextQueue

TEMPERATURE_HYSTERESIS = 5.0
"""Degrees below FS_PI_TEMP at which overheating ends: a Pi near the limit is one problem."""
SUPPLY, HEAT = "Pi supply", "Pi temperature"
NO_READING = ComputerReadings()


class PiMonitor:
    """Readings evaluated over time: a problem lasts for CLEAR_DELAY, a missing reading changes nothing."""

    def __init__(self, params: Params, texts: StatusTextQueue) -> None:
        self._params = params
        self._notices = HealthNotices(texts)
        self._known: dict[str, str] = {}

    def update(self, computer: ComputerReadings | None, now: float) -> None:
        """Handle a reading; None if the computer is not monitored."""
        self._known = self._find_problems(computer or NO_READING)
        self._notices.update(self._known, now)

    def failing_since(self) -> float | None:
        """Return when under-voltage or overheating began, None if there is neither."""
        return min(self._notices.since.values(), default=None)

    def problem(self) -> str | None:
        """Return the problems at this moment in one text, or None."""
        return " and ".join(self._known.values()) or None

    def _find_problems(self, computer: ComputerReadings) -> dict[str, str]:
        temperature = computer.temperature
        if temperature is not None and not math.isfinite(temperature):
            temperature = None
        values = {SUPPLY: computer.under_voltage, HEAT: temperature}
        found = {name: text for name, text in self._known.items() if values[name] is None}
        if computer.under_voltage:
            found[SUPPLY] = "Pi under-voltage"
        if temperature is not None and self._is_hot(temperature):
            found[HEAT] = f"Pi at {temperature:.0f} C"
        return found

    def _is_hot(self, temperature: float) -> bool:
        limit = self._params["FS_PI_TEMP"]
        return limit > 0.0 and temperature > (limit - TEMPERATURE_HYSTERESIS if HEAT in self._notices.since else limit)
