"""The enums we speak, as Python enums with the official values, and the names that people read."""

from __future__ import annotations

from enum import IntEnum, IntFlag

from dialects import rover


class Autopilot(IntEnum):
    """MAV_AUTOPILOT, as far as we treat one differently."""

    GENERIC = rover.MAV_AUTOPILOT_GENERIC
    ARDUPILOT = rover.MAV_AUTOPILOT_ARDUPILOTMEGA
    INVALID = rover.MAV_AUTOPILOT_INVALID
    """Not an autopilot: a ground station, a camera, a radio."""
    PX4 = rover.MAV_AUTOPILOT_PX4


class Type(IntEnum):
    """MAV_TYPE, as far as we meet it."""

    GCS = rover.MAV_TYPE_GCS
    GROUND_ROVER = rover.MAV_TYPE_GROUND_ROVER
    SURFACE_BOAT = rover.MAV_TYPE_SURFACE_BOAT


class State(IntEnum):
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


class ModeFlag(IntFlag):
    """MAV_MODE_FLAG: `base_mode` of HEARTBEAT."""

    CUSTOM = rover.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    AUTO = rover.MAV_MODE_FLAG_AUTO_ENABLED
    GUIDED = rover.MAV_MODE_FLAG_GUIDED_ENABLED
    MANUAL = rover.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    ARMED = rover.MAV_MODE_FLAG_SAFETY_ARMED


class Result(IntEnum):
    """MAV_RESULT: the answer to a command."""

    ACCEPTED = rover.MAV_RESULT_ACCEPTED
    TEMPORARILY_REJECTED = rover.MAV_RESULT_TEMPORARILY_REJECTED
    """Wait and try again."""
    DENIED = rover.MAV_RESULT_DENIED
    """A parameter is wrong: trying again is useless."""
    UNSUPPORTED = rover.MAV_RESULT_UNSUPPORTED
    """The command is unknown here."""
    FAILED = rover.MAV_RESULT_FAILED
    """Something else must be put right first."""
    IN_PROGRESS = rover.MAV_RESULT_IN_PROGRESS
    CANCELLED = 6  # pymavlink 2.4.50 lacks the name
    LONG_ONLY = rover.MAV_RESULT_COMMAND_LONG_ONLY
    INT_ONLY = rover.MAV_RESULT_COMMAND_INT_ONLY
    UNSUPPORTED_FRAME = 9  # pymavlink 2.4.50 lacks the name


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
    """MAV_CMD: the commands we send or answer. Any other one is answered UNSUPPORTED."""

    NAV_RETURN_TO_LAUNCH = rover.MAV_CMD_NAV_RETURN_TO_LAUNCH
    DO_SET_MODE = rover.MAV_CMD_DO_SET_MODE
    DO_FLIGHTTERMINATION = rover.MAV_CMD_DO_FLIGHTTERMINATION
    DO_SET_STANDARD_MODE = rover.MAV_CMD_DO_SET_STANDARD_MODE
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
    REQUEST_OPERATOR_CONTROL = rover.MAV_CMD_REQUEST_OPERATOR_CONTROL


class Operator(IntFlag):
    """ROVER_OPERATOR_FLAGS of ROVER_OPERATOR_PRESENCE."""

    DEADMAN = rover.ROVER_OPERATOR_FLAGS_DEADMAN
    FOCUSED = rover.ROVER_OPERATOR_FLAGS_FOCUSED
    INPUT_LOST = rover.ROVER_OPERATOR_FLAGS_INPUT_LOST
    SCRIPT = rover.ROVER_OPERATOR_FLAGS_SCRIPT


class Limit(IntFlag):
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


class Sensor(IntFlag):
    """MAV_SYS_STATUS_SENSOR: the bits of SYS_STATUS that a rover may have."""

    GYRO = rover.MAV_SYS_STATUS_SENSOR_3D_GYRO
    GPS = rover.MAV_SYS_STATUS_SENSOR_GPS
    MOTOR_OUTPUTS = rover.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS
    GEOFENCE = rover.MAV_SYS_STATUS_GEOFENCE
    AHRS = rover.MAV_SYS_STATUS_AHRS
    BATTERY = rover.MAV_SYS_STATUS_SENSOR_BATTERY
    PREARM = rover.MAV_SYS_STATUS_PREARM_CHECK


class Capability(IntFlag):
    """MAV_PROTOCOL_CAPABILITY of AUTOPILOT_VERSION."""

    COMMAND_INT = rover.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    FLIGHT_TERMINATION = rover.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    MAVLINK2 = rover.MAV_PROTOCOL_CAPABILITY_MAVLINK2
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


class ParamFault(IntEnum):
    """MAV_PARAM_ERROR of PARAM_ERROR."""

    DOES_NOT_EXIST = rover.MAV_PARAM_ERROR_DOES_NOT_EXIST
    READ_ONLY = rover.MAV_PARAM_ERROR_READ_ONLY


def command_name(command: int) -> str:
    """`MAV_CMD` name without its prefix, e.g. "COMPONENT_ARM_DISARM"; "command 65535" for an unknown one."""
    entry = rover.enums["MAV_CMD"].get(command)
    return entry.name.removeprefix("MAV_CMD_") if entry else f"command {command}"


def result_name(result: int) -> str:
    """`MAV_RESULT` in words a driver reads, e.g. "denied"; "result 99" for an unknown one."""
    entry = rover.enums["MAV_RESULT"].get(result)
    return entry.name.removeprefix("MAV_RESULT_").replace("_", " ").lower() if entry else f"result {result}"
