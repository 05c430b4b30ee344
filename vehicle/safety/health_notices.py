"""Notices about sensors, the Pi and the fence: sent once when a problem begins and once when it ends."""

from __future__ import annotations

from collections.abc import Mapping

from dialects.enums import Severity
from vehicle.navigation.fence_avoidance import FenceAvoidance
from vehicle.readings import Readings
from vehicle.statustext import StatusTextQueue

CLEAR_DELAY = 5.0
"""s without the problem until it is over: a loose wire or a weak supply comes and goes, and counts as one problem."""


class HealthNotices:
    """The problems that have been reported and are not over."""

    def __init__(self, texts: StatusTextQueue) -> None:
        self.since: dict[str, float] = {}
        """Name of the problem -> time when it began."""
        self._texts = texts
        self._seen: dict[str, float] = {}
        """... -> time when it was last present."""

    def update(self, found: Mapping[str, str], now: float) -> None:
        """Set the problems present now (name -> text); report those that are new and those that are over."""
        if not found and not self.since:  # nearly always
            return
        for name, text in found.items():
            if name not in self.since:
                self.since[name] = now
                self._texts.send(Severity.WARNING, text, now)
            self._seen[name] = now
        for name in [name for name in self.since if now - self._seen[name] >= CLEAR_DELAY]:
            del self.since[name], self._seen[name]
            self._texts.send(Severity.INFO, f"{name} OK again", now)


def sensor_notices(readings: Readings) -> dict[str, str]:
    """Return a notice for each sensor that has failed."""
    return {f"{fault.sensor} sensor": f"{fault.sensor} sensor: {fault.reason}" for fault in readings.faults}


def obstacle_notices(faults: Mapping[str, str]) -> dict[str, str]:
    """Return a notice for each range sensor that has failed."""
    texts = [f"Range sensor {name} ({fault})" for name, fault in faults.items()]
    return {text: text for text in texts}


def fence_notices(avoidance: FenceAvoidance) -> dict[str, str]:
    """Return a notice if the fence cannot be enforced: MANUAL needs no position and continues."""
    return {"Fence": "Fence not enforced: position is not known"} if avoidance.lacks_position else {}
