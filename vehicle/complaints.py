"""What sensors and the computer complain of, told to the driver once as it begins and once as it ends; stops nothing.

What follows from missing values is failsafe.py's.
"""

from __future__ import annotations

from dialects.enums import Severity
from vehicle.readings import Computer, Readings
from vehicle.texts import Texts

HOT, COOL = 85.0, 80.0
"""Degrees Celsius: a Raspberry Pi slows down from 85 on; the gap keeps a Pi at the edge from telling each time."""
CALM = 5.0
"""s without the complaint until it is over: a loose wire or a weak supply comes and goes, and is one complaint."""
SUPPLY, HEAT = "Pi supply", "Pi temperature"
UNWATCHED = Computer()


class Complaints:
    """Remembers what was told."""

    def __init__(self, texts: Texts) -> None:
        self._texts = texts
        self._seen: dict[str, float] = {}
        """What was told and is not over -> when it was there last."""

    def sense(self, readings: Readings, now: float) -> None:
        """Tell what is new and what is over."""
        found = {f"{fault.sensor} sensor": f"{fault.sensor} sensor: {fault.reason}" for fault in readings.faults}
        found |= self._of(readings.computer or UNWATCHED)
        for name, text in found.items():
            if name not in self._seen:
                self._texts.say(Severity.WARNING, text, now)
            self._seen[name] = now
        self._end(now)

    def _of(self, computer: Computer) -> dict[str, str]:
        known = {SUPPLY: computer.under_voltage, HEAT: computer.temperature}
        # What nobody knows now is neither new nor over.
        found = {name: "" for name, value in known.items() if value is None and name in self._seen}
        if computer.under_voltage:
            found[SUPPLY] = "Pi under-voltage"
        if computer.temperature is not None and computer.temperature > (COOL if HEAT in self._seen else HOT):
            found[HEAT] = f"Pi at {computer.temperature:.0f} C"
        return found

    def _end(self, now: float) -> None:
        for name in [name for name, seen in self._seen.items() if now - seen >= CALM]:
            del self._seen[name]
            self._texts.say(Severity.INFO, f"{name} is well again", now)
