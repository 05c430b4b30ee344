"""STOP_RULES: what stops a vehicle without us, and when, for each autopilot. The rules are in *_stops.py."""

from __future__ import annotations

from dialects.enums import Autopilot
from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.ardupilot_stops import ARDUPILOT_STOPS
from groundstation.vehicles.stops.copter_stops import COPTER_STOPS
from groundstation.vehicles.stops.px4_stops import PX4_STOPS
from groundstation.vehicles.stops.rover_stops import ROVER_STOPS
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules

STOP_RULES: dict[int, StopRules] = {Autopilot.ARDUPILOT: ARDUPILOT_STOPS, Autopilot.PX4: PX4_STOPS}
"""MAV_AUTOPILOT -> its rules. Our own vehicles are known by their dialect."""

FLIGHT_RULES: dict[int, StopRules] = {Autopilot.ARDUPILOT: COPTER_STOPS, Autopilot.PX4: PX4_STOPS}
"""The same of what flies."""

UNKNOWN = (StopBound("no command", "--", "not known"), StopBound("no station", "--", "not known"))
"""Of a vehicle whose failsafes are not known."""


def find_rules(autopilot: int, *, own_dialect: bool, flies: bool = False) -> StopRules | None:
    """Return the rules of a vehicle; None: its failsafes are not known."""
    if flies:
        return FLIGHT_RULES.get(autopilot)
    return ROVER_STOPS if own_dialect else STOP_RULES.get(autopilot)


def stop_bounds(rules: StopRules | None, facts: StopFacts) -> tuple[StopBound, ...]:
    """Return what stops the vehicle, most important first."""
    return UNKNOWN if rules is None else tuple(rule(facts) for rule in rules.rules)
