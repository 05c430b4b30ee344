"""Servo pulses: what an ESC or a servo takes for a throttle, as the width of a pulse; no pin and no chip."""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec

Width = Annotated[float, msgspec.Meta(ge=500, le=2500, description="microseconds")]

Idle = Literal["neutral", "off"]
"""What a disabled output gives.

neutral: pulses of `trim_us` go on, after the process too. An ESC stops at the next pulse, 20 ms later, and a steering
servo goes to its centre.
off: no pulses. An ESC that ran goes on until it notices: how long is its own matter, so try it with the wheels up.
"""


class Pulse(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Widths for full reverse, neutral and full ahead (SERVOn_MIN, TRIM, MAX)."""

    min_us: Width = 1000.0
    trim_us: Width = 1500.0
    """Neutral of an ESC, centre of a servo. The same as `min_us` for an ESC that knows no reverse."""
    max_us: Width = 2000.0

    def __post_init__(self) -> None:
        if not self.min_us <= self.trim_us < self.max_us:
            raise ValueError(f"min {self.min_us:g} <= trim {self.trim_us:g} < max {self.max_us:g} us must hold")

    def check_period(self, frequency: float) -> None:
        """Raises ValueError where the longest pulse fills its period: the output would never be low again."""
        period = 1e6 / frequency
        if self.max_us > 0.95 * period:  # also where a chip's own clock makes the period some percent shorter
            raise ValueError(f"max {self.max_us:g} us does not fit into {frequency:g} Hz, {period:g} us")

    def width(self, throttle: float) -> float:
        """s, for -1..1."""
        side = self.max_us - self.trim_us if throttle >= 0.0 else self.trim_us - self.min_us
        return (self.trim_us + throttle * side) * 1e-6
