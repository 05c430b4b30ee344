"""What the commands of a plan need: labels, units and ranges of their parameters.

Written by dialects/command_params.py from the definition of MAV_CMD (common.xml); do not edit.
"""

from __future__ import annotations

from groundstation.ui.map.plan.mission_command import CommandParam, MissionCommand

_P = CommandParam

MISSION_COMMANDS: dict[int, MissionCommand] = {
    16: MissionCommand("NAV_WAYPOINT", True, (
        _P(1, "hold", "s", 0.0),
        _P(2, "accept radius", "m", 0.0),
        _P(3, "pass radius", "m"),
        _P(4, "yaw", "deg"),
    )),
    17: MissionCommand("NAV_LOITER_UNLIM", True, (
        _P(3, "radius", "m"),
        _P(4, "yaw", "deg"),
    )),
    18: MissionCommand("NAV_LOITER_TURNS", True, (
        _P(1, "turns", "", 0.0),
        _P(3, "radius", "m"),
    )),
    19: MissionCommand("NAV_LOITER_TIME", True, (
        _P(1, "time", "s", 0.0),
        _P(3, "radius", "m"),
    )),
    20: MissionCommand("NAV_RETURN_TO_LAUNCH", False, ()),
    21: MissionCommand("NAV_LAND", True, (
        _P(1, "abort alt", "m"),
        _P(2, "land mode", ""),
        _P(4, "yaw angle", "deg"),
    )),
    22: MissionCommand("NAV_TAKEOFF", True, (
        _P(1, "pitch", "deg"),
        _P(3, "flags", ""),
        _P(4, "yaw", "deg"),
    )),
    23: MissionCommand("NAV_LAND_LOCAL", True, (
        _P(1, "target", "", 0.0, None, 1.0),
        _P(2, "offset", "m", 0.0),
        _P(3, "descend rate", "m/s"),
        _P(4, "yaw", "rad"),
    )),
    24: MissionCommand("NAV_TAKEOFF_LOCAL", True, (
        _P(1, "pitch", "rad"),
        _P(3, "ascend rate", "m/s"),
        _P(4, "yaw", "rad"),
    )),
    25: MissionCommand("NAV_FOLLOW", True, (
        _P(1, "following", "", None, None, 1.0),
        _P(2, "ground speed", "m/s"),
        _P(3, "radius", "m"),
        _P(4, "yaw", "deg"),
    )),
    30: MissionCommand("NAV_CONTINUE_AND_CHANGE_ALT", False, (
        _P(1, "action", "", 0.0, 2.0, 1.0),
        _P(7, "altitude", "m"),
    )),
    31: MissionCommand("NAV_LOITER_TO_ALT", True, (
        _P(1, "heading required", ""),
        _P(2, "radius", "m"),
        _P(4, "xtrack location", "", 0.0, 1.0, 1.0),
    )),
    32: MissionCommand("DO_FOLLOW", False, (
        _P(1, "system id", "", 0.0, 255.0, 1.0),
        _P(4, "altitude mode", "", 0.0, 2.0, 1.0),
        _P(5, "altitude", "m"),
        _P(7, "time to land", "s", 0.0),
    )),
    33: MissionCommand("DO_FOLLOW_REPOSITION", False, (
        _P(1, "camera q1", ""),
        _P(2, "camera q2", ""),
        _P(3, "camera q3", ""),
        _P(4, "camera q4", ""),
        _P(5, "altitude offset", "m"),
        _P(6, "x offset", "m"),
        _P(7, "y offset", "m"),
    )),
    34: MissionCommand("DO_ORBIT", True, (
        _P(1, "radius", "m"),
        _P(2, "velocity", "m/s"),
        _P(3, "yaw behavior", ""),
        _P(4, "orbits", "rad", 0.0),
    )),
    35: MissionCommand("DO_FIGURE_EIGHT", True, (
        _P(1, "major radius", "m"),
        _P(2, "minor radius", "m"),
        _P(4, "orientation", "rad"),
    )),
    36: MissionCommand("NAV_ARC_WAYPOINT", True, (
        _P(1, "arc angle", "deg", -359.0, 359.0, 1.0),
    )),
    80: MissionCommand("NAV_ROI", True, (
        _P(1, "roi mode", ""),
        _P(2, "wp index", "", 0.0, None, 1.0),
        _P(3, "roi index", "", 0.0, None, 1.0),
    )),
    81: MissionCommand("NAV_PATHPLANNING", True, (
        _P(1, "local ctrl", "", 0.0, 2.0, 1.0),
        _P(2, "global ctrl", "", 0.0, 3.0, 1.0),
        _P(4, "yaw", "deg"),
    )),
    82: MissionCommand("NAV_SPLINE_WAYPOINT", True, (
        _P(1, "hold", "s", 0.0),
    )),
    84: MissionCommand("NAV_VTOL_TAKEOFF", True, (
        _P(2, "transition heading", ""),
        _P(4, "yaw angle", "deg"),
    )),
    85: MissionCommand("NAV_VTOL_LAND", True, (
        _P(1, "land options", ""),
        _P(3, "approach altitude", "m"),
        _P(4, "yaw", "deg"),
    )),
    92: MissionCommand("NAV_GUIDED_ENABLE", False, (
        _P(1, "enable", ""),
    )),
    93: MissionCommand("NAV_DELAY", False, (
        _P(1, "delay", "s", -1.0, None, 1.0),
        _P(2, "hour", "", -1.0, 23.0, 1.0),
        _P(3, "minute", "", -1.0, 59.0, 1.0),
        _P(4, "second", "", -1.0, 59.0, 1.0),
    )),
    94: MissionCommand("NAV_PAYLOAD_PLACE", True, (
        _P(1, "max descent", "m", 0.0),
    )),
    95: MissionCommand("NAV_LAST", False, ()),
    112: MissionCommand("CONDITION_DELAY", False, (
        _P(1, "delay", "s", 0.0),
    )),
    113: MissionCommand("CONDITION_CHANGE_ALT", False, (
        _P(1, "rate", "m/s"),
        _P(7, "altitude", "m"),
    )),
    114: MissionCommand("CONDITION_DISTANCE", False, (
        _P(1, "distance", "m", 0.0),
    )),
    115: MissionCommand("CONDITION_YAW", False, (
        _P(1, "angle", "deg", 0.0, 360.0),
        _P(2, "angular speed", "deg/s", 0.0),
        _P(3, "direction", "", -1.0, 1.0, 1.0),
        _P(4, "relative", ""),
    )),
    159: MissionCommand("CONDITION_LAST", False, ()),
    176: MissionCommand("DO_SET_MODE", False, (
        _P(1, "mode", ""),
        _P(2, "custom mode", ""),
        _P(3, "custom submode", ""),
    )),
    177: MissionCommand("DO_JUMP", False, (
        _P(1, "number", "", 0.0, None, 1.0),
        _P(2, "repeat", "", 0.0, None, 1.0),
    )),
    178: MissionCommand("DO_CHANGE_SPEED", False, (
        _P(1, "speed type", ""),
        _P(2, "speed", "m/s", -2.0),
        _P(3, "throttle", "%", -2.0),
    )),
    179: MissionCommand("DO_SET_HOME", True, (
        _P(1, "use current", ""),
    )),
    180: MissionCommand("DO_SET_PARAMETER", False, (
        _P(1, "number", "", 0.0, None, 1.0),
        _P(2, "value", ""),
    )),
    181: MissionCommand("DO_SET_RELAY", False, (
        _P(1, "instance", "", 0.0, None, 1.0),
        _P(2, "setting", "", 0.0, None, 1.0),
    )),
    182: MissionCommand("DO_REPEAT_RELAY", False, (
        _P(1, "instance", "", 0.0, None, 1.0),
        _P(2, "count", "", 1.0, None, 1.0),
        _P(3, "time", "s", 0.0),
    )),
    183: MissionCommand("DO_SET_SERVO", False, (
        _P(1, "instance", "", 0.0, None, 1.0),
        _P(2, "pwm", "us", 0.0, None, 1.0),
    )),
    184: MissionCommand("DO_REPEAT_SERVO", False, (
        _P(1, "instance", "", 0.0, None, 1.0),
        _P(2, "pwm", "us", 0.0, None, 1.0),
        _P(3, "count", "", 1.0, None, 1.0),
        _P(4, "time", "s", 0.0),
    )),
    185: MissionCommand("DO_FLIGHTTERMINATION", False, (
        _P(1, "terminate", "", 0.0, 1.0, 1.0),
    )),
    186: MissionCommand("DO_CHANGE_ALTITUDE", False, (
        _P(1, "altitude", "m"),
        _P(2, "frame", ""),
    )),
    187: MissionCommand("DO_SET_ACTUATOR", False, (
        _P(1, "actuator 1", "", -1.0, 1.0),
        _P(2, "actuator 2", "", -1.0, 1.0),
        _P(3, "actuator 3", "", -1.0, 1.0),
        _P(4, "actuator 4", "", -1.0, 1.0),
        _P(5, "actuator 5", ""),
        _P(6, "actuator 6", ""),
        _P(7, "index", "", 0.0, None, 1.0),
    )),
    188: MissionCommand("DO_RETURN_PATH_START", True, ()),
    189: MissionCommand("DO_LAND_START", True, ()),
    190: MissionCommand("DO_RALLY_LAND", False, (
        _P(1, "altitude", "m"),
        _P(2, "speed", "m/s"),
    )),
    191: MissionCommand("DO_GO_AROUND", False, (
        _P(1, "altitude", "m"),
    )),
    192: MissionCommand("DO_REPOSITION", True, (
        _P(1, "speed", "m/s", -1.0),
        _P(2, "bitmask", ""),
        _P(3, "radius", "m"),
        _P(4, "yaw", "rad"),
    )),
    193: MissionCommand("DO_PAUSE_CONTINUE", False, (
        _P(1, "continue", ""),
    )),
    194: MissionCommand("DO_SET_REVERSE", False, (
        _P(1, "reverse", ""),
    )),
    195: MissionCommand("DO_SET_ROI_LOCATION", True, (
        _P(1, "gimbal device id", ""),
    )),
    196: MissionCommand("DO_SET_ROI_WPNEXT_OFFSET", False, (
        _P(1, "gimbal device id", ""),
        _P(5, "pitch offset", "deg"),
        _P(6, "roll offset", "deg"),
        _P(7, "yaw offset", "deg"),
    )),
    197: MissionCommand("DO_SET_ROI_NONE", False, (
        _P(1, "gimbal device id", ""),
    )),
    198: MissionCommand("DO_SET_ROI_SYSID", False, (
        _P(1, "system id", "", 1.0, 255.0, 1.0),
        _P(2, "gimbal device id", ""),
    )),
    200: MissionCommand("DO_CONTROL_VIDEO", False, (
        _P(1, "id", "", -1.0, None, 1.0),
        _P(2, "transmission", "", 0.0, 2.0, 1.0),
        _P(3, "interval", "s", 0.0),
        _P(4, "recording", "", 0.0, 2.0, 1.0),
    )),
    201: MissionCommand("DO_SET_ROI", True, (
        _P(1, "roi mode", ""),
        _P(2, "wp index", "", 0.0, None, 1.0),
        _P(3, "roi index", "", 0.0, None, 1.0),
    )),
    202: MissionCommand("DO_DIGICAM_CONFIGURE", False, (
        _P(1, "mode", "", 0.0, None, 1.0),
        _P(2, "shutter speed", "", 0.0, None, 1.0),
        _P(3, "aperture", "", 0.0),
        _P(4, "iso", "", 0.0, None, 1.0),
        _P(5, "exposure", ""),
        _P(6, "command identity", ""),
        _P(7, "engine cut-off", "ds", 0.0, None, 1.0),
    )),
    203: MissionCommand("DO_DIGICAM_CONTROL", False, (
        _P(1, "session control", ""),
        _P(2, "zoom absolute", ""),
        _P(3, "zoom relative", ""),
        _P(4, "focus", ""),
        _P(5, "shoot command", ""),
        _P(6, "command identity", ""),
        _P(7, "shot id", ""),
    )),
    204: MissionCommand("DO_MOUNT_CONFIGURE", False, (
        _P(1, "mode", ""),
        _P(2, "stabilize roll", ""),
        _P(3, "stabilize pitch", ""),
        _P(4, "stabilize yaw", ""),
    )),
    205: MissionCommand("DO_MOUNT_CONTROL", False, (
        _P(7, "mode", ""),
    )),
    206: MissionCommand("DO_SET_CAM_TRIGG_DIST", False, (
        _P(1, "distance", "m", 0.0),
        _P(2, "shutter", "ms", -1.0, None, 1.0),
        _P(3, "trigger", ""),
        _P(4, "target camera id", "", 0.0, 255.0, 1.0),
    )),
    207: MissionCommand("DO_FENCE_ENABLE", False, (
        _P(1, "enable", "", 0.0, 2.0, 1.0),
        _P(2, "types", ""),
    )),
    208: MissionCommand("DO_PARACHUTE", False, (
        _P(1, "action", ""),
    )),
    209: MissionCommand("DO_MOTOR_TEST", False, (
        _P(1, "instance", "", 1.0, None, 1.0),
        _P(2, "throttle type", ""),
        _P(3, "throttle", ""),
        _P(4, "timeout", "s", 0.0),
        _P(5, "motor count", "", 0.0, None, 1.0),
        _P(6, "test order", ""),
    )),
    210: MissionCommand("DO_INVERTED_FLIGHT", False, (
        _P(1, "inverted", ""),
    )),
    211: MissionCommand("DO_GRIPPER", False, (
        _P(1, "gripper id", "", 0.0, None, 1.0),
        _P(2, "action", ""),
    )),
    212: MissionCommand("DO_AUTOTUNE_ENABLE", False, (
        _P(1, "enable", ""),
        _P(2, "axis", ""),
    )),
    213: MissionCommand("NAV_SET_YAW_SPEED", False, (
        _P(1, "yaw", "deg"),
        _P(2, "speed", "m/s"),
        _P(3, "angle", ""),
    )),
    214: MissionCommand("DO_SET_CAM_TRIGG_INTERVAL", False, (
        _P(1, "trigger cycle", "ms", -1.0, None, 1.0),
        _P(2, "shutter integration", "ms", -1.0, None, 1.0),
        _P(3, "target camera id", "", 0.0, 255.0, 1.0),
    )),
    220: MissionCommand("DO_MOUNT_CONTROL_QUAT", False, (
        _P(1, "q1", ""),
        _P(2, "q2", ""),
        _P(3, "q3", ""),
        _P(4, "q4", ""),
    )),
    221: MissionCommand("DO_GUIDED_MASTER", False, (
        _P(1, "system id", "", 0.0, 255.0, 1.0),
        _P(2, "component id", "", 0.0, 255.0, 1.0),
    )),
    222: MissionCommand("DO_GUIDED_LIMITS", False, (
        _P(1, "timeout", "s", 0.0),
        _P(2, "min altitude", "m"),
        _P(3, "max altitude", "m"),
        _P(4, "horiz. move limit", "m", 0.0),
    )),
    223: MissionCommand("DO_ENGINE_CONTROL", False, (
        _P(1, "start engine", ""),
        _P(2, "cold start", ""),
        _P(3, "height delay", "m", 0.0),
        _P(4, "options", ""),
    )),
    224: MissionCommand("DO_SET_MISSION_CURRENT", False, (
        _P(1, "number", "", -1.0, None, 1.0),
        _P(2, "reset mission", ""),
    )),
    240: MissionCommand("DO_LAST", False, ()),
    262: MissionCommand("DO_SET_STANDARD_MODE", False, (
        _P(1, "standard mode", ""),
    )),
    406: MissionCommand("DO_ILLUMINATOR_CONFIGURE", False, (
        _P(1, "mode", ""),
        _P(2, "brightness", "%", 0.0, 100.0),
        _P(3, "strobe period", "s", 0.0),
        _P(4, "strobe duty", "%", 0.0, 100.0),
    )),
    601: MissionCommand("DO_JUMP_TAG", False, (
        _P(1, "tag", "", 0.0, None, 1.0),
        _P(2, "repeat", "", 0.0, None, 1.0),
    )),
    1000: MissionCommand("DO_GIMBAL_MANAGER_PITCHYAW", False, (
        _P(1, "pitch angle", "deg", -180.0, 180.0),
        _P(2, "yaw angle", "deg", -180.0, 180.0),
        _P(3, "pitch rate", "deg/s"),
        _P(4, "yaw rate", "deg/s"),
        _P(5, "gimbal manager flags", ""),
        _P(7, "gimbal device id", ""),
    )),
    1001: MissionCommand("DO_GIMBAL_MANAGER_CONFIGURE", False, (
        _P(1, "sysid primary control", ""),
        _P(2, "compid primary control", ""),
        _P(3, "sysid secondary control", ""),
        _P(4, "compid secondary control", ""),
        _P(7, "gimbal device id", ""),
    )),
    2003: MissionCommand("DO_TRIGGER_CONTROL", False, (
        _P(1, "enable", "", -1.0, 1.0, 1.0),
        _P(2, "reset", "", -1.0, 1.0, 1.0),
        _P(3, "pause", "", -1.0, 1.0, 2.0),
        _P(4, "target camera id", "", 0.0, 255.0, 1.0),
    )),
    3000: MissionCommand("DO_VTOL_TRANSITION", False, (
        _P(1, "state", ""),
    )),
    4501: MissionCommand("CONDITION_GATE", True, (
        _P(1, "geometry", "", 0.0, None, 1.0),
        _P(2, "usealtitude", ""),
    )),
    5000: MissionCommand("NAV_FENCE_RETURN_POINT", True, ()),
    5001: MissionCommand("NAV_FENCE_POLYGON_VERTEX_INCLUSION", True, (
        _P(1, "vertex count", "", 3.0, None, 1.0),
        _P(2, "inclusion group", "", 0.0, None, 1.0),
    )),
    5002: MissionCommand("NAV_FENCE_POLYGON_VERTEX_EXCLUSION", True, (
        _P(1, "vertex count", "", 3.0, None, 1.0),
    )),
    5003: MissionCommand("NAV_FENCE_CIRCLE_INCLUSION", True, (
        _P(1, "radius", "m"),
        _P(2, "inclusion group", "", 0.0, None, 1.0),
    )),
    5004: MissionCommand("NAV_FENCE_CIRCLE_EXCLUSION", True, (
        _P(1, "radius", "m"),
    )),
    5100: MissionCommand("NAV_RALLY_POINT", True, ()),
    5300: MissionCommand("DO_SET_SAFETY_SWITCH_STATE", False, (
        _P(1, "desired state", ""),
    )),
    10001: MissionCommand("DO_ADSB_OUT_IDENT", False, ()),
    42600: MissionCommand("DO_WINCH", False, (
        _P(1, "instance", "", 1.0, None, 1.0),
        _P(2, "action", ""),
        _P(3, "length", "m"),
        _P(4, "rate", "m/s"),
    )),
}  # fmt: skip
"""MAV_CMD -> what it needs."""
