"""The safety states and their transitions, as one table.

BOOT --ready--> SAFE --arm--> ARMED
                 ^ <--disarm--  |
   release       |              | fail (motor driver)
ESTOP -----------+              v
  ^              +--repair--- FAULT
  +-- stop: from every state but OFF, in the same cycle
OFF: after shutdown, from every state
"""

from __future__ import annotations

from enum import Enum


class SafetyState(Enum):
    """Motors may turn in ARMED only."""

    BOOT = "boot"
    SAFE = "safe"
    """Disarmed and ready to arm."""
    ARMED = "armed"
    ESTOP = "estop"
    """Emergency stop by a command or the button, latched until it is released."""
    FAULT = "fault"
    """The motor driver has failed."""
    OFF = "off"
    """Shut down; there is no transition to another state."""


class SafetyEvent(Enum):
    """Events that may change the state. An event that is not allowed leaves the state unchanged."""

    READY = "ready"
    ARM = "arm"
    DISARM = "disarm"
    STOP = "stop"
    """Emergency stop."""
    RELEASE = "release"
    """The emergency stop is released; arming is a separate step."""
    FAIL = "fail"
    """The motor driver fails."""
    REPAIR = "repair"
    """The motor driver works again."""
    SHUTDOWN = "shutdown"


_B, _S, _A, _E, _F, _O = SafetyState

TRANSITIONS: dict[tuple[SafetyState, SafetyEvent], SafetyState] = {
    (state, event): after
    for event, row in {
        #               BOOT SAFE ARMED ESTOP FAULT OFF
        SafetyEvent.READY:    (_S, _S, _A, _E, _F, _O),
        SafetyEvent.ARM:      (_B, _A, _A, _E, _F, _O),
        SafetyEvent.DISARM:   (_B, _S, _S, _E, _F, _O),
        SafetyEvent.STOP:     (_E, _E, _E, _E, _E, _O),
        SafetyEvent.RELEASE:  (_B, _S, _A, _S, _F, _O),
        SafetyEvent.FAIL:     (_F, _F, _F, _E, _F, _O),
        SafetyEvent.REPAIR:   (_B, _S, _A, _E, _S, _O),
        SafetyEvent.SHUTDOWN: (_O, _O, _O, _O, _O, _O),
    }.items()
    for state, after in zip(SafetyState, row, strict=True)
}  # fmt: skip
"""(state, event) -> next state, for every pair. vehicle/safety/state_machine.py remembers a motor driver fault during
an emergency stop and restores FAULT when the stop is released."""
