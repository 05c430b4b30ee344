"""Is the computer's supply too weak, or is it too hot? Told to the driver; what follows is vehicle/safety/failsafe.py's."""

from __future__ import annotations

import math

from vehicle.params import Params
from vehicle.readings import ComputerReadings
from vehicle.safety.health_notices import HealthNotices
from vehicle.statustext import StatusTextQueue

TEMPERATURE_HYSTERESIS = 5.0
"""Degrees below FS_PI_TEMP at which heat is over: a Pi at the edge is one complaint."""
SUPPLY, HEAT = "Pi supply", "Pi temperature"
NO_READING = ComputerReadings()


class PiMonitor:
    """Judges readings over time: what was there a moment ago still counts, what nobody knows now stays as it was."""

    def __init__(self, params: Params, texts: StatusTextQueue) -> None:
        self._params = params
        self._complaints = HealthNotices(texts)
        self._known: dict[str, str] = {}

    def update(self, computer: ComputerReadings | None, now: float) -> None:
        """Take a reading; None is a computer that nobody watches."""
        self._known = self._found(computer or NO_READING)
        self._complaints.update(self._known, now)

    def failing_since(self) -> float | None:
        """When it began to be too weak or too hot, None while it is neither."""
        return min(self._complaints.since.values(), default=None)

    def problem(self) -> str | None:
        """What is wrong at this moment."""
        return " and ".join(self._known.values()) or None

    def _found(self, computer: ComputerReadings) -> dict[str, str]:
        temperature = computer.temperature
        if temperature is not None and not math.isfinite(temperature):
            temperature = None
        values = {SUPPLY: computer.under_voltage, HEAT: temperature}
        found = {name: words for name, words in self._known.items() if values[name] is None}
        if computer.under_voltage:
            found[SUPPLY] = "Pi under-voltage"
        if temperature is not None and self._hot(temperature):
            found[HEAT] = f"Pi at {temperature:.0f} C"
        return found

    def _hot(self, temperature: float) -> bool:
        limit = self._params["FS_PI_TEMP"]
        return limit > 0.0 and temperature > (
            limit - TEMPERATURE_HYSTERESIS if HEAT in self._complaints.since else limit
        )
