"""Failsafes: condition -> actions, one table; the worst action wins. Conditions are found in failsafe_inputs.py.

To add a failsafe: a line in RULES here, and its condition in vehicle/safety/failsafe_inputs.py. Only RTL starts a motion, and
only where a setting asks for it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from enum import IntEnum

from dialects.enums import Failsafe
from vehicle.params import Params


class FailsafeAction(IntEnum):
    """What a failsafe does; the larger number wins."""

    WARN = 0
    """Say so."""
    LIMIT = 1
    """Half speed."""
    NEUTRAL = 2
    """Ramp down and stay there as long as the condition lasts."""
    RTL = 3
    """The way home begins, or HOLD where it cannot."""
    HOLD = 4
    """Neutral, and the mode becomes HOLD: the driver has to choose another."""
    DISARM = 5

    @property
    def label(self) -> str:
        """As the driver reads it."""
        return ("warning", "half speed", "stopping", "RTL", "HOLD", "disarmed")[self]


@dataclass(frozen=True, slots=True)
class FailsafeStep:
    """What happens `after` s (a number, or the parameter that holds it) of the condition."""

    after: str | float
    action: FailsafeAction
    only_if: str | None = None
    """A parameter that turns the step off when it is 0 ..."""
    value: float | None = None
    """... or when it is not this."""

    def delay(self, params: Params) -> float:
        """s from the condition to the action; infinite where it is turned off."""
        if self.only_if is not None and not self._chosen(params[self.only_if]):
            return math.inf
        return params[self.after] if isinstance(self.after, str) else self.after

    def _chosen(self, setting: float) -> bool:
        return bool(setting) if self.value is None else setting == self.value


@dataclass(frozen=True, slots=True)
class FailsafeRule:
    """One condition."""

    label: str
    steps: tuple[FailsafeStep, ...]
    blocks_modes: bool = False
    """While it lasts no mode with motion can be chosen."""


RULES: dict[Failsafe, FailsafeRule] = {
    Failsafe.MANUAL_LOSS: FailsafeRule("manual control lost", (
        FailsafeStep(0, FailsafeAction.NEUTRAL), FailsafeStep("FS_TIMEOUT", FailsafeAction.HOLD), FailsafeStep("FS_DISARM_T", FailsafeAction.DISARM))),
    Failsafe.GCS_LOSS: FailsafeRule("ground station lost", (
        FailsafeStep(0, FailsafeAction.HOLD), FailsafeStep(60, FailsafeAction.DISARM))),
    Failsafe.OPERATOR: FailsafeRule("no sign of the operator", (
        FailsafeStep(0, FailsafeAction.NEUTRAL), FailsafeStep("FS_TIMEOUT", FailsafeAction.HOLD), FailsafeStep("FS_DISARM_T", FailsafeAction.DISARM))),
    Failsafe.BATTERY_LOW: FailsafeRule("battery low", (
        FailsafeStep(0, FailsafeAction.LIMIT), FailsafeStep(0, FailsafeAction.HOLD, only_if="FS_LOW_ACT"))),
    Failsafe.BATTERY_CRITICAL: FailsafeRule("battery critical", (
        FailsafeStep(0, FailsafeAction.HOLD), FailsafeStep(10, FailsafeAction.DISARM)), blocks_modes=True),
    Failsafe.OVERHEAT: FailsafeRule("Pi too hot or its supply too weak", (
        FailsafeStep(0, FailsafeAction.LIMIT), FailsafeStep("FS_PI_TIMER", FailsafeAction.HOLD, only_if="FS_PI_ACT", value=2))),
    Failsafe.GUIDED_LOSS: FailsafeRule("setpoints lost", (
        FailsafeStep(0, FailsafeAction.NEUTRAL), FailsafeStep(4, FailsafeAction.HOLD))),
    Failsafe.POSITION: FailsafeRule("position lost", (
        FailsafeStep(0, FailsafeAction.NEUTRAL), FailsafeStep(1, FailsafeAction.HOLD))),
    Failsafe.FENCE: FailsafeRule("beyond the fence", (
        FailsafeStep(0, FailsafeAction.WARN),
        FailsafeStep(0, FailsafeAction.RTL, only_if="FENCE_ACTION", value=1),
        FailsafeStep(0, FailsafeAction.HOLD, only_if="FENCE_ACTION", value=2))),
    Failsafe.TILT: FailsafeRule("tilted", (
        FailsafeStep(0.5, FailsafeAction.DISARM),)),
    Failsafe.BLOCKED: FailsafeRule("blocked", (
        FailsafeStep(2, FailsafeAction.HOLD, only_if="FS_CRASH_CHECK"), FailsafeStep(2, FailsafeAction.DISARM, only_if="FS_CRASH_CHECK", value=2))),
}  # fmt: skip
"""Condition -> what happens. A failed motor driver and the emergency stop act at once and are in vehicle/safety/state_machine.py, a
late control loop in vehicle/safety/monitor.py. A HOLD happens once, so that the driver can choose MANUAL again where the
condition allows it."""


@dataclass(frozen=True, slots=True)
class TriggeredStep:
    """A step that has just been reached."""

    cause: Failsafe
    action: FailsafeAction


@dataclass(frozen=True, slots=True)
class PendingStep:
    """The step that comes next."""

    delay: float
    action: FailsafeAction


class Failsafes:
    """Which conditions hold, since when, and how far their steps have come."""

    def __init__(self, params: Params) -> None:
        self.latched = Failsafe(0)
        """Conditions that took the mode or the arming away, until the driver chooses anew."""
        self.active = Failsafe(0)
        """Conditions that have come to something and hold still. One that may pass before its first step, as standing
        for a moment at full throttle, is none yet."""
        self._params = params
        self._since: dict[Failsafe, float] = {}
        self._done: dict[Failsafe, tuple[FailsafeStep, ...]] = {}

    def update(self, conditions: Mapping[Failsafe, float], now: float) -> list[TriggeredStep]:
        """Take the conditions that hold, each with the time it began (of a lasting one the earliest told counts).

        Returns the steps reached since the last call.
        """
        if not conditions and not self._since:  # nearly always
            return []
        self._since = {cause: min(began, self._since.get(cause, began)) for cause, began in conditions.items()}
        self._done = {cause: done for cause, done in self._done.items() if cause in conditions}
        taken = [step for cause in conditions for step in self._advance(cause, now)]
        self.active = Failsafe(sum(cause for cause, done in self._done.items() if done))
        return taken

    def lasting_action(self, now: float) -> FailsafeAction:
        """The worst up to NEUTRAL that holds now: a HOLD or DISARM is carried by the mode and the state."""
        if not self._since:  # nearly always
            return FailsafeAction.WARN
        lasting = [self._lasting(cause, now) for cause in self._since]
        return max(lasting, default=FailsafeAction.WARN)

    def mode_blocking_conditions(self) -> Failsafe:
        """Conditions that forbid to choose a mode with motion."""
        return Failsafe(sum(cause for cause in self._since if RULES[cause].blocks_modes))

    def next_step(self, now: float) -> PendingStep | None:
        """The next HOLD or DISARM that will come if nothing changes."""
        coming = [
            PendingStep(since + step.delay(self._params) - now, step.action)
            for cause, since in self._since.items()
            if cause in self.active
            for step in RULES[cause].steps
            if step.action >= FailsafeAction.HOLD and now < since + step.delay(self._params) < math.inf
        ]
        return min(coming, key=lambda each: each.delay, default=None)

    def acknowledge(self) -> None:
        """The driver has chosen a mode or armed: what is past is past."""
        self.latched = Failsafe(0)

    def _advance(self, cause: Failsafe, now: float) -> list[TriggeredStep]:
        reached = self._reached(cause, now)
        new = [step for step in reached if step not in self._done.get(cause, ())]
        self._done[cause] = reached
        if any(step.action >= FailsafeAction.RTL for step in new):
            self.latched |= cause
        return [TriggeredStep(cause, step.action) for step in new]

    def _lasting(self, cause: Failsafe, now: float) -> FailsafeAction:
        actions = (step.action for step in self._reached(cause, now))
        return max((action for action in actions if action <= FailsafeAction.NEUTRAL), default=FailsafeAction.WARN)

    def _reached(self, cause: Failsafe, now: float) -> tuple[FailsafeStep, ...]:
        return tuple(step for step in RULES[cause].steps if now >= self._since[cause] + step.delay(self._params))
