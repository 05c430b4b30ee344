"""Commands that the role drive may send, to any autopilot. What is not listed may be set-up by another name.

Our vehicle, ArduPilot and PX4 understand some commands that no list here names: a command without a row needs setup.
"""

from __future__ import annotations

from dialects import rover

DRIVE_COMMANDS = frozenset(
    (
        *range(rover.MAV_CMD_NAV_WAYPOINT, rover.MAV_CMD_NAV_FOLLOW + 1),  # go, take off, land
        *range(rover.MAV_CMD_NAV_CONTINUE_AND_CHANGE_ALT, rover.MAV_CMD_NAV_ARC_WAYPOINT + 1),
        rover.MAV_CMD_NAV_ROI,
        rover.MAV_CMD_NAV_SPLINE_WAYPOINT,
        rover.MAV_CMD_NAV_VTOL_TAKEOFF,
        rover.MAV_CMD_NAV_VTOL_LAND,
        rover.MAV_CMD_NAV_GUIDED_ENABLE,
        rover.MAV_CMD_NAV_DELAY,
        rover.MAV_CMD_NAV_PAYLOAD_PLACE,
        rover.MAV_CMD_CONDITION_YAW,
        *range(rover.MAV_CMD_DO_SET_MODE, rover.MAV_CMD_DO_SET_HOME + 1),
        *range(rover.MAV_CMD_DO_SET_RELAY, rover.MAV_CMD_DO_SET_ROI_SYSID + 1),  # outputs, speed, places
        *range(rover.MAV_CMD_DO_CONTROL_VIDEO, rover.MAV_CMD_DO_SET_CAM_TRIGG_DIST + 1),
        rover.MAV_CMD_DO_FENCE_ENABLE,  # on; off needs setup
        rover.MAV_CMD_DO_PARACHUTE,
        rover.MAV_CMD_DO_INVERTED_FLIGHT,
        rover.MAV_CMD_DO_GRIPPER,
        rover.MAV_CMD_NAV_SET_YAW_SPEED,
        rover.MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL,
        216,  # MAV_CMD_DO_SPRAYER of ArduPilot's dialect
        *range(rover.MAV_CMD_DO_MOUNT_CONTROL_QUAT, rover.MAV_CMD_DO_SET_MISSION_CURRENT + 1),
        rover.MAV_CMD_OVERRIDE_GOTO,
        rover.MAV_CMD_OBLIQUE_SURVEY,
        rover.MAV_CMD_DO_SET_STANDARD_MODE,
        rover.MAV_CMD_MISSION_START,
        rover.MAV_CMD_COMPONENT_ARM_DISARM,
        rover.MAV_CMD_ILLUMINATOR_ON_OFF,
        rover.MAV_CMD_DO_ILLUMINATOR_CONFIGURE,
        rover.MAV_CMD_REQUEST_CAMERA_INFORMATION,
        rover.MAV_CMD_REQUEST_CAMERA_SETTINGS,
        rover.MAV_CMD_REQUEST_STORAGE_INFORMATION,
        rover.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS,
        rover.MAV_CMD_REQUEST_FLIGHT_INFORMATION,
        rover.MAV_CMD_SET_CAMERA_MODE,
        rover.MAV_CMD_SET_CAMERA_ZOOM,
        rover.MAV_CMD_SET_CAMERA_FOCUS,
        rover.MAV_CMD_SET_CAMERA_SOURCE,
        rover.MAV_CMD_DO_JUMP_TAG,
        611,  # MAV_CMD_DO_SET_GLOBAL_ORIGIN, newer than the dialect
        rover.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW,
        rover.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE,
        *range(rover.MAV_CMD_IMAGE_START_CAPTURE, rover.MAV_CMD_CAMERA_TRACK_RECTANGLE + 1),
        rover.MAV_CMD_CAMERA_STOP_TRACKING,
        *range(rover.MAV_CMD_VIDEO_START_CAPTURE, rover.MAV_CMD_REQUEST_VIDEO_STREAM_STATUS + 1),
        rover.MAV_CMD_LOGGING_START,
        rover.MAV_CMD_LOGGING_STOP,
        rover.MAV_CMD_AIRFRAME_CONFIGURATION,  # landing gear
        rover.MAV_CMD_PANORAMA_CREATE,
        rover.MAV_CMD_DO_VTOL_TRANSITION,
        rover.MAV_CMD_ARM_AUTHORIZATION_REQUEST,
        rover.MAV_CMD_SET_GUIDED_SUBMODE_STANDARD,
        rover.MAV_CMD_SET_GUIDED_SUBMODE_CIRCLE,
        rover.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE,
        rover.MAV_CMD_DO_ADSB_OUT_IDENT,
        rover.MAV_CMD_PAYLOAD_PREPARE_DEPLOY,
        rover.MAV_CMD_PAYLOAD_CONTROL_DEPLOY,
        rover.MAV_CMD_REQUEST_OPERATOR_CONTROL,
        rover.MAV_CMD_DO_WINCH,
        *range(rover.MAV_CMD_GUIDED_CHANGE_SPEED, rover.MAV_CMD_EXTERNAL_POSITION_ESTIMATE + 1),
        rover.MAV_CMD_DO_FLIGHTTERMINATION,
    )
)
"""MAV_CMDs that arm, move, change modes, or turn outputs, cameras and payloads."""
