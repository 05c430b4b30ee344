"""Parameters of a multicopter that would let it fall or fly on when the link is lost.

With such a value keys do not take off: each warning is the reason, and names the remedy.

ArduCopter has two failsafes, and each needs its own parameters (ArduCopter/radio.cpp, events.cpp). When demands end,
the last one is kept for RC_OVERRIDE_TIME; without a receiver the radio failsafe follows 0.5 s later (FS_THR_ENABLE).
When the station is silent for FS_GCS_TIMEOUT, FS_GCS_ENABLE acts, but by default not in modes that a pilot flies
(FS_OPTIONS, bit 4). PX4 loses manual control after COM_RC_LOSS_T (Commander, failsafe.cpp).
"""

from __future__ import annotations

from collections.abc import Mapping

from groundstation.vehicles.stops.altitude_fence import ardupilot_fence, px4_fence
from groundstation.vehicles.stops.ardupilot_checks import FORMER_NAMES, station_system
from groundstation.vehicles.stops.autopilot_settings import AutopilotSettings
from groundstation.vehicles.stops.px4_checks import LONGEST_LOSS_TIME, SOURCES, described

LONGEST_OVERRIDE = 3.0
"""s, the default of RC_OVERRIDE_TIME: the longest time for which the last demand may go on."""
LONGEST_STATION_LOSS = 5.0
"""s, the default of FS_GCS_TIMEOUT."""
RADIO_TIMEOUT = 0.5
"""s without any RC input until the radio failsafe (FS_RADIO_TIMEOUT_MS)."""
PILOT_GOES_ON = 16
"""Bit of FS_OPTIONS: the failsafe for the station does nothing in modes that a pilot flies. It is set by default."""

RADIO_ACTIONS = {1: "RTL", 2: "RTL", 3: "LAND", 4: "SmartRTL", 5: "SmartRTL", 6: "RTL", 7: "BRAKE"}
"""FS_THR_ENABLE -> what follows."""
STATION_ACTIONS = {1: "RTL", 2: "RTL", 3: "SmartRTL", 4: "SmartRTL", 5: "LAND", 6: "RTL", 7: "BRAKE"}
"""FS_GCS_ENABLE -> what follows."""


def _override_time(value: float, system: int) -> str | None:
    if value == 0:
        return "RC_OVERRIDE_TIME 0: it ignores keys; set it to 3"
    if value < 0:
        return "RC_OVERRIDE_TIME -1: flies on when demands end; set it to 3"
    if value > LONGEST_OVERRIDE:
        return f"RC_OVERRIDE_TIME {value:g}: flies on for {value:g} s when demands end; set it to 3"
    return None


def _radio_failsafe(value: float, system: int) -> str | None:
    return None if value else "FS_THR_ENABLE 0: flies on when demands end; set it to 3 (land)"


def _station_failsafe(value: float, system: int) -> str | None:
    return None if value else "FS_GCS_ENABLE 0: flies on when the station is lost; set it to 5 (land)"


def _station_timeout(value: float, system: int) -> str | None:
    if value <= LONGEST_STATION_LOSS:
        return None
    return f"FS_GCS_TIMEOUT {value:g}: flies on for {value:g} s without a station; set it to 5"


def _options(value: float, system: int) -> str | None:
    if not int(value) & PILOT_GOES_ON:
        return None
    without = int(value) & ~PILOT_GOES_ON
    return f"FS_OPTIONS {value:g}: flies on in LOITER when the station is lost; set it to {without}"


def _ardupilot_link_loss(values: Mapping[str, float]) -> str | None:
    kept, radio = values.get("RC_OVERRIDE_TIME"), values.get("FS_THR_ENABLE")
    if kept is None or radio is None:
        return None
    if kept < 0 or not radio:
        return "by its settings it flies on"
    action = RADIO_ACTIONS.get(int(radio), "RTL")
    return f"by its settings it flies on for {kept + RADIO_TIMEOUT:g} s, then {action}"


ARDUPILOT_COPTER = AutopilotSettings(
    checks={
        "RC_OVERRIDE_TIME": _override_time,
        "FS_THR_ENABLE": _radio_failsafe,
        "FS_GCS_ENABLE": _station_failsafe,
        "FS_GCS_TIMEOUT": _station_timeout,
        "FS_OPTIONS": _options,
        "MAV_GCS_SYSID": station_system,
        "SYSID_MYGCS": station_system,
    },
    former_names=FORMER_NAMES,
    link_loss_action=_ardupilot_link_loss,
    fence=("FENCE_ENABLE", "FENCE_AUTOENABLE", "FENCE_TYPE", "FENCE_ALT_MAX"),
    find_fence=ardupilot_fence,
    obeyed=("MAV_GCS_SYSID", "SYSID_MYGCS"),
)

_LINK_LOST: dict[int, str] = {
    0: "flies on when the link is lost",
    5: "falls when the link is lost",
    6: "falls when the link is lost",
}
"""NAV_RCL_ACT -> what is wrong with it: disabled, terminate, disarm."""

_STATION_LOST: dict[int, str] = {5: "falls when the station is lost", 6: "falls when the station is lost"}
"""NAV_DLL_ACT -> the same. Without it the loss of manual control acts."""


def _loss_time(value: float, system: int) -> str | None:
    if value <= LONGEST_LOSS_TIME:
        return None
    return f"COM_RC_LOSS_T {value:g}: flies on for {value:g} s when the link is lost; set it to 0.5"


_THEN = {1: "", 2: ", and flies home {hold:g} s later", 3: ", and lands {hold:g} s later"}


def _px4_link_loss(values: Mapping[str, float]) -> str | None:
    after, hold, action = (values.get(name) for name in ("COM_RC_LOSS_T", "COM_FAIL_ACT_T", "NAV_RCL_ACT"))
    if after is None or hold is None or action is None:
        return None
    if action in _LINK_LOST:
        return f"by its settings it {_LINK_LOST[int(action)].partition(' when')[0]}"
    return f"by its settings it hovers after {after:g} s{_THEN.get(int(action), '').format(hold=hold)}"


PX4_COPTER = AutopilotSettings(
    checks={
        "COM_RC_IN_MODE": described("COM_RC_IN_MODE", SOURCES, "set it to 1"),
        "COM_RC_LOSS_T": _loss_time,
        "NAV_RCL_ACT": described("NAV_RCL_ACT", _LINK_LOST, "set it to 3 (land)"),
        "COM_FAIL_ACT_T": lambda value, system: None,
        "NAV_DLL_ACT": described("NAV_DLL_ACT", _STATION_LOST, "set it to 3 (land)"),
        "COM_DL_LOSS_T": lambda value, system: None,
    },
    link_loss_action=_px4_link_loss,
    fence=("GF_ACTION", "GF_MAX_VER_DIST"),
    find_fence=px4_fence,
    bytewise=True,
)
