"""Message -> whose counts and what it does: one table of what the vehicle listens to; the rest is not even decoded.

To listen to another message, add a line here and a handler where the line says. Commands have tables of their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from dialects import messages as m


class Who(Enum):
    """Whose message counts."""

    ANYBODY = "anybody"
    ASKERS = "who has shown a HEARTBEAT, has connected, or is at an address that the user named"
    INTRODUCED = "who has shown a HEARTBEAT"
    DRIVER = "the driver in control"
    NOBODY_ELSE = "the driver in control, or anybody introduced while nobody is"


@dataclass(frozen=True, slots=True)
class Heard:
    """One message."""

    message: type[m.Message]
    who: Who
    what: str
    handler: str
    """The file that acts on it."""


TABLE: tuple[Heard, ...] = (
    Heard(m.Heartbeat, Who.ANYBODY, "introduces its sender", "link/protocol/channel.py"),
    # Demands
    Heard(m.ManualControl, Who.DRIVER, "demand by axes; buttons where BTNn_FUNCTION says so", "vehicle/drive/control.py"),
    Heard(m.RcChannelsOverride, Who.DRIVER, "demand by channels 1 (steering) and 3 (throttle)", "vehicle/drive/control.py"),
    Heard(m.RoverOperatorPresence, Who.DRIVER, "says what the next demand is worth", "vehicle/drive/operator_presence.py"),
    Heard(m.SetPositionTargetLocalNed, Who.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    Heard(m.SetPositionTargetGlobalInt, Who.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    Heard(m.SetAttitudeTarget, Who.DRIVER, "setpoint of GUIDED", "vehicle/autonomy/setpoints.py"),
    # Orders and questions
    Heard(m.CommandLong, Who.ANYBODY, "command, see below", "link/services/command/server.py"),
    Heard(m.CommandInt, Who.ANYBODY, "command, see below", "link/services/command/server.py"),
    Heard(m.CommandCancel, Who.ANYBODY, "ends a command that takes a while, of the same sender",
          "link/services/command/jobs.py"),
    Heard(m.SetMode, Who.NOBODY_ELSE, "as DO_SET_MODE, without an answer; HOLD is everybody's", "vehicle/commands/arming.py"),
    Heard(m.SetGpsGlobalOrigin, Who.NOBODY_ELSE, "as DO_SET_GLOBAL_ORIGIN; answered by GPS_GLOBAL_ORIGIN",
          "vehicle/commands/origin.py"),
    Heard(m.RequestDataStream, Who.INTRODUCED, "rates of a group of streams", "vehicle/telemetry/telemetry.py"),
    Heard(m.SetupSigning, Who.ANYBODY, "is told that signing is not offered; its key is not kept",
          "vehicle/commands/preflight.py"),
    Heard(m.Timesync, Who.ANYBODY, "answered with our clock", "link/services/timesync.py"),
    Heard(m.Ping, Who.ANYBODY, "answered", "link/services/timesync.py"),
    Heard(m.RadioStatus, Who.ANYBODY, "a full radio slows telemetry down", "link/protocol/flow_control.py, vehicle/telemetry/telemetry.py"),
    # Parameters
    Heard(m.ParamRequestList, Who.ASKERS, "all PARAM_VALUE, paced", "link/services/param/server.py"),
    Heard(m.ParamRequestRead, Who.ASKERS, "PARAM_VALUE, or PARAM_ERROR", "link/services/param/server.py"),
    Heard(m.ParamSet, Who.NOBODY_ELSE, "PARAM_VALUE; PARAM_ERROR before it where it is refused",
          "link/services/param/server.py"),
    # Plans
    Heard(m.MissionRequestList, Who.ASKERS, "MISSION_COUNT", "link/services/mission/download.py"),
    Heard(m.MissionRequestInt, Who.ASKERS, "MISSION_ITEM_INT", "link/services/mission/download.py"),
    Heard(m.MissionRequest, Who.ASKERS, "MISSION_ITEM", "link/services/mission/download.py"),
    Heard(m.MissionRequestPartialList, Who.ASKERS, "the items of a part", "link/services/mission/download.py"),
    Heard(m.MissionCount, Who.NOBODY_ELSE, "begins an upload: MISSION_REQUEST_INT", "link/services/mission/server.py"),
    Heard(m.MissionWritePartialList, Who.NOBODY_ELSE, "begins an upload of a part", "link/services/mission/server.py"),
    Heard(m.MissionItemInt, Who.NOBODY_ELSE, "item of an upload", "link/services/mission/server.py"),
    Heard(m.MissionItem, Who.NOBODY_ELSE, "item of an upload", "link/services/mission/server.py"),
    Heard(m.MissionAck, Who.INTRODUCED, "ends one's own upload", "link/services/mission/server.py"),
    Heard(m.MissionClearAll, Who.NOBODY_ELSE, "clears one plan or all", "link/services/mission/server.py"),
    Heard(m.MissionSetCurrent, Who.NOBODY_ELSE, "chooses the next item: MISSION_CURRENT", "link/services/mission/server.py"),
    # Files and logs
    Heard(m.FileTransferProtocol, Who.ASKERS, "files; writing is the driver's", "link/services/ftp/server.py"),
    Heard(m.LogRequestList, Who.ASKERS, "LOG_ENTRY for each", "link/services/log/server.py"),
    Heard(m.LogRequestData, Who.ASKERS, "LOG_DATA", "link/services/log/server.py"),
    Heard(m.LogRequestEnd, Who.ASKERS, "ends LOG_DATA", "link/services/log/server.py"),
    Heard(m.LogErase, Who.NOBODY_ELSE, "erases the logs while disarmed", "link/services/log/server.py"),
)  # fmt: skip

HEARD: frozenset[int] = frozenset(heard.message.id for heard in TABLE)
"""Ids of what is worth decoding when it arrives."""
