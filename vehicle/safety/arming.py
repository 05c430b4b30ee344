"""Pre-arm checks, as one table. To add a check, write a function and a row in CHECKS."""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from vehicle.params import Params
from vehicle.safety.states import SafetyState


class ArmingFacts(msgspec.Struct, frozen=True):
    """The facts that the checks evaluate."""

    params: Params
    state: SafetyState
    terminated: bool = False
    estop_reason: str | None = None
    """Why the emergency stop button stops the vehicle, or None."""
    fault: str | None = None
    mode: str | None = None
    """Why the mode is not available now, or None."""
    fence: str | None = None
    """Why the enabled fence cannot be enforced, or None."""
    battery_low: bool = False
    battery_critical: bool = False
    battery_silent: bool = False
    computer: str | None = None
    """Under-voltage or overheating of the Pi now, or None."""
    sticks_moving: bool = False


class ArmingCheck(msgspec.Struct, frozen=True):
    """`find` returns the problem in a form that an operator understands, or None."""

    find: Callable[[ArmingFacts], str | None]
    hard: bool
    """Arming by force does not skip the check."""


def _emergency_stop(facts: ArmingFacts) -> str | None:
    if facts.terminated:
        return "terminated, restart the vehicle"
    if facts.estop_reason is not None:
        return facts.estop_reason
    return "emergency stop, release it first" if facts.state is SafetyState.ESTOP else None


def _motor_driver(facts: ArmingFacts) -> str | None:
    return f"motor driver: {facts.fault}" if facts.fault else None


def _running(facts: ArmingFacts) -> str | None:
    return f"vehicle is in state {facts.state.value}" if facts.state in (SafetyState.BOOT, SafetyState.OFF) else None


def _parameters(facts: ArmingFacts) -> str | None:
    """Return the first contradiction between parameters; each single value is in its range already."""
    params = facts.params
    if params["BATT_LOW_VOLT"] and params["BATT_CRT_VOLT"] > params["BATT_LOW_VOLT"]:
        return "BATT_CRT_VOLT is above BATT_LOW_VOLT"
    if params["FS_DISARM_T"] < params["FS_TIMEOUT"]:
        return "FS_DISARM_T is shorter than FS_TIMEOUT"
    return None


def _saved_parameters(facts: ArmingFacts) -> str | None:
    damage = facts.params.damage
    return f"{damage}, using defaults; set one to continue" if damage else None


def _mode(facts: ArmingFacts) -> str | None:
    return f"mode not available: {facts.mode}" if facts.mode else None


def _fence(facts: ArmingFacts) -> str | None:
    return facts.fence


def _battery(facts: ArmingFacts) -> str | None:
    if facts.battery_silent:
        return "no data from the battery sensor"
    if facts.battery_critical:
        return "battery critical"
    return "battery low" if facts.battery_low else None


def _computer(facts: ArmingFacts) -> str | None:
    return facts.computer if facts.params["FS_PI_ACT"] else None


def _sticks(facts: ArmingFacts) -> str | None:
    return "throttle or steering not neutral" if facts.sticks_moving else None


CHECKS: tuple[ArmingCheck, ...] = (
    ArmingCheck(_emergency_stop, hard=True),
    ArmingCheck(_motor_driver, hard=True),
    ArmingCheck(_running, hard=True),
    ArmingCheck(_parameters, hard=True),
    ArmingCheck(_saved_parameters, hard=True),
    ArmingCheck(_mode, hard=True),
    ArmingCheck(_fence, hard=True),
    ArmingCheck(_battery, hard=False),
    ArmingCheck(_computer, hard=False),
    ArmingCheck(_sticks, hard=False),
)


def find_problems(facts: ArmingFacts, *, force: bool = False) -> list[str]:
    """Return what prevents arming, most severe first; empty if nothing does."""
    found = (check.find(facts) for check in CHECKS if check.hard or not force)
    return [problem for problem in found if problem]
