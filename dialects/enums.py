"""The MAVLink enums that the programs use, as Python enums with the official values."""

from __future__ import annotations

from enum import IntEnum, IntFlag

from dialects import rover


class Autopilot(IntEnum):
    """MAV_AUTOPILOT, as far as one is treated differently."""

    GENERIC = rover.MAV_AUTOPILOT_GENERIC
    ARDUPILOT = rover.MAV_AUTOPILOT_ARDUPILOTMEGA
    INVALID = rover.MAV_AUTOPILOT_INVALID
    """Not an autopilot: a ground station, a camera, a radio."""
    PX4 = rover.MAV_AUTOPILOT_PX4


class VehicleType(IntEnum):
    """MAV_TYPE, as far as the programs use it."""

    GENERIC = rover.MAV_TYPE_GENERIC
    """It does not say what it is."""
    GCS = rover.MAV_TYPE_GCS
    GROUND_ROVER = rover.MAV_TYPE_GROUND_ROVER
    SURFACE_BOAT = rover.MAV_TYPE_SURFACE_BOAT


def _entries(enum: str) -> dict[int, str]:
    """Return the entries of an enum as words: the build leaves the constants in the module, but not the tables."""
    prefix = f"{enum}_"
    found = ((name.removeprefix(prefix), number) for name, number in vars(rover).items() if name.startswith(prefix))
    return {number: name.replace("_", " ").lower() for name, number in found if name != "ENUM_END"}


_TYPES, _STATES = _entries("MAV_TYPE"), _entries("MAV_STATE")


def type_name(number: int) -> str:
    """Return any MAV_TYPE in words, e.g. "onboard controller"; "type 250" for one that the dialect does not know."""
    return _TYPES.get(number, f"type {number}")


def state_name(number: int) -> str:
    """Return a MAV_STATE in words, e.g. "standby"; "state 12" for one that the dialect does not know."""
    return _STATES.get(number, f"state {number}")


class SystemState(IntEnum):
    """MAV_STATE: `system_status` of HEARTBEAT."""

    UNINIT = rover.MAV_STATE_UNINIT
    BOOT = rover.MAV_STATE_BOOT
    CALIBRATING = rover.MAV_STATE_CALIBRATING
    STANDBY = rover.MAV_STATE_STANDBY
    """Disarmed."""
    ACTIVE = rover.MAV_STATE_ACTIVE
    """Armed."""
    CRITICAL = rover.MAV_STATE_CRITICAL
    """A failsafe is active."""
    EMERGENCY = rover.MAV_STATE_EMERGENCY
    """Emergency stop."""
    POWEROFF = rover.MAV_STATE_POWEROFF
    FLIGHT_TERMINATION = rover.MAV_STATE_FLIGHT_TERMINATION


class LandedState(IntEnum):
    """MAV_LANDED_STATE, as far as the programs use it."""

    UNDEFINED = rover.MAV_LANDED_STATE_UNDEFINED
    ON_GROUND = rover.MAV_LANDED_STATE_ON_GROUND
    IN_AIR = rover.MAV_LANDED_STATE_IN_AIR
    TAKEOFF = rover.MAV_LANDED_STATE_TAKEOFF
    LANDING = rover.MAV_LANDED_STATE_LANDING


class ModeFlag(IntFlag):
    """MAV_MODE_FLAG: `base_mode` of HEARTBEAT."""

    CUSTOM = rover.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    AUTO = rover.MAV_MODE_FLAG_AUTO_ENABLED
    GUIDED = rover.MAV_MODE_FLAG_GUIDED_ENABLED
    MANUAL = rover.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    ARMED = rover.MAV_MODE_FLAG_SAFETY_ARMED


