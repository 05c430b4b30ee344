"""Pulses of servo outputs and RC channels as fractions, by the vehicle's own MIN, TRIM, MAX and REVERSED.

https://ardupilot.org/rover/docs/parameters.html#servo1-parameters, #rc1-parameters
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects.messages import UINT16_MAX
from groundstation.vehicles.readings.values import within

NO_PULSE = (0, UINT16_MAX)
"""An output or a channel that is off or not known; else 1000 to 2000 us."""

SUFFIXES = ("MIN", "TRIM", "MAX", "REVERSED")


def pulse_params(channel: str) -> tuple[str, ...]:
    """Return the parameters of a channel, e.g. "SERVO1", "RC3"."""
    return tuple(f"{channel}_{suffix}" for suffix in SUFFIXES)


def pulse_fraction(pulse: int, channel: str, values: Mapping[str, float]) -> float | None:
    """Return what a pulse in us means, -1..1; None for no pulse, and while a parameter of the channel is not known."""
    known = [values.get(name) for name in pulse_params(channel)]
    low, trim, high, reverse = known
    if pulse in NO_PULSE or low is None or trim is None or high is None or reverse is None:
        return None
    span = high - trim if pulse >= trim else trim - low
    if span <= 0:  # the parameters make no sense
        return None
    return within((pulse - trim) / span * (-1 if reverse else 1))
