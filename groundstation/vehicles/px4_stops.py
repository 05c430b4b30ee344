"""What stops a PX4 vehicle: its failsafes for manual control lost and for the data link lost.

https://docs.px4.io/main/en/advanced_config/parameter_reference.html
"""

from __future__ import annotations

from groundstation.snapshot.drive import StopBound
from groundstation.vehicles.stop_rules import StopFacts, StopRules, action_bound

ACTIONS = {0: "", 1: "HOLD", 2: "RTL", 3: "LAND", 5: "terminate", 6: "disarm"}
"""NAV_RCL_ACT and NAV_DLL_ACT -> what follows; "": nothing."""

IGNORES_KEYS = (0, 4)
"""COM_RC_IN_MODE: RC only, or no manual control at all."""


def _action(facts: StopFacts, name: str) -> str | None:
    selected = facts.value(name)
    return None if selected is None else ACTIONS.get(int(selected))


def _command(facts: StopFacts) -> StopBound:
    if facts.value("COM_RC_IN_MODE") in IGNORES_KEYS:
        return StopBound("no command", "ignored", "COM_RC_IN_MODE")
    age = None if facts.drives_itself else facts.command_age
    bound, action = facts.value("COM_RC_LOSS_T"), _action(facts, "NAV_RCL_ACT")
    return action_bound("no command", "COM_RC_LOSS_T", bound, action, age, estimated=facts.estimated)


def _station(facts: StopFacts) -> StopBound:
    bound, action = facts.value("COM_DL_LOSS_T"), _action(facts, "NAV_DLL_ACT")
    return action_bound("no station", "COM_DL_LOSS_T", bound, action, facts.quiet, estimated=True)


PX4_STOPS = StopRules(rules=(_command, _station), params=())
"""All of them are read by the settings check."""
