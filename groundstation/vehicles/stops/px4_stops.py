"""What stops a PX4 vehicle: its failsafes for manual control lost and for the data link lost.

Terminate and disarm act at once. All other actions begin with Hold, which keeps a place and may drive for it; what is
selected beyond that follows COM_FAIL_ACT_T later (measured with a simulated rover: hold 0.7 s and return 5.9 s after
the last demand, with 0.5 and 5 s). https://docs.px4.io/main/en/advanced_config/parameter_reference.html
"""

from __future__ import annotations

from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stops.stop_rules import StopFacts, StopRules, action_bound

FIRST = {0: "", 1: "HOLD", 2: "HOLD", 3: "HOLD", 5: "terminate", 6: "disarm"}
"""NAV_RCL_ACT and NAV_DLL_ACT -> what follows first; "": nothing."""

THEN = {2: "RTL", 3: "LAND"}
"""The same -> what follows COM_FAIL_ACT_T later."""

HOLD_TIME = "COM_FAIL_ACT_T"

IGNORES_KEYS = (0, 4)
"""COM_RC_IN_MODE: RC only, or no manual control at all."""


def _selected(facts: StopFacts, name: str) -> int | None:
    selected = facts.value(name)
    return None if selected is None else int(selected)


def _age(facts: StopFacts) -> float | None:
    return None if facts.drives_itself else facts.command_age


def _command(facts: StopFacts) -> StopBound:
    if facts.value("COM_RC_IN_MODE") in IGNORES_KEYS:
        return StopBound("no command", "ignored", "COM_RC_IN_MODE")
    selected = _selected(facts, "NAV_RCL_ACT")
    action = None if selected is None else FIRST.get(selected)
    bound = facts.value("COM_RC_LOSS_T")
    return action_bound("no command", "COM_RC_LOSS_T", bound, action, _age(facts), estimated=facts.estimated)


def _command_later(facts: StopFacts) -> StopBound:
    selected = _selected(facts, "NAV_RCL_ACT")
    action = THEN.get(selected) if selected is not None else None
    if action is None or facts.value("COM_RC_IN_MODE") in IGNORES_KEYS:
        return StopBound("... then", "--", "NAV_RCL_ACT")
    bound = facts.sum("COM_RC_LOSS_T", HOLD_TIME)
    return action_bound("... then", HOLD_TIME, bound, action, _age(facts), estimated=facts.estimated)


def _station(facts: StopFacts) -> StopBound:
    selected = _selected(facts, "NAV_DLL_ACT")
    action = None if selected is None else THEN.get(selected, FIRST.get(selected))
    bound = facts.sum("COM_DL_LOSS_T", HOLD_TIME) if selected in THEN else facts.value("COM_DL_LOSS_T")
    return action_bound("no station", "COM_DL_LOSS_T", bound, action, facts.quiet, estimated=True)


PX4_STOPS = StopRules(rules=(_command, _command_later, _station), params=())
"""All of them are read by the settings check."""