class Result(IntEnum):
    """MAV_RESULT: the result of a command."""

    ACCEPTED = rover.MAV_RESULT_ACCEPTED
    TEMPORARILY_REJECTED = rover.MAV_RESULT_TEMPORARILY_REJECTED
    """Not now; trying again later may work."""
    DENIED = rover.MAV_RESULT_DENIED
    """A parameter is wrong, or the sender may not: trying again is useless."""
    UNSUPPORTED = rover.MAV_RESULT_UNSUPPORTED
    """The command is unknown."""
    FAILED = rover.MAV_RESULT_FAILED
    """Something else must be put right first."""
    IN_PROGRESS = rover.MAV_RESULT_IN_PROGRESS
    CANCELLED = 6  # pymavlink 2.4.50 lacks the name
    LONG_ONLY = rover.MAV_RESULT_COMMAND_LONG_ONLY
    INT_ONLY = rover.MAV_RESULT_COMMAND_INT_ONLY
    UNSUPPORTED_FRAME = 9  # pymavlink 2.4.50 lacks the name
    NOT_IN_CONTROL = 10  # pymavlink 2.4.50 lacks the name


class Severity(IntEnum):
    """MAV_SEVERITY of a STATUSTEXT; smaller is worse."""

    EMERGENCY = rover.MAV_SEVERITY_EMERGENCY
    ALERT = rover.MAV_SEVERITY_ALERT
    CRITICAL = rover.MAV_SEVERITY_CRITICAL
    ERROR = rover.MAV_SEVERITY_ERROR
    WARNING = rover.MAV_SEVERITY_WARNING
    NOTICE = rover.MAV_SEVERITY_NOTICE
    INFO = rover.MAV_SEVERITY_INFO
    DEBUG = rover.MAV_SEVERITY_DEBUG


