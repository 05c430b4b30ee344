"""The highest altitude that the fence of a copter allows, by its own parameters.

ArduCopter: libraries/AC_Fence (FENCE_TYPE, bit 0; FENCE_AUTOENABLE switches it on at take-off or when armed). PX4:
navigator/GeofenceBreachAvoidance, GF_MAX_VER_DIST above home, 0 for none, which GF_ACTION 0 does not keep.
"""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

MAXIMUM = 1
"""Bit of FENCE_TYPE."""


class AltitudeFence(msgspec.Struct, frozen=True):
    """It is on."""

    highest: float
    """m above home."""
    source: str
    """The parameter that says so."""


def ardupilot_fence(values: Mapping[str, float]) -> AltitudeFence | None:
    """Return that of ArduCopter; None: it is off, or not known."""
    enabled = values.get("FENCE_ENABLE") or values.get("FENCE_AUTOENABLE")
    highest = values.get("FENCE_ALT_MAX")
    if not enabled or highest is None or not int(values.get("FENCE_TYPE", MAXIMUM)) & MAXIMUM:
        return None
    return AltitudeFence(highest, "FENCE_ALT_MAX")


def px4_fence(values: Mapping[str, float]) -> AltitudeFence | None:
    """Return that of PX4; None: it is off, or not known."""
    highest = values.get("GF_MAX_VER_DIST")
    return AltitudeFence(highest, "GF_MAX_VER_DIST") if highest and values.get("GF_ACTION", 1.0) else None
