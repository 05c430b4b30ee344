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


class Action(IntEnum):
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
    def words(self) -> str:
        """As the driver reads it."""
        return ("warning", "half speed", "stopping", "RTL", "HOLD", "disarmed")[self]


@dataclass(frozen=True, slots=True)
class Step:
    """What happens `after` s (a number, or the parameter that holds it) of the condition."""

    after: str | float
    action: Action
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
class Rule:
    """One condition."""

    words: str
    steps: tuple[Step, ...]
    blocks_modes: bool = False
    """While it lasts no mode with motion can be chosen."""


RULES: dict[Failsafe, Rule] = {
    Failsafe.MANUAL_LOSS: Rule("manual control lost", (
        Step(0, Action.NEUTRAL), Step("FS_TIMEOUT", Action.HOLD), Step("FS_DISARM_T", Action.DISARM))),
    Failsafe.GCS_LOSS: Rule("ground station lost", (
        Step(0, Action.HOLD), Step(60, Action.DISARM))),
    Failsafe.OPERATOR: Rule("no sign of the operator", (
        Step(0, Action.NEUTRAL), Step("FS_TIMEOUT", Action.HOLD), Step("FS_DISARM_T", Action.DISARM))),
    Failsafe.BATTERY_LOW: Rule("battery low", (
        Step(0, Action.LIMIT), Step(0, Action.HOLD, only_if="FS_LOW_ACT"))),
    Failsafe.BATTERY_CRITICAL: Rule("battery critical", (
        Step(0, Action.HOLD), Step(10, Action.DISARM)), blocks_modes=True),
    Failsafe.OVERHEAT: Rule("Pi too hot or its supply too weak", (
        Step(0, Action.LIMIT), Step("FS_PI_TIMER", Action.HOLD, only_if="FS_PI_ACT", value=2))),
    Failsafe.GUIDED_LOSS: Rule("setpoints lost", (
        Step(0, Action.NEUTRAL), Step(4, Action.HOLD))),
    Failsafe.POSITION: Rule("position lost", (
        Step(0, Action.NEUTRAL), Step(1, Action.HOLD))),
    Failsafe.FENCE: Rule("beyond the fence", (
        Step(0, Action.WARN),
        Step(0, Action.RTL, only_if="FENCE_ACTION", value=1),
        Step(0, Action.HOLD, only_if="FENCE_ACTION", value=2))),
    Failsafe.TILT: Rule("tilted", (
        Step(0.5, Action.DISARM),)),
    Failsafe.BLOCKED: Rule("blocked", (
        Step(2, Action.HOLD, only_if="FS_CRASH_CHECK"), Step(2, Action.DISARM, only_if="FS_CRASH_CHECK", value=2))),
}  # fmt: skip
"""Condition -> what happens. A failed motor driver and the emergency stop act at once and are in vehicle/safety/state_machine.py, a
late control loop in vehicle/safety/monitor.py. A HOLD happens once, so that the driver can choose MANUAL again where the
condition allows it."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A step that has just been reached."""

    cause: Failsafe
    action: Action


@dataclass(frozen=True, slots=True)
class Next:
    """The step that comes next."""

    delay: float
    action: Action


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
        self._done: dict[Failsafe, tuple[Step, ...]] = {}

    def update(self, conditions: Mapping[Failsafe, float], now: float) -> list[Taken]:
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

    def action(self, now: float) -> Action:
        """The worst up to NEUTRAL that holds now: a HOLD or DISARM is carried by the mode and the state."""
        if not self._since:  # nearly always
            return Action.WARN
        lasting = [self._lasting(cause, now) for cause in self._since]
        return max(lasting, default=Action.WARN)

    def blocks_modes(self) -> Failsafe:
        """Conditions that forbid to choose a mode with motion."""
        return Failsafe(sum(cause for cause in self._since if RULES[cause].blocks_modes))

    def next_step(self, now: float) -> Next | None:
        """The next HOLD or DISARM that will come if nothing changes."""
        coming = [
            Next(since + step.delay(self._params) - now, step.action)
            for cause, since in self._since.items()
            if cause in self.active
            for step in RULES[cause].steps
            if step.action >= Action.HOLD and now < since + step.delay(self._params) < math.inf
        ]
        return min(coming, key=lambda each: each.delay, default=None)

    def acknowledge(self) -> None:
        """The driver has chosen a mode or armed: what is past is past."""
        self.latched = Failsafe(0)

    def _advance(self, cause: Failsafe, now: float) -> list[Taken]:
        reached = self._reached(cause, now)
        new = [step for step in reached if step not in self._done.get(cause, ())]
        self._done[cause] = reached
        if any(step.action >= Action.RTL for step in new):
            self.latched |= cause
        return [Taken(cause, step.action) for step in new]

    def _lasting(self, cause: Failsafe, now: float) -> Action:
        actions = (step.action for step in self._reached(cause, now))
        return max((action for action in actions if action <= Action.NEUTRAL), default=Action.WARN)

    def _reached(self, cause: Failsafe, now: float) -> tuple[Step, ...]:
        return tuple(step for step in RULES[cause].steps if now >= self._since[cause] + step.delay(self._params))
