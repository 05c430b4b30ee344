"""The take-off of what keys fly: whether it may begin, and the parameters of MAV_CMD_NAV_TAKEOFF."""

from __future__ import annotations

from dialects.enums import Autopilot
from groundstation.vehicles.state.vehicle_state import VehicleState

LOWEST, HIGHEST = 1.0, 30.0
"""m above the ground to which keys take off."""


def find_refusal(vehicle: VehicleState, unsafe: str, now: float) -> str:
    """Return why a vehicle may not take off now, or "". `unsafe`: what a lost link would do, see Contact."""
    if vehicle.model.refusal or not vehicle.model.flies:
        return vehicle.model.refusal or f"a {vehicle.model.word} does not fly"
    if unsafe:
        return f"no take-off: {unsafe}"
    if not vehicle.armed:
        return "disarmed"
    if vehicle.mode not in vehicle.model.keys:
        return f"keys do not fly it in {vehicle.mode}"
    if not vehicle.is_landed(now):
        return "it does not report that it is on the ground"
    if vehicle.autopilot == Autopilot.PX4 and vehicle.sea_level is None:
        return "its altitude is not known"
    return ""


def take_off_params(vehicle: VehicleState, altitude: float) -> tuple[float, ...]:
    """Return the parameters for an altitude above the ground, m: PX4 takes it above mean sea level."""
    height = max(LOWEST, min(HIGHEST, altitude))
    ground = vehicle.sea_level if vehicle.autopilot == Autopilot.PX4 else 0.0
    nan = float("nan") if vehicle.autopilot == Autopilot.PX4 else 0.0
    return 0.0, 0.0, 0.0, nan, nan, nan, (ground or 0.0) + height
