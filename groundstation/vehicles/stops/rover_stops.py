"""What stops a vehicle of our own: vehicle/safety/failsafe.py, by its parameters."""

from __future__ import annotations

from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules, action_bound, is_off

AUTO_GOES_ON = 2
"""FS_GCS_ENABLE: AUTO continues after the ground station is lost."""

FENCE_ACTIONS = {1: "RTL", 2: "HOLD"}


def _age(facts: StopFacts) -> float | None:
    return None if facts.drives_itself else facts.command_age


def _timeout(facts: StopFacts) -> float | None:
    read = facts.value("MAN_TIMEOUT")
    return read if read is not None else facts.manual_timeout


def _command(facts: StopFacts) -> StopBound:
    return StopBound("no command", "neutral", "MAN_TIMEOUT", _timeout(facts), _age(facts))


def _command_then(facts: StopFacts) -> StopBound:
    timeout = _timeout(facts)
    bound = None if timeout is None else facts.sum(timeout, "FS_TIMEOUT")
    return StopBound("no command", "HOLD", "FS_TIMEOUT", bound, _age(facts))


def _heartbeat(facts: StopFacts) -> StopBound:
    enabled = facts.value("FS_GCS_ENABLE")
    goes_on = facts.drives_itself and enabled == AUTO_GOES_ON
    action = None if enabled is None else "" if is_off(enabled) or goes_on else "HOLD"
    return action_bound("no station", "FS_GCS_TIMEOUT", facts.value("FS_GCS_TIMEOUT"), action, facts.quiet)


def _operator(facts: StopFacts) -> StopBound:
    return StopBound("no key", "neutral", "OPR_TIMEOUT", facts.value("OPR_TIMEOUT"), facts.input_age)


def _fence(facts: StopFacts) -> StopBound:
    enabled, selected = facts.value("FENCE_ENABLE"), facts.value("FENCE_ACTION")
    if is_off(enabled) or is_off(selected):
        return StopBound("fence", "nothing", "FENCE_ENABLE", never=True, unit="m")
    action = None if enabled is None or selected is None else FENCE_ACTIONS.get(int(selected))
    return StopBound("fence", action or "--", "FENCE_ACTION", None if action is None else 0.0, unit="m")


def _battery(facts: StopFacts) -> StopBound:
    limit, selected = facts.value("BATT_LOW_VOLT"), facts.value("FS_LOW_ACT")
    if is_off(limit):
        return StopBound("battery", "nothing", "BATT_LOW_VOLT", never=True, unit="V")
    does = "--" if selected is None else "slower" if is_off(selected) else "HOLD"
    return StopBound("battery", does, "BATT_LOW_VOLT", limit, facts.voltage, unit="V")


def _tilt(facts: StopFacts) -> StopBound:
    limit = facts.value("CRASH_ANGLE")
    if is_off(limit):
        return StopBound("tilt", "nothing", "CRASH_ANGLE", never=True, unit="deg")
    return StopBound("tilt", "disarm", "CRASH_ANGLE", limit, facts.tilt, unit="deg")


ROVER_STOPS = StopRules(
    rules=(_command, _command_then, _heartbeat, _operator, _fence, _battery, _tilt),
    params=(
        "MAN_TIMEOUT", "FS_TIMEOUT", "FS_GCS_ENABLE", "FS_GCS_TIMEOUT", "OPR_TIMEOUT", "FENCE_ENABLE", "FENCE_ACTION",
        "BATT_LOW_VOLT", "FS_LOW_ACT", "CRASH_ANGLE",
    ),
)  # fmt: skip
