"""Message -> whose counts and what it does: one table of what the vehicle listens to; the rest is not even decoded.

To listen to another message, add a line here and a handler where the line says. Commands have tables of their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from dialects import messages as m


class Access(Enum):
    """Whose message counts."""

    ANYBODY = "anybody"
    CONNECTED = "who has shown a HEARTBEAT, has connected, or is at an address that the user named"
    INTRODUCED = "who has shown a HEARTBEAT"
    DRIVER = "the driver in control"
    DRIVER_OR_UNCLAIMED = "the driver in control, or anybody introduced while nobody is"


@dataclass(frozen=True, slots=True)
class InboundMessage:
    """One message."""

    message: type[m.Message]
    access: Access
    description: str
    handler: str
    """The file that acts on it."""


INBOUND_MESSAGES: tuple[InboundMessage, ...] = (
    InboundMessage(m.Heartbeat, Access.ANYBODY, "introduces its sender", "link/protocol/channel.py"),
    # Demands
    InboundMessage(m.ManualControl, Access.DRIVER, "demand by axes; buttons where BTNn_FUNCTION says so", "vehicle/drive/control.py"),
    InboundMessage(m.RcChannelsOverride, Access.DRIVER, "demand by channels 1 (steering) and 3 (throttle)", "vehicle/drive/control.py"),
    InboundMessage(m.RoverOperatorPresence, Access.DRIVER, "says what the next demand is worth", "vehicle/drive/operator_presence.py"),
    InboundMessage(m.SetPositionTargetLocalNed, Access.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    InboundMessage(m.SetPositionTargetGlobalInt, Access.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    InboundMessage(m.SetAttitudeTarget, Access.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    # Orders and questions
    InboundMessage(m.CommandLong, Access.ANYBODY, "command, see below", "link/services/command/server.py"),
    InboundMessage(m.CommandInt, Access.ANYBODY, "command, see below", "link/services/command/server.py"),
    InboundMessage(m.CommandCancel, Access.ANYBODY, "ends a command that takes a while, of the same sender",
          "link/services/command/jobs.py"),
    InboundMessage(m.SetMode, Access.DRIVER_OR_UNCLAIMED, "as DO_SET_MODE, without an answer; HOLD is everybody's", "vehicle/commands/arming.py"),
    InboundMessage(m.SetGpsGlobalOrigin, Access.DRIVER_OR_UNCLAIMED, "as DO_SET_GLOBAL_ORIGIN; answered by GPS_GLOBAL_ORIGIN",
          "vehicle/commands/origin.py"),
    InboundMessage(m.RequestDataStream, Access.INTRODUCED, "rates of a group of streams", "vehicle/telemetry/telemetry.py"),
    InboundMessage(m.SetupSigning, Access.ANYBODY, "is told that signing is not offered; its key is not kept",
          "vehicle/commands/preflight.py"),
    InboundMessage(m.Timesync, Access.ANYBODY, "answered with our clock", "link/services/timesync.py"),
    InboundMessage(m.Ping, Access.ANYBODY, "answered", "link/services/timesync.py"),
    InboundMessage(m.RadioStatus, Access.ANYBODY, "a full radio slows telemetry down", "link/protocol/flow_control.py, vehicle/telemetry/telemetry.py"),
    # Parameters
    InboundMessage(m.ParamRequestList, Access.CONNECTED, "all PARAM_VALUE, paced", "link/services/param/server.py"),
    InboundMessage(m.ParamRequestRead, Access.CONNECTED, "PARAM_VALUE, or PARAM_ERROR", "link/services/param/server.py"),
    InboundMessage(m.ParamSet, Access.DRIVER_OR_UNCLAIMED, "PARAM_VALUE; PARAM_ERROR before it where it is refused",
          "link/services/param/server.py"),
    # Plans
    InboundMessage(m.MissionRequestList, Access.CONNECTED, "MISSION_COUNT", "link/services/mission/download.py"),
    InboundMessage(m.MissionRequestInt, Access.CONNECTED, "MISSION_ITEM_INT", "link/services/mission/download.py"),
    InboundMessage(m.MissionRequest, Access.CONNECTED, "MISSION_ITEM", "link/services/mission/download.py"),
    InboundMessage(m.MissionRequestPartialList, Access.CONNECTED, "the items of a part", "link/services/mission/download.py"),
    InboundMessage(m.MissionCount, Access.DRIVER_OR_UNCLAIMED, "begins an upload: MISSION_REQUEST_INT", "link/services/mission/server.py"),
    InboundMessage(m.MissionWritePartialList, Access.DRIVER_OR_UNCLAIMED, "begins an upload of a part", "link/services/mission/server.py"),
    InboundMessage(m.MissionItemInt, Access.DRIVER_OR_UNCLAIMED, "item of an upload", "link/services/mission/server.py"),
    InboundMessage(m.MissionItem, Access.DRIVER_OR_UNCLAIMED, "item of an upload", "link/services/mission/server.py"),
    InboundMessage(m.MissionAck, Access.INTRODUCED, "ends one's own upload", "link/services/mission/server.py"),
    InboundMessage(m.MissionClearAll, Access.DRIVER_OR_UNCLAIMED, "clears one plan or all", "link/services/mission/server.py"),
    InboundMessage(m.MissionSetCurrent, Access.DRIVER_OR_UNCLAIMED, "chooses the next item: MISSION_CURRENT", "link/services/mission/server.py"),
    # Files and logs
    InboundMessage(m.FileTransferProtocol, Access.CONNECTED, "files; writing is the driver's", "link/services/ftp/server.py"),
    InboundMessage(m.LogRequestList, Access.CONNECTED, "LOG_ENTRY for each", "link/services/log/server.py"),
    InboundMessage(m.LogRequestData, Access.CONNECTED, "LOG_DATA", "link/services/log/server.py"),
    InboundMessage(m.LogRequestEnd, Access.CONNECTED, "ends LOG_DATA", "link/services/log/server.py"),
    InboundMessage(m.LogErase, Access.DRIVER_OR_UNCLAIMED, "erases the logs while disarmed", "link/services/log/server.py"),
)  # fmt: skip

INBOUND_IDS: frozenset[int] = frozenset(heard.message.id for heard in INBOUND_MESSAGES)
"""Ids of what is worth decoding when it arrives."""
