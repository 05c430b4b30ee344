"""Reads those parameters of one vehicle that its display needs: limits of outputs, bounds of failsafes.

The parameters that are dangerous when wrong are read by settings_check.py, which warns of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable

from dialects.messages import ParamValue
from link.core import Outgoing, Received
from link.services.param.client import ParamClient

REPEAT_AFTER, TRIES = 1.0, 3
"""As in settings_check.py: 0.1 s over UDP, 1 s over 57600 baud; unknown parameters are not answered."""

RETRY_PERIOD = 60.0
"""s until those that were not answered are requested again."""


class VehicleParams:
    """The values that are known. `system` and `component` are our ids."""

    def __init__(self, system: int, component: int, *, target: tuple[int, int]) -> None:
        self._own_id = (system, component)
        self._target = target
        self._wanted: dict[str, None] = {}
        self.restart()

    def restart(self) -> None:
        """Read again: the vehicle may have restarted with other values."""
        self._params = ParamClient(
            *self._own_id, target_system=self._target[0], target_component=self._target[1], repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )  # fmt: skip
        self.values: dict[str, float] = {}
        self._unrequested = dict(self._wanted)
        self._given_up: set[str] = set()
        self._retry_at = math.inf

    def want(self, names: Iterable[str]) -> None:
        """Read these parameters as well."""
        new = [name for name in names if name not in self._wanted]
        self._wanted |= dict.fromkeys(new)
        self._unrequested |= dict.fromkeys(new)

    def receive(self, received: Received, now: float) -> bool:
        """Handle a PARAM_VALUE, also one that was not requested. Return whether a value has changed."""
        message = received.message
        if not isinstance(message, ParamValue) or message.param_id not in self._wanted:
            return False
        self._params.receive(received, now)
        param = self._params.params.get(message.param_id)
        if param is None or not math.isfinite(param.value):
            return False
        before, self.values[param.name] = self.values.get(param.name), param.value
        return before != param.value

    def is_reading(self, names: Iterable[str]) -> bool:
        """Return whether one of these is neither known nor given up yet."""
        return any(name not in self.values and name not in self._given_up for name in names)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the read requests that are due."""
        if now >= self._retry_at:
            self._retry_at = math.inf
            self._unrequested = {name: None for name in self._wanted if name not in self.values}
        for name in self._unrequested:
            self._params.read(name, now)
        if self._unrequested:
            self._unrequested, self._retry_at = {}, now + RETRY_PERIOD
        self._params.tick(now)
        self._given_up |= {outcome.name for outcome in self._params.outcomes() if not outcome.done}
        return self._params.messages_to_send()
