"""What stops an ArduPilot vehicle. Measured on ArduRover 4.7; of Copter, Sub and others nothing is promised.

Without a new demand ArduRover keeps the last one for RC_OVERRIDE_TIME, then it obeys its RC receiver. Without a
receiver the radio failsafe (FS_THR_ENABLE) makes it neutral after 0.5 s, and FS_ACTION follows FS_TIMEOUT later.
MANUAL_CONTROL counts as a heartbeat for FS_GCS_ENABLE.
"""

from __future__ import annotations

from dialects.enums import VehicleType
from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules, action_bound, is_off

ROVERS = (VehicleType.GROUND_ROVER, VehicleType.SURFACE_BOAT)
"""MAV_TYPE of the firmware ArduRover; a boat is one of its frames."""

RADIO_TIMEOUT = 0.5
"""s without any RC input until the radio failsafe, fixed in ArduRover."""

AUTO_GOES_ON = 2
"""FS_GCS_ENABLE: AUTO continues."""

ACTIONS = {0: "", 1: "RTL", 2: "HOLD", 3: "SmartRTL", 4: "SmartRTL", 5: "terminate", 6: "LOITER"}
"""FS_ACTION -> what follows; "": nothing."""


def demand_age(facts: StopFacts) -> float | None:
    """Return the s since the last demand; None while none counts."""
    return None if facts.drives_itself else facts.command_age


def override_bound(kept: float | None, facts: StopFacts) -> StopBound:
    """Return the end of the last demand, which is kept for `kept` s (RC_OVERRIDE_TIME); None: not known."""
    if kept is not None and kept < 0:
        return StopBound("no command", "nothing", "RC_OVERRIDE_TIME", never=True)
    bound = kept or None  # 0 means that it ignores our demands: there is nothing to end
    return StopBound(
        "no command",
        "RC input" if bound else "--",
        "RC_OVERRIDE_TIME",
        bound,
        demand_age(facts),
        estimated=facts.estimated,
    )


def _override(facts: StopFacts) -> StopBound:
    return override_bound(facts.value("RC_OVERRIDE_TIME") if facts.kind in ROVERS else None, facts)


def _radio(facts: StopFacts) -> StopBound:
    enabled, kept = facts.value("FS_THR_ENABLE"), facts.value("RC_OVERRIDE_TIME")
    if facts.kind not in ROVERS or enabled is None or kept is None or (enabled and kept < 0):
        return StopBound("... no RC", "--", "FS_THR_ENABLE")
    action = "" if is_off(enabled) else "neutral"
    return action_bound(
        "... no RC", "FS_THR_ENABLE", RADIO_TIMEOUT, action, demand_age(facts), estimated=facts.estimated
    )


def _radio_action(facts: StopFacts) -> StopBound:
    enabled, kept = facts.value("FS_THR_ENABLE"), facts.value("RC_OVERRIDE_TIME")
    if facts.kind not in ROVERS or enabled is None or kept is None or (enabled and kept < 0):
        return StopBound("... no RC", "--", "FS_TIMEOUT")
    action = "" if is_off(enabled) else _action(facts)
    bound = facts.sum(RADIO_TIMEOUT, "FS_TIMEOUT")
    return action_bound("... no RC", "FS_TIMEOUT", bound, action, demand_age(facts), estimated=facts.estimated)


def _station(facts: StopFacts) -> StopBound:
    enabled = facts.value("FS_GCS_ENABLE") if facts.kind in ROVERS else None
    goes_on = facts.drives_itself and enabled == AUTO_GOES_ON
    action = None if enabled is None else "" if is_off(enabled) or goes_on else _action(facts)
    bound = facts.sum("FS_GCS_TIMEOUT", "FS_TIMEOUT") if action else None
    return action_bound("no station", "FS_GCS_ENABLE", bound, action, facts.quiet, estimated=True)


def _action(facts: StopFacts) -> str | None:
    selected = facts.value("FS_ACTION")
    return None if selected is None else ACTIONS.get(int(selected))


ARDUPILOT_STOPS = StopRules(
    rules=(_override, _radio, _radio_action, _station), params=("FS_GCS_TIMEOUT", "FS_TIMEOUT", "FS_ACTION")
)
"""RC_OVERRIDE_TIME, FS_THR_ENABLE and FS_GCS_ENABLE are read by the settings check."""
