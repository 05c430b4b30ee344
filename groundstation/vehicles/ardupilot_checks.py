"""Reads the parameters of an ArduPilot rover that would let it drive on without us, and warns of them.

ArduPilot keeps the last demand for RC_OVERRIDE_TIME (3 s by default) and its ground station failsafe is off by default
(measured on ArduRover 4.7). The station only reads; which values are right is the owner's decision.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects.enums import Autopilot
from dialects.messages import ParamValue
from link.core import Outgoing, Received
from link.services.param.client import ParamClient

REPEAT_AFTER = 1.0
"""s: a parameter takes 0.1 s over UDP and up to 1 s over 57600 baud; ArduPilot does not answer for unknown ones."""

TRIES = 3

LONGEST_OVERRIDE = 1.0
"""s for which a vehicle may keep a demand that is not renewed before we warn."""

ParamCheck = Callable[[float, int], str | None]


def _override_time(value: float, system: int) -> str | None:
    if value < 0:
        return "RC_OVERRIDE_TIME -1: never stops when the link is lost"
    if value > LONGEST_OVERRIDE:
        return f"RC_OVERRIDE_TIME {value:g}: drives on for {value:g} s when the link is lost"
    return None


def _gcs_failsafe(value: float, system: int) -> str | None:
    return "FS_GCS_ENABLE 0: no failsafe when the ground station is lost" if value == 0 else None


def _throttle_failsafe(value: float, system: int) -> str | None:
    return "FS_THR_ENABLE 0: without an RC receiver never stops when the link is lost" if value == 0 else None


def _station_system(value: float, system: int) -> str | None:
    wanted = int(value) & 0xFF  # ArduPilot accepts 300 and uses the low byte
    if wanted == system:
        return None
    return f"obeys ground station {wanted} only and we are {system}: use --system {wanted}"


PARAM_CHECKS: dict[str, ParamCheck] = {
    "RC_OVERRIDE_TIME": _override_time,
    "FS_GCS_ENABLE": _gcs_failsafe,
    "FS_THR_ENABLE": _throttle_failsafe,
    "MAV_GCS_SYSID": _station_system,
    "SYSID_MYGCS": _station_system,
}
"""Parameter -> its check. MAV_GCS_SYSID is called SYSID_MYGCS up to 4.6; a vehicle has one of them."""


class ArduPilotChecks:
    """Reads the parameters of one vehicle once and keeps the warnings. `system` and `component` are our ids."""

    def __init__(self, system: int, component: int, *, target: tuple[int, int]) -> None:
        self._system = system
        self._params = ParamClient(
            system,
            component,
            target_system=target[0],
            target_component=target[1],
            repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )
        self._started = False
        self._found: dict[str, str | None] = {}

    @classmethod
    def applies_to(cls, autopilot: int) -> bool:
        """Return whether this autopilot has these parameters."""
        return autopilot == Autopilot.ARDUPILOT

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each dangerous parameter."""
        return tuple(warning for warning in self._found.values() if warning)

    def receive(self, received: Received, now: float) -> list[str]:
        """Check a PARAM_VALUE and return new warnings; other messages and other parameters are ignored."""
        message = received.message
        if not isinstance(message, ParamValue) or not math.isfinite(message.param_value):
            return []
        if message.param_id not in PARAM_CHECKS:
            return []
        self._params.receive(received, now)
        return self._check(message.param_id)

    def tick(self, now: float) -> list[Outgoing]:
        """Return the read requests that are due: one for each parameter, repeated a few times."""
        if not self._started:
            self._started = True
            for name in PARAM_CHECKS:
                if name not in self._found:
                    self._params.read(name, now)
        self._params.tick(now)
        return self._params.messages_to_send()

    def _check(self, name: str) -> list[str]:
        param = self._params.params.get(name)
        if param is None:
            return []
        before, warning = self._found.get(name), PARAM_CHECKS[name](param.value, self._system)
        self._found[name] = warning
        return [warning] if warning is not None and warning != before else []
