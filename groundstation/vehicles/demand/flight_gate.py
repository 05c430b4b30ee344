"""The last look at a message to what flies: whatever has made it, nothing takes its lift or its way back.

Keys, gamepad, verbs, programs and ROS pass here. The watchdog and the end after a crash send nothing but the neutral
of dialects/axes.py.
"""

from __future__ import annotations

from dialects import messages as m
from dialects import rover
from dialects.axes import FULL_DEFLECTION, HOVER, LOWEST_THROTTLE
from dialects.enums import Autopilot
from dialects.messages import UINT16_MAX
from dialects.modes import custom_mode_of
from groundstation.vehicles.demand.demand_neutrals import VELOCITY_ONLY
from groundstation.vehicles.demand.drive_gate import GUIDED_ITEMS, MOVING_COMMANDS
from groundstation.vehicles.demand.take_off import find_fence_refusal
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.vehicles.stops.altitude_fence import AltitudeFence

_COMMANDS = (m.CommandLong, m.CommandInt)
_ITEMS = (m.MissionItem, m.MissionItemInt)
_POSITIONS = (m.SetPositionTargetLocalNed, m.SetPositionTargetGlobalInt)
CHECKED = frozenset(
    (*_COMMANDS, *_ITEMS, *_POSITIONS, m.ManualControl, m.RcChannelsOverride, m.SetAttitudeTarget, m.SetMode)
)
"""Kinds of messages that `flight_refusal` may refuse."""
_TAKE_OFFS = (rover.MAV_CMD_NAV_TAKEOFF, rover.MAV_CMD_NAV_TAKEOFF_LOCAL)
_NOT_BY_US = MOVING_COMMANDS - {
    rover.MAV_CMD_COMPONENT_ARM_DISARM, rover.MAV_CMD_DO_PAUSE_CONTINUE, rover.MAV_CMD_CONDITION_YAW, *_TAKE_OFFS,
}  # fmt: skip
"""Commands that move it, made for what stays on the ground: their altitude is 0, and motor tests turn propellers."""


def flight_refusal(
    message: m.Message, state: VehicleState, unsafe: str, fence: AltitudeFence | None = None
) -> str | None:
    """Return why a message may not be sent to this vehicle, or None.

    `unsafe`: why it may not take off, as Contact.take_off_refusal says; "" if it may. `fence`: its altitude fence.
    """
    if not state.model.flies:
        return None
    if isinstance(message, m.ManualControl):
        return _demand_refusal(message, state)
    if isinstance(message, m.RcChannelsOverride):
        channels = (getattr(message, name) for name in message.fieldnames if name.startswith("chan"))
        released = all(channel in (0, UINT16_MAX) for channel in channels)
        return None if released else "RC_CHANNELS_OVERRIDE is not sent to what flies; send MANUAL_CONTROL"
    if isinstance(message, m.SetAttitudeTarget):
        return "SET_ATTITUDE_TARGET is not sent to what flies: its thrust may let it fall"
    if isinstance(message, _POSITIONS):
        return None if _is_hover(message) else f"{message.get_type()} is not sent to what flies: keys fly it"
    if isinstance(message, _ITEMS):
        return "a place to fly to is not sent: keys fly it" if message.current in GUIDED_ITEMS else None
    if isinstance(message, m.SetMode):
        return _mode_refusal(message.custom_mode, state)
    return _command_refusal(message, state, unsafe, fence) if isinstance(message, _COMMANDS) else None


def _fence_refusal(
    message: m.CommandLong | m.CommandInt, state: VehicleState, fence: AltitudeFence | None
) -> str | None:
    """Return why a take-off may not go so high; PX4 takes the altitude above mean sea level."""
    if message.command not in _TAKE_OFFS:
        return None
    ground = (state.sea_level or 0.0) if state.autopilot == Autopilot.PX4 else 0.0
    height = (message.param7 if isinstance(message, m.CommandLong) else message.z) - ground
    return find_fence_refusal(round(height, 1), fence) or None


def _command_refusal(
    message: m.CommandLong | m.CommandInt, state: VehicleState, unsafe: str, fence: AltitudeFence | None
) -> str | None:
    if message.command in _NOT_BY_US:
        return "this command is not sent to what flies: keys fly it"
    if message.command == rover.MAV_CMD_DO_SET_MODE:
        number = custom_mode_of(message.param1, message.param2, message.param3, state.autopilot)
        return _mode_refusal(number, state)
    arms = message.command == rover.MAV_CMD_COMPONENT_ARM_DISARM and message.param1 == 1
    if unsafe and (arms or message.command in _TAKE_OFFS):
        return f"no take-off: {unsafe}"
    return _fence_refusal(message, state, fence)


def _demand_refusal(message: m.ManualControl, state: VehicleState) -> str | None:
    """Return why a demand may not be sent. Neutral may: without it the last demand goes on."""
    axes = (message.x, message.y, message.r)
    if message.z == HOVER and not any(axes):
        return None
    if state.mode not in state.model.keys:
        return f"keys do not fly it in {state.mode}"
    if not LOWEST_THROTTLE <= message.z <= FULL_DEFLECTION:
        return f"z {message.z} is not {LOWEST_THROTTLE} to {FULL_DEFLECTION}: it would sink too fast"
    return None if max(map(abs, axes)) <= FULL_DEFLECTION else "an axis is not -1000 to 1000"


def _is_hover(message: m.SetPositionTargetLocalNed | m.SetPositionTargetGlobalInt) -> bool:
    """Return whether this is the neutral of demand_neutrals.py: velocity 0, and nothing else counts."""
    return message.type_mask == VELOCITY_ONLY and not any((message.vx, message.vy, message.vz))


def _mode_refusal(number: int | None, state: VehicleState) -> str | None:
    name = "" if number is None else state.model.modes.get(number, "")
    return f"{name} does not hold its altitude" if name in state.model.thrust and state.may_fall else None
