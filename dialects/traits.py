"""Message traits: how each message is queued, limited, forwarded and logged.

A message that is not in TRAITS is plain state, as telemetry is. To give a message another treatment, add or change its
row; the transmit queue, the channel, the router and the recorders all read the sets that are built from this table.
"""

from __future__ import annotations

import math
from enum import Flag, auto

from dialects import messages as m
from dialects import rover
from dialects.modes import Mode


class Trait(Flag):
    """One property of a message. Each message has exactly one of STATE and ACKED."""

    STATE = auto()
    """Only the newest counts: one that a newer one has overtaken is dropped."""
    ACKED = auto()
    """Repeated until acknowledged, or sent once: never dropped for being late."""
    URGENT = auto()
    """Overtakes all other messages that wait to be sent. Urgent state waits only once: the newest replaces it."""
    DEMAND = auto()
    """A manual demand: has the rate limit of demands."""
    COMMAND = auto()
    """A command: has the rate limit of commands, which a stop passes."""
    LOCAL = auto()
    """Concerns one link only and is never forwarded."""
    UNLOGGED = auto()
    """Our own are left out of telemetry logs: a log that is read while it is written would grow by what is read."""
    SECRET = auto()
    """Holds a key: left out of every log, whoever sent it."""
    LOG_ONLY = auto()
    """A note of the program that writes a log. It is on no link: one that arrives is neither obeyed nor recorded."""


_STATE, _ACKED, _URGENT, _DEMAND, _COMMAND = Trait.STATE, Trait.ACKED, Trait.URGENT, Trait.DEMAND, Trait.COMMAND
_LOCAL, _UNLOGGED, _SECRET, _LOG_ONLY = Trait.LOCAL, Trait.UNLOGGED, Trait.SECRET, Trait.LOG_ONLY

TRAITS: dict[type[m.Message], Trait] = {
    # Demands and what keeps them valid
    m.ManualControl: _STATE | _URGENT | _DEMAND,
    m.RcChannelsOverride: _STATE | _URGENT | _DEMAND,
    m.RoverOperatorPresence: _STATE | _URGENT | _DEMAND,
    m.SetPositionTargetLocalNed: _STATE | _URGENT,
    m.SetPositionTargetGlobalInt: _STATE | _URGENT,
    m.SetAttitudeTarget: _STATE | _URGENT,
    m.Heartbeat: _STATE | _URGENT,
    # Commands
    m.CommandLong: _ACKED | _URGENT | _COMMAND,
    m.CommandInt: _ACKED | _URGENT | _COMMAND,
    m.SetMode: _ACKED | _URGENT | _COMMAND,
    m.CommandAck: _ACKED | _URGENT,
    m.CommandCancel: _ACKED,
    # Sent once, or answered
    m.StatusText: _ACKED,
    m.Timesync: _ACKED,
    m.Ping: _ACKED,
    m.MissionItemReached: _ACKED,
    m.ComponentMetadata: _ACKED,
    # Parameters
    m.ParamRequestList: _ACKED,
    m.ParamRequestRead: _ACKED,
    m.ParamSet: _ACKED,
    m.ParamValue: _ACKED,
    m.ParamError: _ACKED,
    # Missions
    m.MissionRequestList: _ACKED,
    m.MissionRequestPartialList: _ACKED,
    m.MissionWritePartialList: _ACKED,
    m.MissionCount: _ACKED,
    m.MissionRequest: _ACKED,
    m.MissionRequestInt: _ACKED,
    m.MissionItem: _ACKED,
    m.MissionItemInt: _ACKED,
    m.MissionAck: _ACKED,
    m.MissionClearAll: _ACKED,
    m.MissionSetCurrent: _ACKED,
    # Files and logs
    m.FileTransferProtocol: _ACKED | _UNLOGGED,
    m.LogEntry: _ACKED | _UNLOGGED,
    m.LogData: _ACKED | _UNLOGGED,
    m.LogRequestList: _ACKED,
    m.LogRequestData: _ACKED,
    m.LogErase: _ACKED,
    m.LogRequestEnd: _ACKED,
    # Of one link
    m.RadioStatus: _STATE | _LOCAL,
    m.SetupSigning: _STATE | _LOCAL | _UNLOGGED | _SECRET,
    # Of logs only
    m.RoverStationEvent: _ACKED | _LOCAL | _LOG_ONLY,
}
"""Message -> its traits. A message that is not listed has STATE."""


def ids_with(traits: Trait) -> frozenset[int]:
    """Return the ids of the listed messages that have all of `traits`."""
    return frozenset(message.id for message, each in TRAITS.items() if traits in each)


ACKED = ids_with(Trait.ACKED)
URGENT = ids_with(Trait.URGENT)
NEWEST_ONLY = ids_with(Trait.STATE | Trait.URGENT)
DEMANDS = ids_with(Trait.DEMAND)
COMMANDS = ids_with(Trait.COMMAND)
LOCAL = ids_with(Trait.LOCAL)
UNLOGGED = ids_with(Trait.UNLOGGED)
SECRET = ids_with(Trait.SECRET)
LOG_ONLY = ids_with(Trait.LOG_ONLY)


_STOPS_AT_ZERO = (
    rover.MAV_CMD_COMPONENT_ARM_DISARM,
    rover.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE,
    rover.MAV_CMD_DO_PAUSE_CONTINUE,
)
"""Commands that stop if parameter 1 is 0."""


def is_stop(message: m.Message) -> bool:
    """Return whether this only stops: disarm, safety switch to SAFE, termination, pause, ArduRover's HOLD.

    HOLD as our vehicle and ArduRover understand it. Where a stop needs no permission, ask whether this is such a
    vehicle: the same numbers are a mission of PX4, and GUIDED of ArduCopter (link/fleet/rights/circumstances.py).
    """
    if holds_by_number(message):
        return True
    if not isinstance(message, m.CommandLong | m.CommandInt):
        return False
    if message.command == rover.MAV_CMD_DO_FLIGHTTERMINATION:
        return bool(message.param1 > 0.5)
    return message.command in _STOPS_AT_ZERO and bool(message.param1 == 0)


def holds_by_number(message: m.Message) -> bool:
    """Return whether this selects the custom mode 4, which is HOLD of our vehicle and of ArduRover."""
    if isinstance(message, m.SetMode):
        return _holds(message.base_mode, message.custom_mode, 0.0)
    if not isinstance(message, m.CommandLong | m.CommandInt) or message.command != rover.MAV_CMD_DO_SET_MODE:
        return False
    return _holds(message.param1, message.param2, message.param3)


_ASKS = (
    rover.MAV_CMD_REQUEST_MESSAGE,
    rover.MAV_CMD_SET_MESSAGE_INTERVAL,
    rover.MAV_CMD_GET_MESSAGE_INTERVAL,
    rover.MAV_CMD_REQUEST_PROTOCOL_VERSION,
    rover.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES,
    rover.MAV_CMD_GET_HOME_POSITION,
    rover.MAV_CMD_RUN_PREARM_CHECKS,
)
"""Commands that ask for messages, rates and checks."""


def only_asks(message: m.Message) -> bool:
    """Return whether this is a command that changes nothing but what is sent to its sender."""
    return isinstance(message, m.CommandLong | m.CommandInt) and message.command in _ASKS


def _holds(base: float, custom: float, sub: float) -> bool:
    """Return whether a mode is HOLD by its custom mode; with a third parameter it is another one (PX4)."""
    by_custom = math.isfinite(base) and bool(int(base) & rover.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
    return by_custom and bool(custom == Mode.HOLD) and (sub == 0 or math.isnan(sub))
