"""What is told to the driver once as it begins and once as it ends, however often it comes and goes; stops nothing."""

from __future__ import annotations

from collections.abc import Mapping

from dialects.enums import Severity
from vehicle.navigation.fence_avoidance import FenceAvoidance
from vehicle.readings import Readings
from vehicle.statustext import StatusTextQueue

CLEAR_DELAY = 5.0
"""s without a complaint until it is over: a loose wire or a weak supply comes and goes, and is one complaint."""


class HealthNotices:
    """Remembers what was told, and since when it has lasted."""

    def __init__(self, texts: StatusTextQueue) -> None:
        self.since: dict[str, float] = {}
        """What was told and is not over -> when it began."""
        self._texts = texts
        self._seen: dict[str, float] = {}
        """... -> when it was there last."""

    def update(self, found: Mapping[str, str], now: float) -> None:
        """Take what there is to complain of now, name -> words; tell what is new and what is over."""
        for name, text in found.items():
            if name not in self.since:
                self.since[name] = now
                self._texts.send(Severity.WARNING, text, now)
            self._seen[name] = now
        for name in [name for name in self.since if now - self._seen[name] >= CLEAR_DELAY]:
            del self.since[name], self._seen[name]
            self._texts.send(Severity.INFO, f"{name} is well again", now)


def sensor_notices(readings: Readings) -> dict[str, str]:
    """What sensors that give nothing say of it."""
    return {f"{fault.sensor} sensor": f"{fault.sensor} sensor: {fault.reason}" for fault in readings.faults}


def fence_notices(boundary: FenceAvoidance) -> dict[str, str]:
    """That it would stop nobody: a driver in MANUAL needs no position, and goes on."""
    return {"Fence": "Fence: position is not known, it stops nobody"} if boundary.lacks_position else {}