class Command(IntEnum):
    """MAV_CMD: the commands that are sent or accepted. Any other one is answered with UNSUPPORTED."""

    NAV_WAYPOINT = rover.MAV_CMD_NAV_WAYPOINT
    NAV_LOITER_UNLIM = rover.MAV_CMD_NAV_LOITER_UNLIM
    NAV_LOITER_TURNS = rover.MAV_CMD_NAV_LOITER_TURNS
    NAV_LOITER_TIME = rover.MAV_CMD_NAV_LOITER_TIME
    NAV_DELAY = rover.MAV_CMD_NAV_DELAY
    CONDITION_DELAY = rover.MAV_CMD_CONDITION_DELAY
    CONDITION_DISTANCE = rover.MAV_CMD_CONDITION_DISTANCE
    CONDITION_YAW = rover.MAV_CMD_CONDITION_YAW
    DO_JUMP = rover.MAV_CMD_DO_JUMP
    DO_SET_SERVO = rover.MAV_CMD_DO_SET_SERVO
    DO_SET_RELAY = rover.MAV_CMD_DO_SET_RELAY
    DO_REPEAT_RELAY = rover.MAV_CMD_DO_REPEAT_RELAY
    DO_REPEAT_SERVO = rover.MAV_CMD_DO_REPEAT_SERVO
    DO_FENCE_ENABLE = rover.MAV_CMD_DO_FENCE_ENABLE
    DO_SET_MISSION_CURRENT = rover.MAV_CMD_DO_SET_MISSION_CURRENT
    MISSION_START = rover.MAV_CMD_MISSION_START
    NAV_RETURN_TO_LAUNCH = rover.MAV_CMD_NAV_RETURN_TO_LAUNCH
    NAV_LAND = rover.MAV_CMD_NAV_LAND
    NAV_TAKEOFF = rover.MAV_CMD_NAV_TAKEOFF
    DO_REPOSITION = rover.MAV_CMD_DO_REPOSITION
    DO_CHANGE_SPEED = rover.MAV_CMD_DO_CHANGE_SPEED
    DO_SET_REVERSE = rover.MAV_CMD_DO_SET_REVERSE
    DO_SET_HOME = rover.MAV_CMD_DO_SET_HOME
    DO_PAUSE_CONTINUE = rover.MAV_CMD_DO_PAUSE_CONTINUE
    DO_SET_MODE = rover.MAV_CMD_DO_SET_MODE
    DO_MOTOR_TEST = rover.MAV_CMD_DO_MOTOR_TEST
    ACTUATOR_TEST = rover.MAV_CMD_ACTUATOR_TEST
    DO_FLIGHTTERMINATION = rover.MAV_CMD_DO_FLIGHTTERMINATION
    DO_SET_STANDARD_MODE = rover.MAV_CMD_DO_SET_STANDARD_MODE
    PREFLIGHT_CALIBRATION = rover.MAV_CMD_PREFLIGHT_CALIBRATION
    PREFLIGHT_STORAGE = rover.MAV_CMD_PREFLIGHT_STORAGE
    PREFLIGHT_REBOOT_SHUTDOWN = rover.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN
    COMPONENT_ARM_DISARM = rover.MAV_CMD_COMPONENT_ARM_DISARM
    RUN_PREARM_CHECKS = rover.MAV_CMD_RUN_PREARM_CHECKS
    GET_HOME_POSITION = rover.MAV_CMD_GET_HOME_POSITION
    GET_MESSAGE_INTERVAL = rover.MAV_CMD_GET_MESSAGE_INTERVAL
    SET_MESSAGE_INTERVAL = rover.MAV_CMD_SET_MESSAGE_INTERVAL
    REQUEST_MESSAGE = rover.MAV_CMD_REQUEST_MESSAGE
    REQUEST_PROTOCOL_VERSION = rover.MAV_CMD_REQUEST_PROTOCOL_VERSION
    REQUEST_AUTOPILOT_CAPABILITIES = rover.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES
    DO_SET_SAFETY_SWITCH_STATE = rover.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE
    REQUEST_CAMERA_INFORMATION = rover.MAV_CMD_REQUEST_CAMERA_INFORMATION
    VIDEO_START_STREAMING = rover.MAV_CMD_VIDEO_START_STREAMING
    VIDEO_STOP_STREAMING = rover.MAV_CMD_VIDEO_STOP_STREAMING
    REQUEST_VIDEO_STREAM_INFORMATION = rover.MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION
    REQUEST_VIDEO_STREAM_STATUS = rover.MAV_CMD_REQUEST_VIDEO_STREAM_STATUS
    REQUEST_OPERATOR_CONTROL = rover.MAV_CMD_REQUEST_OPERATOR_CONTROL
    DO_SET_GLOBAL_ORIGIN = 611  # newer than pymavlink's common.xml
    DO_START_MAG_CAL = 42424  # this and the following ones are of ardupilotmega.xml, not in common.xml
    DO_ACCEPT_MAG_CAL = 42425
    DO_CANCEL_MAG_CAL = 42426
    DO_SEND_BANNER = 42428
    ACCELCAL_VEHICLE_POS = 42429


class FenceItem(IntEnum):
    """MAV_CMD_NAV_FENCE_* and NAV_RALLY_POINT: items of fence and rally plans."""

    RETURN_POINT = rover.MAV_CMD_NAV_FENCE_RETURN_POINT
    POLYGON_INCLUSION = rover.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    POLYGON_EXCLUSION = rover.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION
    CIRCLE_INCLUSION = rover.MAV_CMD_NAV_FENCE_CIRCLE_INCLUSION
    CIRCLE_EXCLUSION = rover.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
    RALLY_POINT = rover.MAV_CMD_NAV_RALLY_POINT


class OperatorFlag(IntFlag):
    """ROVER_OPERATOR_FLAGS of ROVER_OPERATOR_PRESENCE."""

    DEADMAN = rover.ROVER_OPERATOR_FLAGS_DEADMAN
    FOCUSED = rover.ROVER_OPERATOR_FLAGS_FOCUSED
    INPUT_LOST = rover.ROVER_OPERATOR_FLAGS_INPUT_LOST
    SCRIPT = rover.ROVER_OPERATOR_FLAGS_SCRIPT
    AXES = rover.ROVER_OPERATOR_FLAGS_AXES
    OVERRIDE = rover.ROVER_OPERATOR_FLAGS_OVERRIDE


class Rejection(IntEnum):
    """ROVER_REJECTION: result_param2 of a COMMAND_ACK that rejects temporarily."""

    NO_PROOF = rover.ROVER_REJECTION_NO_PROOF


