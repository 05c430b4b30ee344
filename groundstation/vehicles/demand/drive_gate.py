"""The last look at a message before it is sent: nothing moves a vehicle of a kind that is not driven.

Front ends refuse earlier, with a better text. Here every message of a program passes, whoever has made it. Stops,
questions and set-up pass; so do the modes that the vehicle lists itself, and the ways down: return and land.
"""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from dialects import rover
from dialects.enums import OperatorFlag
from dialects.modes import custom_mode_of
from dialects.traits import is_stop
from groundstation.vehicles.demand.demand_neutrals import DEMANDS
from groundstation.vehicles.state.vehicle_state import VehicleState

MOVING_COMMANDS = frozenset(
    (
        rover.MAV_CMD_COMPONENT_ARM_DISARM,
        rover.MAV_CMD_NAV_WAYPOINT,
        rover.MAV_CMD_NAV_TAKEOFF,
        rover.MAV_CMD_NAV_TAKEOFF_LOCAL,
        rover.MAV_CMD_NAV_VTOL_TAKEOFF,
        rover.MAV_CMD_NAV_GUIDED_ENABLE,
        rover.MAV_CMD_NAV_SET_YAW_SPEED,
        rover.MAV_CMD_DO_ORBIT,
        rover.MAV_CMD_DO_FIGURE_EIGHT,
        rover.MAV_CMD_CONDITION_YAW,
        rover.MAV_CMD_DO_CHANGE_SPEED,
        rover.MAV_CMD_DO_SET_SERVO,
        rover.MAV_CMD_DO_REPEAT_SERVO,
        rover.MAV_CMD_DO_SET_ACTUATOR,
        rover.MAV_CMD_DO_REPOSITION,
        rover.MAV_CMD_DO_PAUSE_CONTINUE,
        rover.MAV_CMD_DO_SET_REVERSE,
        rover.MAV_CMD_DO_MOTOR_TEST,
        rover.MAV_CMD_ACTUATOR_TEST,
        rover.MAV_CMD_MISSION_START,
        rover.MAV_CMD_DO_VTOL_TRANSITION,
        42600,  # MAV_CMD_DO_WINCH
        43000,  # MAV_CMD_GUIDED_CHANGE_SPEED of ArduPilot's dialect, and ..._ALTITUDE, ..._HEADING
        43001,
        43002,
    )
)
"""Commands that arm, start a motion, steer or turn motors."""

GUIDED_ITEMS = (2, 3)
"""`current` of MISSION_ITEM: go there now, or change the altitude (ArduPilot)."""

_DEMANDS = frozenset(
    (
        *DEMANDS, m.RoverOperatorPresence,
        *(kind for kind in m.MESSAGES.values() if kind.msgname in {
            "MANUAL_SETPOINT", "SET_ACTUATOR_CONTROL_TARGET", "HIL_CONTROLS", "HIL_ACTUATOR_CONTROLS",
        }),
    )
)  # fmt: skip
_COMMANDS = (m.CommandLong, m.CommandInt)
_ITEMS = (m.MissionItem, m.MissionItemInt)
CHECKED = frozenset((*_DEMANDS, *_COMMANDS, *_ITEMS, m.SetMode))
"""Kinds of messages that `drive_refusal` may refuse."""

NOT_HEARD = "no vehicle with this id was heard"


def drive_refusal(message: m.Message, meant: Sequence[VehicleState]) -> str | None:
    """Return why a message may not be sent, or None. `meant`: the vehicles that are heard and that it is for."""
    if type(message) not in CHECKED:
        return None
    if not meant:
        return NOT_HEARD if moves(message, None) else None
    for state in meant:
        if state.model.refusal and moves(message, state):
            return state.model.refusal
    return None


def moves(message: m.Message, state: VehicleState | None) -> bool:
    """Return whether a message may move a vehicle of a kind that is not driven, or that was not heard."""
    if isinstance(message, m.SetMode):
        return not _lists(state, message.custom_mode)
    if isinstance(message, m.RoverOperatorPresence):
        return bool(message.flags & OperatorFlag.AXES)
    if isinstance(message, _ITEMS):
        return message.current in GUIDED_ITEMS
    if not isinstance(message, _COMMANDS):
        return True
    if message.command == rover.MAV_CMD_DO_SET_MODE:
        return not _lists(state, _custom_mode(message, state))
    return message.command in MOVING_COMMANDS and not is_stop(message)


def _lists(state: VehicleState | None, custom_mode: int | None) -> bool:
    return state is not None and custom_mode is not None and custom_mode in state.listed_modes


def _custom_mode(message: m.CommandLong | m.CommandInt, state: VehicleState | None) -> int | None:
    """Return the custom_mode of DO_SET_MODE; None if it is none."""
    return custom_mode_of(message.param1, message.param2, message.param3, 0 if state is None else state.autopilot)
