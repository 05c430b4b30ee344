"""MODE_KEYS: digits of the modes of a vehicle, on the Map screen."""

from __future__ import annotations

MODE_KEYS: dict[str, tuple[str, ...]] = {
    "1": ("MANUAL",),
    "2": ("HOLD", "AUTO_LOITER"),
    "3": ("AUTO", "AUTO_MISSION", "MISSION"),
    "4": ("GUIDED", "OFFBOARD"),
    "5": ("RTL", "AUTO_RTL", "RETURN"),
    "6": ("LOITER", "STEERING"),
}
"""Digit -> names of the mode, of which the vehicle has one or none."""
