"""Names of the modes of ArduPilot and PX4 by their custom_mode.

ArduPilot numbers modes by firmware, which MAV_TYPE tells: 4 is HOLD of a rover and GUIDED of a copter. The tables are
those of pymavlink's mavutil (AP_MAV_TYPE_MODE_MAP), which is slow to import; a test compares them. PX4 has one table
for all types (src/modules/commander/px4_custom_mode.h).
"""

from __future__ import annotations

from collections.abc import Mapping

from dialects import rover
from dialects.modes import Mode

ModeTable = Mapping[int, str]
"""custom_mode -> name."""

ROVER: ModeTable = {int(mode): mode.name for mode in Mode}

COPTER: ModeTable = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 5: "LOITER", 6: "RTL", 7: "CIRCLE",
    8: "POSITION", 9: "LAND", 10: "OF_LOITER", 11: "DRIFT", 13: "SPORT", 14: "FLIP", 15: "AUTOTUNE", 16: "POSHOLD",
    17: "BRAKE", 18: "THROW", 19: "AVOID_ADSB", 20: "GUIDED_NOGPS", 21: "SMART_RTL", 22: "FLOWHOLD", 23: "FOLLOW",
    24: "ZIGZAG", 25: "SYSTEMID", 26: "AUTOROTATE", 27: "AUTO_RTL", 28: "TURTLE", 29: "RATE_ACRO",
}  # fmt: skip

PLANE: ModeTable = {
    0: "MANUAL", 1: "CIRCLE", 2: "STABILIZE", 3: "TRAINING", 4: "ACRO", 5: "FBWA", 6: "FBWB", 7: "CRUISE",
    8: "AUTOTUNE", 10: "AUTO", 11: "RTL", 12: "LOITER", 13: "TAKEOFF", 14: "AVOID_ADSB", 15: "GUIDED",
    16: "INITIALISING", 17: "QSTABILIZE", 18: "QHOVER", 19: "QLOITER", 20: "QLAND", 21: "QRTL", 22: "QAUTOTUNE",
    23: "QACRO", 24: "THERMAL", 25: "LOITERALTQLAND", 26: "AUTOLAND",
}  # fmt: skip

SUB: ModeTable = {
    0: "STABILIZE", 1: "ACRO", 2: "ALT_HOLD", 3: "AUTO", 4: "GUIDED", 7: "CIRCLE", 9: "SURFACE", 16: "POSHOLD",
    19: "MANUAL",
}  # fmt: skip

TRACKER: ModeTable = {0: "MANUAL", 1: "STOP", 2: "SCAN", 4: "GUIDED", 10: "AUTO", 16: "INITIALISING"}

BLIMP: ModeTable = {0: "LAND", 1: "MANUAL", 2: "VELOCITY", 3: "LOITER", 4: "RTL", 5: "AUTO", 6: "HOLD"}

VTOL = range(19, 26)
"""The MAV_TYPE_VTOL_*."""

ARDUPILOT: Mapping[int, ModeTable] = {
    **dict.fromkeys((rover.MAV_TYPE_GROUND_ROVER, rover.MAV_TYPE_SURFACE_BOAT), ROVER),
    **dict.fromkeys(
        (
            rover.MAV_TYPE_QUADROTOR, rover.MAV_TYPE_HEXAROTOR, rover.MAV_TYPE_OCTOROTOR, rover.MAV_TYPE_TRICOPTER,
            rover.MAV_TYPE_DECAROTOR, rover.MAV_TYPE_DODECAROTOR, rover.MAV_TYPE_COAXIAL, rover.MAV_TYPE_HELICOPTER,
        ),
        COPTER,
    ),
    **dict.fromkeys((rover.MAV_TYPE_FIXED_WING, *VTOL), PLANE),
    rover.MAV_TYPE_SUBMARINE: SUB,
    rover.MAV_TYPE_ANTENNA_TRACKER: TRACKER,
    rover.MAV_TYPE_AIRSHIP: BLIMP,
}  # fmt: skip
"""MAV_TYPE -> modes of ArduPilot's firmware for it."""

AUTO_MAIN = 4
"""Main mode AUTO of PX4; the sub mode tells what it does."""
HOLD = "HOLD"
"""The mode that holds the vehicle where it is, of all autopilots that have one: PX4 calls it AUTO_LOITER."""


def px4_number(main: int, sub: int = 0) -> int:
    """Return PX4's custom_mode: the main mode in bits 16 to 23, the sub mode in bits 24 to 31."""
    return main << 16 | sub << 24


PX4: ModeTable = {
    px4_number(1): "MANUAL",
    px4_number(2): "ALTCTL",
    px4_number(3): "POSCTL",
    px4_number(3, 1): "ORBIT",
    px4_number(3, 2): "POSCTL_SLOW",
    px4_number(5): "ACRO",
    px4_number(6): "OFFBOARD",
    px4_number(7): "STABILIZED",
    px4_number(8): "RATTITUDE",
    px4_number(10): "TERMINATION",
    px4_number(AUTO_MAIN): "AUTO",
    px4_number(AUTO_MAIN, 1): "AUTO_READY",
    px4_number(AUTO_MAIN, 2): "AUTO_TAKEOFF",
    px4_number(AUTO_MAIN, 3): HOLD,
    px4_number(AUTO_MAIN, 4): "AUTO_MISSION",
    px4_number(AUTO_MAIN, 5): "AUTO_RTL",
    px4_number(AUTO_MAIN, 6): "AUTO_LAND",
    px4_number(AUTO_MAIN, 8): "AUTO_FOLLOW_TARGET",
    px4_number(AUTO_MAIN, 9): "AUTO_PRECLAND",
    px4_number(AUTO_MAIN, 10): "AUTO_VTOL_TAKEOFF",
    **{px4_number(AUTO_MAIN, 10 + number): f"AUTO_EXTERNAL{number}" for number in range(1, 9)},
}

PX4_ALIASES: Mapping[str, str] = {
    "AUTO_LOITER": HOLD,
    "LOITER": HOLD,
    "POSITION": "POSCTL",
    "ALTITUDE": "ALTCTL",
    "MISSION": "AUTO_MISSION",
    "RTL": "AUTO_RTL",
    "RETURN": "AUTO_RTL",
    "LAND": "AUTO_LAND",
    "TAKEOFF": "AUTO_TAKEOFF",
    "GUIDED": "OFFBOARD",
}
"""What others call a mode of PX4: its own source, QGroundControl, pymavlink."""

STANDARD_MODES: Mapping[int, str] = {
    1: "POSITION",
    2: "ORBIT",
    3: "CRUISE",
    4: "ALTITUDE",
    5: "RETURN",
    6: "MISSION",
    7: "LAND",
    8: "TAKEOFF",
}
"""MAV_STANDARD_MODE -> name of a mode that has no other (common.xml)."""
