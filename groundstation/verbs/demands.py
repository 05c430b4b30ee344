"""Messages that can move a vehicle: which they are, their limits, and the neutral that ends them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from dialects import messages as m
from dialects.axes import FULL_DEFLECTION, NEUTRAL, axis_map, build_manual_control
from dialects.messages import INVALID_AXIS, UINT16_MAX, boot_ms
from groundstation.vehicles.vehicle_state import VehicleState
from groundstation.verbs.exit_codes import ExitCode, VerbError

Neutral = Callable[[VehicleState, Mapping[str, Any], float], list[m.Message]]
"""Returns what ends a demand with these values, in order. Takes the time in s."""

VELOCITY_ONLY = 0x0DC7
"""POSITION_TARGET_TYPEMASK that ignores position, acceleration, yaw and yaw rate."""
CENTRE, RELEASE = 1500, 0
"""us of a channel of RC_CHANNELS_OVERRIDE at rest, and what gives it back to the receiver."""
AXES = ("x", "y", "z", "r")


def _neutral_manual(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    return [build_manual_control(NEUTRAL, state.system, axis_map(state.autopilot))]


def _neutral_channels(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    channels = [name for name in values if name.startswith("chan")]
    first = m.RcChannelsOverride(state.system, state.component, *[UINT16_MAX] * 8)
    last = m.RcChannelsOverride(state.system, state.component, *[UINT16_MAX] * 8)
    for name in channels:
        setattr(first, name, CENTRE)
        setattr(last, name, RELEASE)
    return [first, last]


def _neutral_local(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    frame, zeros = values.get("coordinate_frame", 1), [0.0] * 11
    target = (boot_ms(now), state.system, state.component)
    return [m.SetPositionTargetLocalNed(*target, frame, VELOCITY_ONLY, *zeros)]


def _neutral_global(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    frame, zeros = values.get("coordinate_frame", 0), [0.0] * 9
    target = (boot_ms(now), state.system, state.component)
    return [m.SetPositionTargetGlobalInt(*target, frame, VELOCITY_ONLY, 0, 0, *zeros)]


def _neutral_attitude(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    mask, target = values.get("type_mask", 0), (boot_ms(now), state.system, state.component)
    return [m.SetAttitudeTarget(*target, mask, values.get("q", [1.0, 0.0, 0.0, 0.0]), 0.0, 0.0, 0.0, 0.0)]


DEMANDS: dict[type[m.Message], Neutral] = {
    m.ManualControl: _neutral_manual,
    m.RcChannelsOverride: _neutral_channels,
    m.SetPositionTargetLocalNed: _neutral_local,
    m.SetPositionTargetGlobalInt: _neutral_global,
    m.SetAttitudeTarget: _neutral_attitude,
}
"""Demand -> the neutral that ends it."""

MOVES = frozenset({
    "COMMAND_LONG", "COMMAND_INT", "SET_MODE", "MISSION_ITEM", "MISSION_ITEM_INT", "MISSION_SET_CURRENT",
    "SET_ACTUATOR_CONTROL_TARGET", "MANUAL_SETPOINT", "HIL_CONTROLS", "HIL_ACTUATOR_CONTROLS", "SET_HOME_POSITION",
})  # fmt: skip
"""Names of further messages that can make a vehicle move, and that no neutral ends."""

OURS = frozenset({"ROVER_OPERATOR_PRESENCE"})
"""Names of messages that this program makes itself."""


def check_demand(kind: type[m.Message], values: Mapping[str, Any], *, confirmed: bool) -> None:
    """Raise VerbError for a demand that is not confirmed, or cannot be right."""
    name = kind.msgname
    if name in OURS:
        raise VerbError(ExitCode.USAGE, f"{name} is made by this program; send MANUAL_CONTROL")
    if kind in DEMANDS and not confirmed:
        raise VerbError(ExitCode.USAGE, f"{name} can move the vehicle: --yes sends it, and neutral at the end")
    if name in MOVES and not confirmed:
        raise VerbError(ExitCode.USAGE, f"{name} can move the vehicle, and nothing ends it: --yes sends it")
    if kind in DEMANDS and any(not math.isfinite(each) for each in _numbers(values)):
        raise VerbError(ExitCode.USAGE, f"{name}: a demand needs finite numbers")
    if "type_mask" in kind.fieldnames and kind in DEMANDS and "type_mask" not in values:
        raise VerbError(ExitCode.USAGE, f"{name}: give type_mask; 0 would use every field")
    if kind is m.ManualControl:
        _check_axes(values)


def _check_axes(values: Mapping[str, Any]) -> None:
    """Reject what ArduPilot does not clamp: 32766 is full ahead there."""
    for axis in AXES:
        value = values.get(axis, 0)
        if abs(value) > FULL_DEFLECTION and value != INVALID_AXIS:
            raise VerbError(ExitCode.USAGE, f"{axis}: {value} is not -1000 to 1000, or {INVALID_AXIS} for no demand")


def build_demand(kind: type[m.Message], values: Mapping[str, Any], neutral: m.Message) -> m.Message | None:
    """Return the demand in which what is not given is neutral; None for demands whose fields have no neutral."""
    if kind not in (m.ManualControl, m.RcChannelsOverride):
        return None
    if kind is m.RcChannelsOverride:
        message: m.Message = m.RcChannelsOverride(0, 0, *[UINT16_MAX] * 8)
    else:
        message = neutral
    for name, value in values.items():
        setattr(message, name, value)
    return message


def _numbers(values: Mapping[str, Any]) -> list[float]:
    found: list[float] = []
    for value in values.values():
        found += [each for each in (value if isinstance(value, list) else [value]) if isinstance(each, int | float)]
    return found
