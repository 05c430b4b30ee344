"""Wheel encoders: speeds from the counts of gpiozero.

gpiozero counts in Python, with a callback for each edge. That suffices for some hundred counts per second in total, as
from slotted discs with 20 or 40 lines. An encoder on the motor shaft is faster and needs a hardware counter.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Annotated, Any

import msgspec

from vehicle.motors.settings import Pin, pin_name, reject_duplicates

WINDOW = 0.2
"""s over which a speed is averaged: ten control cycles, so that even a slow disc gives some counts."""


class Wheel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The two pins of one encoder; swap them if it counts backwards."""

    a: Pin
    b: Pin


class EncoderSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Wheels in motor order."""

    wheels: Annotated[tuple[Wheel, ...], msgspec.Meta(min_length=1, max_length=4)]
    lines: Annotated[int, msgspec.Meta(ge=1)] = 20
    """Counts per turn of the wheel."""
    diameter: Annotated[float, msgspec.Meta(gt=0, le=10)] = 0.065
    """Diameter of the wheel, m."""

    def __post_init__(self) -> None:
        reject_duplicates(self.taken)

    @property
    def pins(self) -> list[int]:
        """The pins of all wheels."""
        return [pin for wheel in self.wheels for pin in (wheel.a, wheel.b)]

    @property
    def taken(self) -> list[str]:
        """The pins by name."""
        return [pin_name(pin) for pin in self.pins]

    @property
    def metres(self) -> float:
        """Distance of one count, m."""
        return math.pi * self.diameter / self.lines


class WheelSpeedFilter:
    """Computes the speed of a wheel in m/s from its counts. No hardware."""

    def __init__(self, metres: float) -> None:
        """`metres` is the distance of one count."""
        self._metres = metres
        self._samples: deque[tuple[float, int]] = deque()

    def update(self, count: int, now: float) -> float:
        """Return the mean speed of the last WINDOW; 0 until there are two counts to compare."""
        if self._samples and now < self._samples[-1][0]:
            self._samples.clear()
        self._samples.append((now, count))
        while len(self._samples) > 2 and now - self._samples[1][0] >= WINDOW:
            self._samples.popleft()
        start, first = self._samples[0]
        return (count - first) * self._metres / (now - start) if now > start else 0.0


class Encoders:
    """A SensorSource of the speed of each wheel, m/s. Reading is fast, so it needs no thread."""

    def __init__(self, settings: EncoderSettings, *, pin_factory: Any = None) -> None:
        """Open the pins. Raises MotorError."""
        from vehicle.motors.pins import RotaryEncoder, translated

        self.fault: str | None = None
        self._encoders: list[Any] = []
        self._meters = [WheelSpeedFilter(settings.metres) for _ in settings.wheels]
        try:
            with translated("wheel encoders"):
                for wheel in settings.wheels:
                    self._encoders.append(RotaryEncoder(wheel.a, wheel.b, max_steps=0, pin_factory=pin_factory))
        except BaseException:
            self.close()
            raise

    def latest(self, now: float) -> tuple[float, ...] | None:
        """Return the speeds; None once closed. A broken wire looks like a wheel at rest."""
        if not self._encoders:
            return None
        pairs = zip(self._encoders, self._meters, strict=True)
        return tuple(meter.update(encoder.steps, now) for encoder, meter in pairs)

    def close(self) -> None:
        """Release the pins."""
        encoders, self._encoders = self._encoders, []
        for encoder in encoders:
            encoder.close()
