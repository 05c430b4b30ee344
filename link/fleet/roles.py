"""Which role of its sender a frame to a vehicle needs. A router grants keys by role, and the vehicle checks the key.

As vehicle/commands decides it for our rover; here also for autopilots that know no roles. Sans-IO.
"""

from __future__ import annotations

from dialects import codec, rover
from dialects import messages as m
from dialects.messages import MESSAGES
from dialects.traits import COMMANDS, is_stop, only_asks
from link.protocol.frame import Frame, payload_of
from link.signing.role import Role

_WATCH = frozenset(
    message.id
    for message in (
        m.Heartbeat, m.Timesync, m.Ping, m.SystemTime, m.CommandAck,
        m.ParamRequestList, m.ParamRequestRead, m.RequestDataStream,
        m.MissionRequestList, m.MissionRequest, m.MissionRequestInt, m.MissionAck,
        m.LogRequestList, m.LogRequestData, m.LogRequestEnd,
    )
)  # fmt: skip
"""Messages that read, or only say who is there."""

_SET_UP = frozenset(
    message.id
    for message in (
        m.ParamSet, m.MissionCount, m.MissionItem, m.MissionItemInt, m.MissionClearAll, m.MissionWritePartialList,
        m.LogErase, m.SetupSigning,
    )
)  # fmt: skip
"""Messages that change parameters, plans, logs or keys."""

_SET_UP_COMMANDS = frozenset(
    (
        rover.MAV_CMD_PREFLIGHT_CALIBRATION,
        rover.MAV_CMD_PREFLIGHT_SET_SENSOR_OFFSETS,
        rover.MAV_CMD_PREFLIGHT_UAVCAN,
        rover.MAV_CMD_PREFLIGHT_STORAGE,
        rover.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
        rover.MAV_CMD_DO_MOTOR_TEST,
        rover.MAV_CMD_ACTUATOR_TEST,
        rover.MAV_CMD_CONFIGURE_ACTUATOR,
        rover.MAV_CMD_STORAGE_FORMAT,
        rover.MAV_CMD_FIXED_MAG_CAL_YAW,
        42424,  # MAV_CMD_DO_START_MAG_CAL of ArduPilot's dialect, and its ACCEPT and CANCEL
        42425,
        42426,
    )
)

_SEND_BANNER = 42428
"""MAV_CMD_DO_SEND_BANNER of ArduPilot's dialect."""

_FILE_OPCODE = 6
"""Offset of the opcode in FILE_TRANSFER_PROTOCOL: three ids of the target, then two bytes of number, one of session."""
_READING_OPCODES = frozenset((0, 1, 2, 3, 4, 5, 14, 15))
"""Of MAV_FTP_OPCODE: none, terminate, reset, list, open, read, CRC, burst (link/services/ftp/protocol.py)."""


def needed_role(frame: Frame) -> Role:
    """Return the least role that may send this frame. An unknown message may do anything, so it needs the highest."""
    number = frame[0]
    if number in _WATCH:
        return Role.WATCH
    if number in _SET_UP or number not in MESSAGES:
        return Role.SET_UP
    if number == m.FileTransferProtocol.id:
        return _needed_for_file(payload_of(frame[4]))
    return _needed_for_command(frame) if number in COMMANDS else Role.DRIVE


def depends_on_content(message_id: int) -> bool:
    """Return whether two frames of this message may need different roles."""
    return message_id in COMMANDS or message_id == m.FileTransferProtocol.id


def _needed_for_file(payload: bytes) -> Role:
    opcode = payload[_FILE_OPCODE] if len(payload) > _FILE_OPCODE else 0  # zeros at the end are not sent
    return Role.WATCH if opcode in _READING_OPCODES else Role.SET_UP


def _needed_for_command(frame: Frame) -> Role:
    message = codec.decode(frame[0], payload_of(frame[4]))
    command = getattr(message, "command", None)
    if is_stop(message) or only_asks(message) or command == _SEND_BANNER:
        return Role.WATCH
    return Role.SET_UP if command in _SET_UP_COMMANDS else Role.DRIVE
