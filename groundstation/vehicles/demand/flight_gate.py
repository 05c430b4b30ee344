"""The last look at a message to what flies: whatever has made it, nothing takes its lift or its way back.

Keys, gamepad, verbs, programs and ROS pass here. The watchdog and the end after a crash send nothing but the neutral
of dialects/axes.py.
"""

from __future__ import annotations

from dialects import messages as m
from dialects import rover
from dialects.axes import FULL_DEFLECTION, HOVER, LOWEST_THROTTLE
from dialects.messages import UINT16_MAX
from dialects.modes import custom_mode_of
from groundstation.vehicles.state.vehicle_state import VehicleState

_COMMANDS = (m.CommandLong, m.CommandInt)
_CHECKED = frozenset((*_COMMANDS, m.ManualControl, m.RcChannelsOverride, m.SetAttitudeTarget, m.SetMode))
_TAKE_OFFS = (rover.MAV_CMD_NAV_TAKEOFF, rover.MAV_CMD_NAV_TAKEOFF_LOCAL, rover.MAV_CMD_MISSION_START)


def is_checked(message: m.Message) -> bool:
    """Return whether `flight_refusal` may refuse messages of this kind."""
    return type(message) in _CHECKED


def flight_refusal(message: m.Message, state: VehicleState, unsafe: str) -> str | None:
    """Return why a message may not be sent to this vehicle, or None.

    `unsafe`: why it may not take off, as Contact.take_off_refusal says; "" if it may.
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
    if isinstance(message, m.SetMode):
        return _mode_refusal(message.custom_mode, state)
    if not isinstance(message, _COMMANDS):
        return None
    if message.command == rover.MAV_CMD_DO_SET_MODE:
        number = custom_mode_of(message.param1, message.param2, message.param3, state.autopilot)
        return _mode_refusal(number, state)
    arms = message.command == rover.MAV_CMD_COMPONENT_ARM_DISARM and message.param1 == 1
    return f"no take-off: {unsafe}" if unsafe and (arms or message.command in _TAKE_OFFS) else None


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


def _mode_refusal(number: int | None, state: VehicleState) -> str | None:
    name = "" if number is None else state.model.modes.get(number, "")
    return f"{name} does not hold its altitude" if name in state.model.thrust and state.may_fall else None
