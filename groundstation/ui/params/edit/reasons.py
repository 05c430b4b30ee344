"""REASONS: why some parameters matter when a vehicle is driven by keys and must stop without them.

ArduPilot's defaults were measured on ArduRover 4.7; PX4's are those of its parameter reference
(https://docs.px4.io/main/en/advanced_config/parameter_reference.html); mavhelm's are in docs/safety.md.
"""

from __future__ import annotations

from fnmatch import fnmatchcase

REASONS: tuple[tuple[str, str], ...] = (
    # ArduPilot
    ("RC_OVERRIDE_TIME", "A rover drives on with the last demand for this long when the link is cut; -1: for ever. 0.5 "
                         "s is enough for this station, which sends 20 times a second."),
    ("FS_THR_ENABLE", "0: without an RC receiver nothing stops the rover when the demands end. 1 stops it."),
    ("FS_GCS_ENABLE", "0: the rover does nothing when the ground station is lost. 1: FS_ACTION; 2: not in AUTO."),
    ("FS_GCS_TIMEOUT", "From the last heartbeat of the ground station to FS_ACTION."),
    ("FS_TIMEOUT", "Added to the time until the loss is noticed: only then the failsafe acts."),
    ("FS_ACTION", "What a failsafe does. RTL and SmartRTL drive; Hold stops; 0 does nothing."),
    ("FS_EKF_ACTION", "What happens when the position is not trusted any more. Report only: AUTO drives on."),
    ("FS_CRASH_CHECK", "Stops a rover that is blocked or has tipped over. 0: the wheels go on turning."),
    ("MAV_GCS_SYSID", "Manual control of any other ground station is ignored: it must be the id of this one."),
    ("SYSID_MYGCS", "Manual control of any other ground station is ignored: it must be the id of this one."),
    ("MODE_CH", "The channel of an RC transmitter that changes the mode, also while keys drive."),
    ("BRD_SAFETY_DEFLT", "The safety switch keeps the motors off after a start."),
    ("ARMING_REQUIRE", "0: the rover is armed from its start on, and a disarm does not hold the motors."),
    ("ARMING_CHECK", "0: the rover arms with any fault that its checks would have found."),
    # PX4
    ("COM_RC_LOSS_T", "The rover keeps the last demand for this long when the link is cut."),
    ("NAV_RCL_ACT", "When manual control is lost: 6 disarms, 1 holds a place and may drive for it, 2 drives home."),
    ("COM_FAIL_ACT_T", "For how long the rover holds a place before it drives home, when a link is lost."),
    ("COM_DL_LOSS_T", "From the last heartbeat of the ground station to NAV_DLL_ACT."),
    ("NAV_DLL_ACT", "When the ground station is lost: 6 disarms, 1 holds a place, 2 drives home, 0 does nothing."),
    ("COM_RC_IN_MODE", "0 and 4: keys do not drive. 1: manual control of a ground station does."),
    # mavhelm
    ("MAN_TIMEOUT", "A demand older than this is neutral: the time from a lost link to stopped motors."),
    ("OPR_TIMEOUT", "Stops a rover that moves while nobody has touched a key for this long."),
    ("OPR_ECHO_MAX", "A demand is rejected if the operator sees a picture older than this."),
    ("FS_DISARM_T", "From the loss of manual control to disarming: later nothing can move it by mistake."),
    ("FS_LOOP_TIMEOUT", "Disarms when the program on the vehicle is too slow to be in control."),
    ("DISARM_DELAY", "Disarms a rover that nobody drives. 0: it stays armed."),
)  # fmt: skip
"""Name, and why it matters."""

RISKY = ("FS_*", "RC_OVERRIDE_TIME", "RC*_*", "RCMAP_*", "SERVO*_*", "MOT*_*", "ARMING_*", "BRD_SAFETY*", "MODE*",
         "*SYSID*", "MAV_SYS_ID", "COM_*", "NAV_*_ACT", "CA_*", "PWM_*", "RO_*", "RD_*", "RA_*", "RM_*", "MAN_*",
         "OPR_*", "DRIVE_TYPE", "FRAME_*")  # fmt: skip
"""Patterns of names whose change while armed may move a vehicle, or keep it from stopping."""

_BY_NAME = dict(REASONS)


def reason_for(name: str) -> str:
    """Return why a parameter matters here; empty for most."""
    return _BY_NAME.get(name, "")


def is_risky(name: str) -> bool:
    """Return whether a change while armed may move the vehicle, or keep it from stopping."""
    return any(fnmatchcase(name, pattern) for pattern in RISKY)
