"""The vehicle's safety state and what changes it, as one table.

BOOT --ready--> SAFE --arm--> ARMED
                 ^ <--disarm--  |
   release       |              | fail (motor driver)
ESTOP -----------+              v
  ^              +--repair--- FAULT
  +-- stop: from every state but OFF, in the same cycle
OFF: the end, from every state
"""

from __future__ import annotations

from enum import Enum


class SafetyState(Enum):
    """Only in ARMED may a motor turn."""

    BOOT = "boot"
    SAFE = "safe"
    """Disarmed and able to arm."""
    ARMED = "armed"
    ESTOP = "estop"
    """Emergency stop, by a command or the button, latched until it is released."""
    FAULT = "fault"
    """The motor driver has failed."""
    OFF = "off"
    """Shut down; nothing leads out."""


class SafetyEvent(Enum):
    """What may happen to the state. What is not allowed leaves it as it is."""

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
"""(state, event) -> state, every cell. A driver fault during an emergency stop is kept by vehicle/safety/state_machine.py and
comes back when the stop is released."""
