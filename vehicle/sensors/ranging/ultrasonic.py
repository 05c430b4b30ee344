"""HC-SR04 by gpiozero's DistanceSensor, which sends a ping each 0.06 s in a thread."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from vehicle.readings import Scan
from vehicle.sensors.latest import LatestValue
from vehicle.sensors.ranging.settings import Beam, Ultrasonic

BEAM = Beam(width=30.0, near=0.02, far=3.0)
"""`far` is for obstacles that are not flat; flat ones are heard to 4 m."""
RANGE = 4.0
"""m to which an echo is waited for."""


class UltrasonicSensor:
    """A SensorSource of scans with their times. A ping without the end of its pulse is a broken wire."""

    def __init__(self, settings: Ultrasonic, max_age: float, *, pin_factory: Any = None,
                 clock: Callable[[], float] = time.monotonic) -> None:  # fmt: skip
        """Open the pins. Raises MotorError."""
        from vehicle.motors.pins import translated
        from vehicle.sensors.ranging.pinger import Pinger

        self._clock = clock
        self._latest = LatestValue[tuple[Scan, float]](max_age)
        self._what = f"HC-SR04 at GPIO {settings.trigger} and {settings.echo}"
        self._pinger: Any = None
        with translated(self._what):
            self._pinger = Pinger(settings.echo, settings.trigger, RANGE, self._note, pin_factory)

    @property
    def fault(self) -> str | None:
        """Why there is no new scan."""
        return self._latest.fault

    def latest(self, now: float) -> tuple[Scan, float] | None:
        """Return the newest scan and its time; None if it is too old."""
        return self._latest.get(now)

    def close(self) -> None:
        """Release the pins."""
        pinger, self._pinger = self._pinger, None
        if pinger is not None:
            pinger.close()

    def _note(self, share: float | None) -> None:
        """Take the share of RANGE of a ping, from its thread."""
        if share is None:
            self._latest.set_fault(OSError(f"{self._what}: no echo pulse; check its 5 V, trigger and echo"))
        else:
            now = self._clock()
            self._latest.update((BEAM.scan(share * RANGE), now), now)
