"""What stops ArduCopter without us, and when, by its own parameters (ArduCopter/radio.cpp, events.cpp).

Without a new demand it keeps the last one for RC_OVERRIDE_TIME, then it obeys its RC receiver. Without a receiver the
radio failsafe follows 0.5 s later. MANUAL_CONTROL counts as a sign of the station for FS_GCS_ENABLE.
"""

from __future__ import annotations

from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.ardupilot_stops import demand_age, override_bound
from groundstation.vehicles.stops.copter_checks import (
    PILOT_GOES_ON,
    RADIO_ACTIONS,
    RADIO_TIMEOUT,
    STATION_ACTIONS,
)
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules, action_bound, is_off


def _override(facts: StopFacts) -> StopBound:
    return override_bound(facts.value("RC_OVERRIDE_TIME"), facts)


def _radio(facts: StopFacts) -> StopBound:
    enabled, kept = facts.value("FS_THR_ENABLE"), facts.value("RC_OVERRIDE_TIME")
    if enabled is None or kept is None or (enabled and kept < 0):
        return StopBound("... no RC", "--", "FS_THR_ENABLE")
    action = "" if is_off(enabled) else RADIO_ACTIONS.get(int(enabled))
    bound = facts.sum(RADIO_TIMEOUT, "RC_OVERRIDE_TIME")
    return action_bound("... no RC", "FS_THR_ENABLE", bound, action, demand_age(facts), estimated=facts.estimated)


def _station(facts: StopFacts) -> StopBound:
    enabled, options = facts.value("FS_GCS_ENABLE"), facts.value("FS_OPTIONS")
    if enabled is None or options is None:
        return StopBound("no station", "--", "FS_GCS_ENABLE")
    goes_on = bool(int(options) & PILOT_GOES_ON) and not facts.drives_itself
    action = "" if is_off(enabled) or goes_on else STATION_ACTIONS.get(int(enabled), "RTL")
    source = "FS_OPTIONS" if goes_on else "FS_GCS_ENABLE"
    return action_bound("no station", source, facts.value("FS_GCS_TIMEOUT"), action, facts.quiet, estimated=True)


COPTER_STOPS = StopRules(rules=(_override, _radio, _station), params=())
"""All of them are read by the settings check. PX4 has the rules of px4_stops.py: its Hold is hovering."""
