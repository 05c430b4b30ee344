"""The messages that the programs use, under short names: pymavlink's generated classes, not wrapped.

To use another message, add one line here; its fields are those of the official definition (or of rover.xml). A message
that is not plain state also needs a row in traits.py.
"""

from __future__ import annotations

from typing import Any

from dialects import rover
from dialects.printable import printable

Message = rover.MAVLink_message


class ExtraMessage(Message):
    """A message of a user's dialect (dialects/extra).

    Its fields are not attributes: no code that asks any message for `target_system` or `time_boot_ms` may read a field
    that only has this name, with a type and a meaning of its own.
    """

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__(type(self).id, type(self).msgname)
        self.values = values
        """Name of a field -> its value. A text is bytes without its trailing zeros, another array a list."""


# Both directions
Heartbeat = rover.MAVLink_heartbeat_message
Timesync = rover.MAVLink_timesync_message
Ping = rover.MAVLink_ping_message
StatusText = rover.MAVLink_statustext_message
CommandLong = rover.MAVLink_command_long_message
CommandInt = rover.MAVLink_command_int_message
CommandAck = rover.MAVLink_command_ack_message
SetupSigning = rover.MAVLink_setup_signing_message
CommandCancel = rover.MAVLink_command_cancel_message
SystemTime = rover.MAVLink_system_time_message
RadioStatus = rover.MAVLink_radio_status_message

# Demands
ManualControl = rover.MAVLink_manual_control_message
RcChannelsOverride = rover.MAVLink_rc_channels_override_message
SetPositionTargetLocalNed = rover.MAVLink_set_position_target_local_ned_message
SetPositionTargetGlobalInt = rover.MAVLink_set_position_target_global_int_message
SetAttitudeTarget = rover.MAVLink_set_attitude_target_message
SetMode = rover.MAVLink_set_mode_message
SetGpsGlobalOrigin = rover.MAVLink_set_gps_global_origin_message
RoverOperatorPresence = rover.MAVLink_rover_operator_presence_message

# Parameters, missions, files, logs
ParamRequestList = rover.MAVLink_param_request_list_message
ParamRequestRead = rover.MAVLink_param_request_read_message
ParamSet = rover.MAVLink_param_set_message
ParamValue = rover.MAVLink_param_value_message
ParamError = rover.MAVLink_param_error_message
RequestDataStream = rover.MAVLink_request_data_stream_message
MessageInterval = rover.MAVLink_message_interval_message
MissionRequestList = rover.MAVLink_mission_request_list_message
MissionRequestPartialList = rover.MAVLink_mission_request_partial_list_message
MissionWritePartialList = rover.MAVLink_mission_write_partial_list_message
MissionCount = rover.MAVLink_mission_count_message
MissionRequest = rover.MAVLink_mission_request_message
MissionRequestInt = rover.MAVLink_mission_request_int_message
MissionItem = rover.MAVLink_mission_item_message
MissionItemInt = rover.MAVLink_mission_item_int_message
MissionAck = rover.MAVLink_mission_ack_message
MissionClearAll = rover.MAVLink_mission_clear_all_message
MissionSetCurrent = rover.MAVLink_mission_set_current_message
MissionCurrent = rover.MAVLink_mission_current_message
MissionItemReached = rover.MAVLink_mission_item_reached_message
FileTransferProtocol = rover.MAVLink_file_transfer_protocol_message
LogRequestList = rover.MAVLink_log_request_list_message
LogEntry = rover.MAVLink_log_entry_message
LogRequestData = rover.MAVLink_log_request_data_message
LogData = rover.MAVLink_log_data_message
LogErase = rover.MAVLink_log_erase_message
CameraInformation = rover.MAVLink_camera_information_message
VideoStreamInformation = rover.MAVLink_video_stream_information_message
VideoStreamStatus = rover.MAVLink_video_stream_status_message
MagCalProgress = rover.MAVLink_mag_cal_progress_message
MagCalReport = rover.MAVLink_mag_cal_report_message
LogRequestEnd = rover.MAVLink_log_request_end_message
ComponentMetadata = rover.MAVLink_component_metadata_message

