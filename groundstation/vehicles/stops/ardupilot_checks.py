"""Parameters of ArduPilot Rover that would let it drive on without us.

ArduPilot keeps the last demand for RC_OVERRIDE_TIME (3 s by default) and its ground station failsafe is off by default
(measured on ArduRover 4.7).
"""

from __future__ import annotations

from collections.abc import Mapping

from groundstation.vehicles.stops.autopilot_settings import AutopilotSettings

LONGEST_OVERRIDE = 1.0
"""s for which a vehicle may keep a demand that is not renewed before we warn."""


def _override_time(value: float, system: int) -> str | None:
    if value < 0:
        return "RC_OVERRIDE_TIME -1: never stops when the link is lost; set it to 0.5"
    if value > LONGEST_OVERRIDE:
        return f"RC_OVERRIDE_TIME {value:g}: drives on for {value:g} s when the link is lost; set it to 0.5"
    return None


def _gcs_failsafe(value: float, system: int) -> str | None:
    return "FS_GCS_ENABLE 0: no failsafe when the ground station is lost; set it to 1" if value == 0 else None


def _throttle_failsafe(value: float, system: int) -> str | None:
    if value:
        return None
    return "FS_THR_ENABLE 0: without RC, never stops when the link is lost; set it to 1"


def station_system(value: float, system: int) -> str | None:
    """Return the warning that it obeys another ground station, or None."""
    wanted = int(value) & 0xFF  # ArduPilot accepts 300 and uses the low byte
    if wanted == system:
        return None
    return f"obeys ground station {wanted} only and we are {system}: use --system {wanted}"


def _link_loss_action(values: Mapping[str, float]) -> str | None:
    override, throttle = values.get("RC_OVERRIDE_TIME"), values.get("FS_THR_ENABLE")
    if override is None or throttle is None:
        return None
    if override < 0:
        return "by its settings it never stops"
    if throttle == 0:
        return "without an RC receiver it never stops"
    return f"by its settings it drives on for {override:g} s"


FORMER_NAMES = {"MAV_GCS_SYSID": "SYSID_MYGCS"}
"""Renamed in ArduPilot 4.7."""

ARDUPILOT = AutopilotSettings(
    checks={
        "RC_OVERRIDE_TIME": _override_time,
        "FS_GCS_ENABLE": _gcs_failsafe,
        "FS_THR_ENABLE": _throttle_failsafe,
        "MAV_GCS_SYSID": station_system,
        "SYSID_MYGCS": station_system,
    },
    former_names=FORMER_NAMES,
    link_loss_action=_link_loss_action,
    obeyed=("MAV_GCS_SYSID", "SYSID_MYGCS"),
)
