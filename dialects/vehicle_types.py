"""MAV_TYPEs that are no vehicle: parts of one, and what only looks at vehicles."""

from __future__ import annotations

from dialects import rover

NO_VEHICLES = frozenset(
    {
        rover.MAV_TYPE_GCS,
        rover.MAV_TYPE_ONBOARD_CONTROLLER,
        rover.MAV_TYPE_GIMBAL,
        rover.MAV_TYPE_ADSB,
        rover.MAV_TYPE_CAMERA,
        rover.MAV_TYPE_CHARGING_STATION,
        rover.MAV_TYPE_FLARM,
        rover.MAV_TYPE_SERVO,
        rover.MAV_TYPE_ODID,
        rover.MAV_TYPE_BATTERY,
        rover.MAV_TYPE_PARACHUTE,
        rover.MAV_TYPE_LOG,
        rover.MAV_TYPE_OSD,
        rover.MAV_TYPE_IMU,
        rover.MAV_TYPE_GPS,
        rover.MAV_TYPE_WINCH,
        rover.MAV_TYPE_ILLUMINATOR,
        rover.MAV_TYPE_GRIPPER,
        49,  # MAV_TYPE_RADIO, newer than pymavlink 2.4.50
    }
)
"""Many of them name an autopilot in their HEARTBEAT: a gimbal that of its vehicle, a script on board GENERIC.
MAV_TYPE_GENERIC and ANTENNA_TRACKER are missing here, because autopilots send them."""

AUTOPILOT_COMPONENT: int = rover.MAV_COMP_ID_AUTOPILOT1
"""Component id of the autopilot of a vehicle; a second autopilot or a script on board has another one."""
