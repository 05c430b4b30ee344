"""Timings of the way from a key to the motors: the newest, and the 99th percentile of the last ones."""

from __future__ import annotations

import math
from collections import deque

from groundstation.snapshot.drive import KeyToMotor, Timing

KEPT = 200
"""Presses kept: enough for two of a hundred, and a few minutes of driving."""


class Timings:
    """The last KEPT times of one part of the way."""

    def __init__(self) -> None:
        self.view = Timing()
        self._kept: deque[float] = deque(maxlen=KEPT)

    def add(self, seconds: float) -> None:
        """Add a time."""
        self._kept.append(seconds)
        self.view = Timing(seconds, sorted(self._kept)[math.ceil(0.99 * len(self._kept)) - 1])


class KeyTimings:
    """All parts of the way to one vehicle."""

    def __init__(self) -> None:
        self._key, self._heard, self._motor, self._total = Timings(), Timings(), Timings(), Timings()

    def add(self, key: float | None, heard: float | None, motor: float) -> None:
        """Add a press: s from the key until it was sent, then to the vehicle, then to the motors.

        `key` None: a timer made the demand. `heard` None: not known, and `motor` is the whole way from sending.
        """
        if key is not None:
            self._key.add(key)
            self._total.add(key + (heard or 0.0) + motor)
        if heard is not None:
            self._heard.add(heard)
            self._motor.add(motor)

    def build_view(self) -> KeyToMotor:
        """Build the part of the snapshot."""
        return KeyToMotor(self._key.view, self._heard.view, self._motor.view, self._total.view)
