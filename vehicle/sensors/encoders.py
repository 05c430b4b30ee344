"""Wheel encoders: counts become speeds; the counting is gpiozero's.

gpiozero counts in Python, a callback for each edge: good for some hundred counts a second in all, as slotted discs of
20 or 40 lines give. An encoder on the motor's own axle is faster than that and needs hardware that counts.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Annotated, Any

import msgspec

from vehicle.motors.settings import Pin, pin_name, reject_duplicates

WINDOW = 0.2
"""s over which a speed is the mean: ten control cycles, so that a slow disc still gives some counts in it."""


class Wheel(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The two pins of one encoder; swap them where it counts the wrong way."""

    a: Pin
    b: Pin


class EncoderSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Wheels in motor order."""

    wheels: Annotated[tuple[Wheel, ...], msgspec.Meta(min_length=1, max_length=4)]
    lines: Annotated[int, msgspec.Meta(ge=1)] = 20
    """Counts in a turn of the wheel."""
    diameter: Annotated[float, msgspec.Meta(gt=0, le=10)] = 0.065
    """m"""

    def __post_init__(self) -> None:
        reject_duplicates(self.pins)

    @property
    def pins(self) -> list[int]:
        """Of all wheels."""
        return [pin for wheel in self.wheels for pin in (wheel.a, wheel.b)]

    @property
    def taken(self) -> list[str]:
        """Pins."""
        return [pin_name(pin) for pin in self.pins]

    @property
    def metres(self) -> float:
        """The way of one count."""
        return math.pi * self.diameter / self.lines


class WheelSpeedFilter:
    """Counts and times in, m/s out. No hardware."""

    def __init__(self, metres: float) -> None:
        """`metres` is the way of one count."""
        self._metres = metres
        self._seen: deque[tuple[float, int]] = deque()

    def update(self, count: int, now: float) -> float:
        """Mean of the last WINDOW; 0 until there are two counts to compare."""
        if self._seen and now < self._seen[-1][0]:
            self._seen.clear()
        self._seen.append((now, count))
        while len(self._seen) > 2 and now - self._seen[1][0] >= WINDOW:
            self._seen.popleft()
        began, first = self._seen[0]
        return (count - first) * self._metres / (now - began) if now > began else 0.0


class Encoders:
    """A `Source` of each wheel's m/s. Reading is cheap, so it needs no thread of ours."""

    def __init__(self, settings: EncoderSettings, *, pin_factory: Any = None) -> None:
        """Raises MotorError, as everything at the pins does."""
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
        """None once closed. A broken wire cannot be told from a wheel that stands."""
        if not self._encoders:
            return None
        pairs = zip(self._encoders, self._meters, strict=True)
        return tuple(meter.update(encoder.steps, now) for encoder, meter in pairs)

    def close(self) -> None:
        """Let the pins go."""
        encoders, self._encoders = self._encoders, []
        for encoder in encoders:
            encoder.close()
