"""Sampler: a thread that reads a slow sensor periodically, so that the control loop never waits for a bus or a file."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from vehicle.sensors.latest import LatestValue

T = TypeVar("T")


class Sampler(Generic[T]):
    """A SensorSource around a function that may block and may raise."""

    def __init__(
        self, sample: Callable[[], T], *, period: float, max_age: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Start reading, each `period` s; a value is valid for `max_age` s. `clock` gives the time base of `latest`."""
        self._sample = sample
        self._period = period
        self._clock = clock
        self._latest = LatestValue[T](max_age)
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="sensor", daemon=True)
        self._thread.start()

    @property
    def fault(self) -> str | None:
        """Why there is no new value."""
        return self._latest.fault

    def latest(self, now: float) -> T | None:
        """Return the newest value; None if it is too old."""
        return self._latest.get(now)

    def close(self) -> None:
        """Stop the thread; a thread that hangs in its bus is abandoned and ends with the process."""
        self._ending.set()
        self._thread.join(timeout=1.0)

    def _run(self) -> None:
        while True:
            try:
                self._latest.update(self._sample(), self._clock())
            except Exception as error:  # a sensor may raise anything; the error is reported as its fault
                self._latest.set_fault(error)
            if self._ending.wait(self._period):
                return