class ControlFlag(IntFlag):
    """ROVER_CONTROL_FLAGS of ROVER_CONTROL."""

    TAKEOVER_ALLOWED = rover.ROVER_CONTROL_FLAGS_TAKEOVER_ALLOWED
    CLASH = rover.ROVER_CONTROL_FLAGS_CLASH
    SILENT = rover.ROVER_CONTROL_FLAGS_SILENT


class DriveLimit(IntFlag):
    """ROVER_DRIVE_LIMITS: why the motor outputs differ from the demand."""

    SLEW = rover.ROVER_DRIVE_LIMITS_SLEW
    SATURATED = rover.ROVER_DRIVE_LIMITS_SATURATED
    SPEED = rover.ROVER_DRIVE_LIMITS_SPEED
    REVERSE_DELAY = rover.ROVER_DRIVE_LIMITS_REVERSE_DELAY
    STALE = rover.ROVER_DRIVE_LIMITS_STALE
    FAILSAFE = rover.ROVER_DRIVE_LIMITS_FAILSAFE
    ESTOP = rover.ROVER_DRIVE_LIMITS_ESTOP
    FENCE = rover.ROVER_DRIVE_LIMITS_FENCE
    BATTERY = rover.ROVER_DRIVE_LIMITS_BATTERY
    DISARMED = rover.ROVER_DRIVE_LIMITS_DISARMED
    NEUTRAL_FIRST = rover.ROVER_DRIVE_LIMITS_NEUTRAL_FIRST
    FRESHNESS = rover.ROVER_DRIVE_LIMITS_FRESHNESS
    OBSTACLE = rover.ROVER_DRIVE_LIMITS_OBSTACLE
    RANGE_SENSOR = rover.ROVER_DRIVE_LIMITS_RANGE_SENSOR


class Failsafe(IntFlag):
    """ROVER_FAILSAFE: the conditions of ROVER_FAILSAFE_STATUS."""

    MANUAL_LOSS = rover.ROVER_FAILSAFE_MANUAL_LOSS
    GCS_LOSS = rover.ROVER_FAILSAFE_GCS_LOSS
    OPERATOR = rover.ROVER_FAILSAFE_OPERATOR
    GUIDED_LOSS = rover.ROVER_FAILSAFE_GUIDED_LOSS
    BATTERY_LOW = rover.ROVER_FAILSAFE_BATTERY_LOW
    BATTERY_CRITICAL = rover.ROVER_FAILSAFE_BATTERY_CRITICAL
    FENCE = rover.ROVER_FAILSAFE_FENCE
    POSITION = rover.ROVER_FAILSAFE_POSITION
    TILT = rover.ROVER_FAILSAFE_TILT
    BLOCKED = rover.ROVER_FAILSAFE_BLOCKED
    MOTOR_DRIVER = rover.ROVER_FAILSAFE_MOTOR_DRIVER
    LOOP_OVERRUN = rover.ROVER_FAILSAFE_LOOP_OVERRUN
    OVERHEAT = rover.ROVER_FAILSAFE_OVERHEAT
    ESTOP = rover.ROVER_FAILSAFE_ESTOP


class DriveType(IntEnum):
    """ROVER_DRIVE_TYPE of ROVER_DRIVE_INFO."""

    UNKNOWN = rover.ROVER_DRIVE_TYPE_UNKNOWN
    SKID = rover.ROVER_DRIVE_TYPE_SKID
    ACKERMANN = rover.ROVER_DRIVE_TYPE_ACKERMANN
    OMNI = rover.ROVER_DRIVE_TYPE_OMNI
    MECANUM = rover.ROVER_DRIVE_TYPE_MECANUM


