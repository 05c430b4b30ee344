"""Servo pulses: the pulse width for a throttle, for ESCs and servos; no pin and no chip."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

Width = Annotated[float, msgspec.Meta(ge=500, le=2500, description="microseconds")]

Idle = Literal["neutral", "off"]
"""Output while disabled.

neutral: pulses of `trim_us` continue, even after the process has ended. An ESC stops at the next pulse, 20 ms later,
and a steering servo moves to its centre.
off: no pulses. A running ESC continues until it detects the loss; how long that takes depends on the ESC, so test it
with the wheels in the air.
"""


class Pulse(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Widths for full reverse, neutral and full forward (SERVOn_MIN, TRIM, MAX)."""

    min_us: Width = 1000.0
    trim_us: Width = 1500.0
    """Neutral of an ESC, centre of a servo. The same as `min_us` for an ESC without reverse."""
    max_us: Width = 2000.0

    def __post_init__(self) -> None:
        if not self.min_us <= self.trim_us < self.max_us:
            raise ValueError(f"min {self.min_us:g} <= trim {self.trim_us:g} < max {self.max_us:g} us must hold")

    def check_period(self, frequency: float) -> None:
        """Raise ValueError if the longest pulse fills its period: the output would never be low."""
        period = 1e6 / frequency
        if self.max_us > 0.95 * period:  # 5 % reserve: the clock of a chip may make the period some percent shorter
            raise ValueError(f"max {self.max_us:g} us does not fit into {frequency:g} Hz, {period:g} us")

    def width(self, throttle: float) -> float:
        """Return the pulse width in s for a throttle of -1 to 1."""
        side = self.max_us - self.trim_us if throttle >= 0.0 else self.trim_us - self.min_us
        return (self.trim_us + throttle * side) * 1e-6
