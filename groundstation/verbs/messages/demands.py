"""Messages that can move a vehicle: which they are, their limits, and the neutral that ends them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from dialects import messages as m
from dialects.axes import FULL_DEFLECTION
from dialects.messages import INVALID_AXIS, UINT16_MAX
from groundstation.vehicles.demand.demand_neutrals import DEMANDS
from groundstation.verbs.common.exit_codes import ExitCode, VerbError

AXES = ("x", "y", "z", "r")

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
        raise VerbError(ExitCode.USAGE, f"{name} can move the vehicle and has no end; add --yes to send it")
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