class StationEventKind(IntEnum):
    """ROVER_STATION_EVENT_KIND: what a ground station noted in its log."""

    KEYS_DOWN = rover.ROVER_STATION_EVENT_KIND_KEYS_DOWN
    KEYS_UP = rover.ROVER_STATION_EVENT_KIND_KEYS_UP
    ACTION = rover.ROVER_STATION_EVENT_KIND_ACTION
    SCREEN = rover.ROVER_STATION_EVENT_KIND_SCREEN
    LINK_OPENED = rover.ROVER_STATION_EVENT_KIND_LINK_OPENED
    LINK_CLOSED = rover.ROVER_STATION_EVENT_KIND_LINK_CLOSED
    LINK_FAULT = rover.ROVER_STATION_EVENT_KIND_LINK_FAULT
    VEHICLE_CHOSEN = rover.ROVER_STATION_EVENT_KIND_VEHICLE_CHOSEN
    CONTROL = rover.ROVER_STATION_EVENT_KIND_CONTROL
    DECISION = rover.ROVER_STATION_EVENT_KIND_DECISION
    REQUEST = rover.ROVER_STATION_EVENT_KIND_REQUEST
    MARK = rover.ROVER_STATION_EVENT_KIND_MARK


class Sensor(IntFlag):
    """MAV_SYS_STATUS_SENSOR: bits of SYS_STATUS that a rover may have."""

    GYRO = rover.MAV_SYS_STATUS_SENSOR_3D_GYRO
    ACCELEROMETER = rover.MAV_SYS_STATUS_SENSOR_3D_ACCEL
    COMPASS = rover.MAV_SYS_STATUS_SENSOR_3D_MAG
    GPS = rover.MAV_SYS_STATUS_SENSOR_GPS
    MOTOR_OUTPUTS = rover.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    GEOFENCE = rover.MAV_SYS_STATUS_GEOFENCE
    AHRS = rover.MAV_SYS_STATUS_AHRS
    BATTERY = rover.MAV_SYS_STATUS_SENSOR_BATTERY
    LOGGING = rover.MAV_SYS_STATUS_LOGGING
    PREARM = rover.MAV_SYS_STATUS_PREARM_CHECK


class EstimatorFlag(IntFlag):
    """ESTIMATOR_STATUS_FLAGS, as far as they apply to a rover on flat ground."""

    ATTITUDE = rover.ESTIMATOR_ATTITUDE
    VELOCITY = rover.ESTIMATOR_VELOCITY_HORIZ
    POSITION_RELATIVE = rover.ESTIMATOR_POS_HORIZ_REL
    POSITION_ABSOLUTE = rover.ESTIMATOR_POS_HORIZ_ABS


class Capability(IntFlag):
    """MAV_PROTOCOL_CAPABILITY of AUTOPILOT_VERSION."""

    MISSION_INT = rover.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    SET_ATTITUDE_TARGET = rover.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    SET_POSITION_TARGET_LOCAL = rover.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED
    SET_POSITION_TARGET_GLOBAL = rover.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
    MISSION_FENCE = rover.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    MISSION_RALLY = rover.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    COMMAND_INT = rover.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    FTP = rover.MAV_PROTOCOL_CAPABILITY_FTP
    FLIGHT_TERMINATION = rover.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    MAVLINK2 = rover.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    PARAM_BYTEWISE = rover.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    PARAM_C_CAST = rover.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_C_CAST


class DataStream(IntEnum):
    """MAV_DATA_STREAM: the groups of REQUEST_DATA_STREAM."""

    ALL = rover.MAV_DATA_STREAM_ALL
    RAW_SENSORS = rover.MAV_DATA_STREAM_RAW_SENSORS
    EXTENDED_STATUS = rover.MAV_DATA_STREAM_EXTENDED_STATUS
    RC_CHANNELS = rover.MAV_DATA_STREAM_RC_CHANNELS
    POSITION = rover.MAV_DATA_STREAM_POSITION
    EXTRA1 = rover.MAV_DATA_STREAM_EXTRA1
    EXTRA2 = rover.MAV_DATA_STREAM_EXTRA2
    EXTRA3 = rover.MAV_DATA_STREAM_EXTRA3


