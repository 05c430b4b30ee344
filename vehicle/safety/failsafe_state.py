"""Which failsafe conditions hold, and which steps of vehicle/safety/failsafe.py were taken."""

from __future__ import annotations

import math
from collections.abc import Mapping

import msgspec

from dialects.enums import Failsafe
from vehicle.params import Params
from vehicle.safety.failsafe import RULES, FailsafeAction, FailsafeStep
from vehicle.safety.failsafe_inputs import FailsafeInputs


class TriggeredStep(msgspec.Struct, frozen=True):
    """A step that has just been reached."""

    cause: Failsafe
    action: FailsafeAction


class PendingStep(msgspec.Struct, frozen=True):
    """The step that comes next."""

    delay: float
    action: FailsafeAction


class Failsafes:
    """Which conditions hold, since when, and which of their steps have been taken."""

    def __init__(self, params: Params) -> None:
        self.latched = Failsafe(0)
        """Conditions that changed the mode or disarmed, until the operator chooses a mode or arms again."""
        self.active = Failsafe(0)
        """Conditions that hold and have reached a step. A condition that may pass before its first step, such as a
        standstill at full throttle while accelerating, is not active yet."""
        self._params = params
        self._began: dict[Failsafe, float] = {}
        self._since: dict[Failsafe, float] = {}
        self._done: dict[Failsafe, tuple[FailsafeStep, ...]] = {}

    @property
    def quiet(self) -> bool:
        """Whether no condition held at the last check, not even one that has reached no step yet."""
        return not self._since

    def check(self, inputs: FailsafeInputs, now: float, *, armed: bool) -> list[TriggeredStep]:
        """Evaluate the conditions of RULES and return the steps reached since the last call.

        Disarmed, no step is reached.
        """
        found = {
            cause: rule.condition(inputs, now) for cause, rule in RULES.items() if armed or rule.timed_while_disarmed
        }
        self._began = {cause: min(at, self._began.get(cause, at)) for cause, at in found.items() if at is not None}
        return self.update(self._began if armed else {}, now)

    def update(self, conditions: Mapping[Failsafe, float], now: float) -> list[TriggeredStep]:
        """Set the conditions that hold and return the steps reached since the last call.

        `conditions` has the time when each began; the earliest time given while a condition lasts counts.
        """
        if not conditions and not self._since:  # nearly always
            return []
        self._since = {cause: min(began, self._since.get(cause, began)) for cause, began in conditions.items()}
        self._done = {cause: done for cause, done in self._done.items() if cause in conditions}
        taken = [step for cause in conditions for step in self._advance(cause, now)]
        self.active = Failsafe(sum(cause for cause, done in self._done.items() if done))
        return taken

    def lasting_action(self, now: float) -> FailsafeAction:
        """Return the worst action up to NEUTRAL that holds now; mode and state keep HOLD and DISARM."""
        if not self._since:  # nearly always
            return FailsafeAction.WARN
        lasting = [self._lasting(cause, now) for cause in self._since]
        return max(lasting, default=FailsafeAction.WARN)

    def mode_blocking_conditions(self) -> Failsafe:
        """Return the conditions that block modes with motion."""
        return Failsafe(sum(cause for cause in self._since if RULES[cause].blocks_modes))

    def next_step(self, now: float) -> PendingStep | None:
        """Return the next HOLD or DISARM if the conditions last."""
        coming = [
            PendingStep(since + step.delay(self._params) - now, step.action)
            for cause, since in self._since.items()
            if cause in self.active
            for step in RULES[cause].steps
            if step.action >= FailsafeAction.HOLD and now < since + step.delay(self._params) < math.inf
        ]
        return min(coming, key=lambda each: each.delay, default=None)

    def acknowledge(self) -> None:
        """Clear the latched conditions: the operator has chosen a mode or armed."""
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
