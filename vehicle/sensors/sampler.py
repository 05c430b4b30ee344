"""A thread that reads a slow sensor again and again, so that the control loop never waits for a bus or a file."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from vehicle.sensors.latest import LatestValue

T = TypeVar("T")


class Sampler(Generic[T]):
    """A `Source` around a function that may block and may raise."""

    def __init__(
        self, sample: Callable[[], T], *, period: float, max_age: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        """Read at once and then each `period` s; a value counts for `max_age` s. `clock` is that of `latest`'s now."""
        self._sample = sample
        self._period = period
        self._clock = clock
        self._latest = LatestValue[T](max_age)
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, name="sensor", daemon=True)
        self._thread.start()

    @property
    def fault(self) -> str | None:
        """Why there is nothing new."""
        return self._latest.fault

    def latest(self, now: float) -> T | None:
        """The newest value."""
        return self._latest.get(now)

    def close(self) -> None:
        """End the thread; one that hangs in its bus is left behind, it ends with the process."""
        self._ending.set()
        self._thread.join(timeout=1.0)

    def _run(self) -> None:
        while True:
            try:
                self._latest.update(self._sample(), self._clock())
            except Exception as error:  # a sensor of somebody else's may raise anything: it is kept and told
                self._latest.set_fault(error)
            if self._ending.wait(self._period):
                return
