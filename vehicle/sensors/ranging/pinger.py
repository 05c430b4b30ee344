"""A DistanceSensor that tells each ping: its own average keeps the last distance when the sensor has died."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

from vehicle.motors.pins import DistanceSensor


class Pinger(DistanceSensor):  # type: ignore[misc]
    """Calls `note` in its thread with the share of `max_distance`, None without an echo."""

    def __init__(self, echo: int, trigger: int, max_distance: float, note: Callable[[float | None], None],
                 pin_factory: Any) -> None:  # fmt: skip
        self._note = note  # first, because the thread begins in the constructor
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it recommends pigpio, which does not work on a Pi 5
            super().__init__(
                echo, trigger, queue_len=1, max_distance=max_distance, partial=True, pin_factory=pin_factory
            )

    def _read(self) -> float | None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "no echo" is told by `note`
            share: float | None = super()._read()
        self._note(share)
        return share
