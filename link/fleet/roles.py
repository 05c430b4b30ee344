"""Which role of its sender a frame to a vehicle needs. A router grants keys by role, and the vehicle checks the key.

As vehicle/commands decides it for our rover; here also for autopilots that know no roles. The meaning of a frame can
depend on the autopilot, and on who else transfers: watch_condition() names that, circumstances.py decides it. Sans-IO.
"""

from __future__ import annotations

from enum import Enum

from dialects import codec, rover
from dialects import messages as m
from dialects.messages import MESSAGES, Message, target_system
from dialects.traits import COMMANDS, holds_by_number, is_stop, only_asks
from link.fleet.rights.drive_commands import DRIVE_COMMANDS
from link.protocol.frame import Frame, payload_of
from link.signing.role import SigningRole


class WatchCondition(Enum):
    """When the role watch may send a frame that else needs drive."""

    HOLD = "the vehicle's custom mode 4 is HOLD"
    PLAN = "nobody else transfers a plan"
    LOG = "nobody else downloads a log"
    FILE = "nobody else has a file open"


_WATCH = frozenset(
    message.id
    for message in (
        m.Heartbeat, m.Timesync, m.Ping, m.SystemTime, m.CommandAck,
        m.ParamRequestList, m.ParamRequestRead,
        m.MissionRequestList, m.MissionRequest, m.MissionRequestInt,
        m.LogRequestList, m.LogRequestData,
    )
)  # fmt: skip
"""Messages that read, or only say who is there. REQUEST_DATA_STREAM sets the rates of a whole channel of ArduPilot, and
so of everybody behind the same bridge; SET_MESSAGE_INTERVAL is the way for a watcher."""

_ENDS = {m.MissionAck.id: WatchCondition.PLAN, m.LogRequestEnd.id: WatchCondition.LOG}
"""Messages that end a transfer, of whoever runs it."""

_SET_UP_NAMES = frozenset(
    (
        "PARAM_EXT_SET", "PARAM_MAP_RC", "SERIAL_CONTROL", "TUNNEL", "V2_EXTENSION", "RESOURCE_REQUEST", "AUTH_KEY",
        "SAFETY_SET_ALLOWED_AREA", "WIFI_CONFIG_AP", "CAN_FRAME", "CANFD_FRAME", "CAN_FILTER_MODIFY",
        "HIL_STATE", "HIL_STATE_QUATERNION", "HIL_CONTROLS", "HIL_ACTUATOR_CONTROLS", "HIL_RC_INPUTS_RAW", "HIL_SENSOR",
        "HIL_GPS", "HIL_OPTICAL_FLOW",
    )
)  # fmt: skip
"""Messages without a class of their own that set up: a shell or the ports of an autopilot (SERIAL_CONTROL), its bus,
its sensors (HIL_*), and what a program behind it may understand."""
_SET_UP = frozenset(
    message.id
    for message in (
        m.ParamSet, m.MissionCount, m.MissionItem, m.MissionItemInt, m.MissionClearAll, m.MissionWritePartialList,
        m.LogErase, m.SetupSigning,
    )
) | {number for number, message in MESSAGES.items() if message.msgname in _SET_UP_NAMES}  # fmt: skip
"""Messages that change parameters, plans, logs, keys, or the machine itself."""

_IDS = 1 << 24
"""Ids that a message can have."""
_SEND_BANNER = 42428
"""MAV_CMD_DO_SEND_BANNER of ArduPilot's dialect."""

_FILE_OPCODE = 6
"""Offset of the opcode in FILE_TRANSFER_PROTOCOL: three ids of the target, then two bytes of number, one of session."""
_READING_OPCODES = frozenset((0, 1, 3, 4, 5, 14, 15))
"""Of MAV_FTP_OPCODE: none, terminate, list, open, read, CRC, burst (link/services/ftp/protocol.py)."""
_RESET_SESSIONS = 2
"""Of MAV_FTP_OPCODE: ends the sessions of all who have a file open."""


def needed_role(frame: Frame) -> SigningRole:
    """Return the least role that may send this frame to any vehicle at any time.

    An unknown message or command may do anything, so it needs the highest.
    """
    number = frame[0]
    if number in _WATCH:
        return SigningRole.WATCH
    if number in _SET_UP or number not in MESSAGES:
        return SigningRole.SET_UP
    if number == m.FileTransferProtocol.id:
        return _needed_for_file(frame)
    return _needed_for_command(_decode(frame)) if number in COMMANDS else SigningRole.DRIVE


def watch_condition(frame: Frame) -> WatchCondition | None:
    """Return when the role watch may send a frame, if needed_role() is drive; None: never."""
    number = frame[0]
    if number == m.FileTransferProtocol.id:
        return WatchCondition.FILE if file_opcode(frame) == _RESET_SESSIONS else None
    if number in COMMANDS:
        return WatchCondition.HOLD if holds_by_number(_decode(frame)) else None
    return _ENDS.get(number)


def depends_on_content(message_id: int) -> bool:
    """Return whether two frames of this message may need different roles."""
    return message_id in COMMANDS or message_id == m.FileTransferProtocol.id


def target_of(frame: Frame) -> int:
    """Return the system that a frame is for; 0: all."""
    return target_system(_decode(frame))


def file_opcode(frame: Frame) -> int:
    """Return the opcode of a FILE_TRANSFER_PROTOCOL."""
    payload = payload_of(frame[4])
    return payload[_FILE_OPCODE] if len(payload) > _FILE_OPCODE else 0  # zeros at the end are not sent


def _needed_for_file(frame: Frame) -> SigningRole:
    opcode = file_opcode(frame)
    if opcode in _READING_OPCODES:
        return SigningRole.WATCH
    return SigningRole.DRIVE if opcode == _RESET_SESSIONS else SigningRole.SET_UP


def _needed_for_command(message: Message) -> SigningRole:
    if isinstance(message, m.SetMode):
        return SigningRole.DRIVE
    assert isinstance(message, m.CommandLong | m.CommandInt)
    if message.command == _SEND_BANNER or (is_stop(message) and not holds_by_number(message)):
        return SigningRole.WATCH
    if only_asks(message):
        return SigningRole.DRIVE if _sets_rate_of_heartbeat(message) else SigningRole.WATCH
    if message.command == rover.MAV_CMD_DO_FENCE_ENABLE and message.param1 != 1:
        return SigningRole.SET_UP
    return SigningRole.DRIVE if message.command in DRIVE_COMMANDS else SigningRole.SET_UP


def _sets_rate_of_heartbeat(message: m.CommandLong | m.CommandInt) -> bool:
    """Return whether this may silence the HEARTBEAT of a channel, by which all behind it know the vehicle."""
    if message.command != rover.MAV_CMD_SET_MESSAGE_INTERVAL:
        return False
    # ArduPilot cuts off the fraction of the id, PX4 rounds; NaN and what is too large may be 0.
    return not 1.0 <= message.param1 < _IDS


def _decode(frame: Frame) -> Message:
    return codec.decode(frame[0], payload_of(frame[4]))