# Telemetry
SysStatus = rover.MAVLink_sys_status_message
BatteryStatus = rover.MAVLink_battery_status_message
Attitude = rover.MAVLink_attitude_message
VfrHud = rover.MAVLink_vfr_hud_message
LocalPositionNed = rover.MAVLink_local_position_ned_message
GlobalPositionInt = rover.MAVLink_global_position_int_message
GpsRawInt = rover.MAVLink_gps_raw_int_message
ServoOutputRaw = rover.MAVLink_servo_output_raw_message
ActuatorOutputStatus = rover.MAVLink_actuator_output_status_message
RelayStatus = rover.MAVLink_relay_status_message
RcChannels = rover.MAVLink_rc_channels_message
AttitudeQuaternion = rover.MAVLink_attitude_quaternion_message
RawImu = rover.MAVLink_raw_imu_message
ScaledImu = rover.MAVLink_scaled_imu_message
HighresImu = rover.MAVLink_highres_imu_message
Odometry = rover.MAVLink_odometry_message
Altitude = rover.MAVLink_altitude_message
EstimatorStatus = rover.MAVLink_estimator_status_message
EkfStatusReport = rover.MAVLink_ekf_status_report_message
Vibration = rover.MAVLink_vibration_message
PositionTargetGlobalInt = rover.MAVLink_position_target_global_int_message
PositionTargetLocalNed = rover.MAVLink_position_target_local_ned_message
NavControllerOutput = rover.MAVLink_nav_controller_output_message
FenceStatus = rover.MAVLink_fence_status_message
GpsGlobalOrigin = rover.MAVLink_gps_global_origin_message
HomePosition = rover.MAVLink_home_position_message
DistanceSensor = rover.MAVLink_distance_sensor_message
ObstacleDistance = rover.MAVLink_obstacle_distance_message
OnboardComputerStatus = rover.MAVLink_onboard_computer_status_message
ExtendedSysState = rover.MAVLink_extended_sys_state_message
AutopilotVersion = rover.MAVLink_autopilot_version_message
ProtocolVersion = rover.MAVLink_protocol_version_message
AvailableModes = rover.MAVLink_available_modes_message
AvailableModesMonitor = rover.MAVLink_available_modes_monitor_message
CurrentMode = rover.MAVLink_current_mode_message
ControlStatus = rover.MAVLink_control_status_message
RoverDriveStatus = rover.MAVLink_rover_drive_status_message
RoverFailsafeStatus = rover.MAVLink_rover_failsafe_status_message
RoverLinkStatus = rover.MAVLink_rover_link_status_message
RoverDriveInfo = rover.MAVLink_rover_drive_info_message
RoverControl = rover.MAVLink_rover_control_message

# Written to logs only
RoverStationEvent = rover.MAVLink_rover_station_event_message

MESSAGES: dict[int, type[Message]] = rover.mavlink_map
"""Every message of the dialect by id."""


def read_by_programs() -> frozenset[int]:
    """Return the ids of the messages above, of which the programs read the fields."""
    return frozenset(each.id for each in globals().values() if isinstance(each, type) and issubclass(each, Message))


INVALID_AXIS = 32767
"""INT16_MAX on an axis of MANUAL_CONTROL: "no demand on this axis" (common.xml, MANUAL_CONTROL)."""

UINT16_MAX = 65535
UINT32_MASK = 0xFFFFFFFF


def boot_ms(seconds: float) -> int:
    """Return `time_boot_ms` for s since boot; wraps after 49.7 days as the field does (pymavlink raises)."""
    return int(seconds * 1000) & UINT32_MASK


MISSION_PAUSED = rover.MISSION_STATE_PAUSED
"""`mission_state` of MISSION_CURRENT."""


def decode_text(message: StatusText | RoverStationEvent) -> str:
    """Return the text as UTF-8 (the generated decoder knows only ASCII), with control characters replaced.

    A text in chunks is joined before it is decoded: groundstation/vehicles/state/chunked_texts.py.
    """
    raw: bytes = message._text_raw
    return decode_bytes(raw.split(b"\0", 1)[0])


def decode_bytes(raw: bytes) -> str:
    """Return the bytes of a text as UTF-8 in one line: white space is a blank, none is at the end.

    The text goes to a terminal: an escape sequence in it must not reach the screen as one. PX4 ends a text with a tab
    if an EVENT says the same.
    """
    return printable(raw.rstrip(b"\t\r\n").decode("utf-8", "replace").translate(_BLANKS))


_BLANKS = dict.fromkeys(map(ord, "\t\r\n"), " ")


def encode_text(text: str, size: int) -> bytes:
    """Return `text` as UTF-8 of at most `size` bytes, cut between two characters."""
    return text.encode("utf-8", "replace")[:size].decode("utf-8", "ignore").encode()


def hide_key(message: Message) -> Message:
    """Return the message, but SETUP_SIGNING without its key: for all that shows messages or keeps them."""
    if type(message) is not SetupSigning:
        return message
    return SetupSigning(message.target_system, message.target_component, bytes(32), 0)


def target_system(message: Message) -> int:
    """Return the system that a message is for; 0: all. MANUAL_CONTROL has another name for the field."""
    return int(getattr(message, "target_system", getattr(message, "target", 0)))


def field_value(message: Message, name: str) -> Any:
    """Return a value: a number, a text, or a list."""
    if isinstance(message, ExtraMessage):
        value = message.values[name]
    elif isinstance(message, StatusText) and name == "text":
        value = decode_text(message)
    else:
        value = getattr(message, name)
    if isinstance(value, bytes):
        value = value.split(b"\0", 1)[0].decode("utf-8", "replace")
    if isinstance(value, str):
        return printable(value)
    return list(value) if isinstance(value, tuple | list) else value