class ParamErrorCode(IntEnum):
    """MAV_PARAM_ERROR of PARAM_ERROR."""

    DOES_NOT_EXIST = rover.MAV_PARAM_ERROR_DOES_NOT_EXIST
    VALUE_OUT_OF_RANGE = rover.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
    PERMISSION_DENIED = rover.MAV_PARAM_ERROR_PERMISSION_DENIED
    """Not now, or not for this sender."""
    READ_ONLY = rover.MAV_PARAM_ERROR_READ_ONLY
    TYPE_MISMATCH = 7  # pymavlink 2.4.50 lacks the name


class MissionType(IntEnum):
    """MAV_MISSION_TYPE: the three plans of a vehicle."""

    MISSION = rover.MAV_MISSION_TYPE_MISSION
    FENCE = rover.MAV_MISSION_TYPE_FENCE
    RALLY = rover.MAV_MISSION_TYPE_RALLY
    ALL = rover.MAV_MISSION_TYPE_ALL
    """Only in MISSION_CLEAR_ALL."""


class MissionResult(IntEnum):
    """MAV_MISSION_RESULT of MISSION_ACK."""

    ACCEPTED = rover.MAV_MISSION_ACCEPTED
    ERROR = rover.MAV_MISSION_ERROR
    UNSUPPORTED_FRAME = rover.MAV_MISSION_UNSUPPORTED_FRAME
    UNSUPPORTED = rover.MAV_MISSION_UNSUPPORTED
    """The command, or the plan type, is unknown."""
    NO_SPACE = rover.MAV_MISSION_NO_SPACE
    INVALID = rover.MAV_MISSION_INVALID
    INVALID_PARAM1 = rover.MAV_MISSION_INVALID_PARAM1
    INVALID_PARAM2 = rover.MAV_MISSION_INVALID_PARAM2
    INVALID_PARAM3 = rover.MAV_MISSION_INVALID_PARAM3
    INVALID_PARAM4 = rover.MAV_MISSION_INVALID_PARAM4
    INVALID_X = rover.MAV_MISSION_INVALID_PARAM5_X
    INVALID_Y = rover.MAV_MISSION_INVALID_PARAM6_Y
    INVALID_PARAM7 = rover.MAV_MISSION_INVALID_PARAM7
    INVALID_SEQUENCE = rover.MAV_MISSION_INVALID_SEQUENCE
    DENIED = rover.MAV_MISSION_DENIED
    CANCELLED = rover.MAV_MISSION_OPERATION_CANCELLED


def command_name(command: int) -> str:
    """Return the name of a `MAV_CMD` without its prefix; "command 65535" for an unknown one."""
    if command in Command._value2member_map_:  # also those that pymavlink's common.xml lacks
        return Command(command).name
    entry = rover.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


_RESULT_NAMES: dict[int, str] = {
    **{result: result.name for result in Result},
    Result.LONG_ONLY: "COMMAND_LONG_ONLY",
    Result.INT_ONLY: "COMMAND_INT_ONLY",
    Result.UNSUPPORTED_FRAME: "COMMAND_UNSUPPORTED_MAV_FRAME",
}

LACKING: dict[str, dict[int, str]] = {
    "MAV_RESULT": {number: f"MAV_RESULT_{name}" for number, name in _RESULT_NAMES.items()},
    "MAV_CMD": {command: f"MAV_CMD_{command.name}" for command in Command},
    "MAV_PARAM_ERROR": {ParamErrorCode.TYPE_MISMATCH: "MAV_PARAM_ERROR_TYPE_MISMATCH"},
}
"""Enum -> value -> name as in common.xml, some of which pymavlink 2.4.50 lacks."""


def result_name(result: int) -> str:
    """Return the name of a `MAV_RESULT` in lower case, e.g. "denied"; "result 99" for an unknown one."""
    return _RESULT_NAMES.get(result, f"result {result}").replace("_", " ").lower()


def result_token(result: int) -> str:
    """Return the name of a `MAV_RESULT` without its prefix, e.g. "TEMPORARILY_REJECTED"; "RESULT_99"."""
    return _RESULT_NAMES.get(result, f"RESULT_{result}")
