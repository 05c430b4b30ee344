"""The neutral that ends each kind of demand: of a verb, or sent in its place by the station it went through."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from dialects import messages as m
from dialects.axes import build_neutral
from dialects.messages import UINT16_MAX, boot_ms
from groundstation.vehicles.state.vehicle_state import VehicleState

Neutral = Callable[[VehicleState, Mapping[str, Any], float], list[m.Message]]
"""Returns what ends a demand with these values, in order. Takes the time in s."""

VELOCITY_ONLY = 0x0DC7
"""POSITION_TARGET_TYPEMASK that ignores position, acceleration, yaw and yaw rate."""
CENTRE, RELEASE = 1500, 0
"""us of a channel of RC_CHANNELS_OVERRIDE at rest, and what gives it back to the receiver."""


def _neutral_manual(state: VehicleState, values: Mapping[str, Any], now: float) -> list[m.Message]:
    return [build_neutral(state.system, state.autopilot, state.kind)]


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
    if state.model.falls:  # no thrust would let it fall: velocity 0 holds it, of ArduCopter and of PX4
        return _neutral_local(state, {}, now)
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
