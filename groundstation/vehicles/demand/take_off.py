"""The take-off of what keys fly: whether it may begin, and the parameters of MAV_CMD_NAV_TAKEOFF."""

from __future__ import annotations

from dialects.enums import Autopilot
from groundstation.intents.vehicle import HIGHEST_TAKE_OFF, LOWEST_TAKE_OFF
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.vehicles.stops.altitude_fence import AltitudeFence


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


def find_fence_refusal(altitude: float, fence: AltitudeFence | None) -> str:
    """Return why a vehicle may not take off to an altitude above the ground, m, or ""."""
    if fence is None or altitude <= fence.highest:
        return ""
    limit = f"{fence.source} {fence.highest:g}"
    return f"{altitude:g} m is above its altitude fence, {limit}: take off lower, or raise the fence"


def take_off_params(vehicle: VehicleState, altitude: float) -> tuple[float, ...]:
    """Return the parameters for an altitude above the ground, m: PX4 takes it above mean sea level."""
    height = max(LOWEST_TAKE_OFF, min(HIGHEST_TAKE_OFF, altitude))
    ground = vehicle.sea_level if vehicle.autopilot == Autopilot.PX4 else 0.0
    nan = float("nan") if vehicle.autopilot == Autopilot.PX4 else 0.0
    return 0.0, 0.0, 0.0, nan, nan, nan, (ground or 0.0) + height
