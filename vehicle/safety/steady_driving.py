"""Steady driving: an armed rover that repeats what it did needs its sensors less often. Time is an argument."""

from __future__ import annotations

from dialects.modes import Mode
from vehicle.drive.control import Control
from vehicle.drive.demand import Demand
from vehicle.pace import PERIOD
from vehicle.safety.monitor import SafetyMonitor
from vehicle.safety.state_machine import Safety

MODES_WITHOUT_SENSORS = frozenset({Mode.MANUAL, Mode.HOLD})
"""Modes that need no sensor to drive."""


class SteadyDriving:
    """Whether the armed rover drives on as it did in the last PERIOD, with a fresh demand and without a hazard."""

    def __init__(self, safety: Safety, control: Control, monitor: SafetyMonitor, now: float) -> None:
        self._safety = safety
        self._control = control
        self._monitor = monitor
        self._wheels: tuple[float, ...] = ()
        self._moved_at = now
        """When a wheel was last given another value."""
        self._driven = False
        """The wheels followed the demand when the outputs were computed last."""

    def note_outputs(self, wheels: tuple[float, ...], *, driven: bool, now: float) -> None:
        """Note the values of the wheels; `driven`: they follow the demand."""
        self._driven = driven
        if wheels != self._wheels:
            self._wheels, self._moved_at = wheels, now

    def lasts(self, now: float) -> bool:
        """Return whether a short cycle is enough; what time alone brings about is due in a whole one."""
        safety, control = self._safety, self._control
        return (
            now - self._moved_at > PERIOD
            and safety.mode in MODES_WITHOUT_SENSORS
            and control.demand is not None
            and not control.is_demand_stale(now)
            and not self._monitor.has_deadline(now)
        )

    def repeats(self, before: Demand | None, now: float) -> bool:
        """Return whether the newest demand repeats the one before it, which the wheels follow already."""
        demand = self._control.demand
        return (
            self._driven
            and now - self._moved_at > PERIOD
            and demand is not None
            and before is not None
            and demand.axes == before.axes
            and self._control.neutral_seen
            and not self._monitor.is_late(now)
        )
