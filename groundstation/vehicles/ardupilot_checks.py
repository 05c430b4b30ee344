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

RETRY_PERIOD = 10.0
"""s after a round of TRIES requests until the parameters that were not answered are requested again."""

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
"""Parameter -> its check."""

FORMER_NAMES = {"MAV_GCS_SYSID": "SYSID_MYGCS"}
"""Parameter -> its name up to ArduPilot 4.6; a vehicle has one of them."""


_OBEYED = tuple(name for pair in FORMER_NAMES.items() for name in pair)
"""Parameters with the ground station that the vehicle obeys."""


class ArduPilotChecks:
    """Reads the parameters of one vehicle and keeps the warnings. `system` and `component` are our ids.

    A parameter that was not answered is named in a warning, and requested again until it is known.
    """

    def __init__(self, system: int, component: int, *, target: tuple[int, int]) -> None:
        self._system = system
        self._component = component
        self._target = target
        self.restart()

    def restart(self) -> None:
        """Start again: the vehicle may have restarted with other values."""
        self._params = ParamClient(
            self._system,
            self._component,
            target_system=self._target[0],
            target_component=self._target[1],
            repeat_after=REPEAT_AFTER,
            tries=TRIES,
        )
        self._found: dict[str, str | None] = {}
        self._round_due = -math.inf
        self._given_up_at = math.inf
        """When the first round of requests ends."""
        self._missing: tuple[str, ...] = ()
        """Parameters that were not answered in a whole round."""
        self._unreported = True

    @classmethod
    def applies_to(cls, autopilot: int) -> bool:
        """Return whether this autopilot has these parameters."""
        return autopilot == Autopilot.ARDUPILOT

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line for each dangerous parameter, and one that names those that could not be read."""
        found = (warning for name, warning in self._found.items() if name not in _OBEYED)
        return (*filter(None, found), *self._missing_warning())

    @property
    def obeys(self) -> str | None:
        """Warning that the vehicle obeys another ground station only; None: it obeys us, or not known."""
        return next(filter(None, map(self._found.get, _OBEYED)), None)

    def pop_missing_warning(self) -> list[str]:
        """Return the warning that names the parameters that could not be read, once after each (re)start."""
        warning = self._missing_warning()
        if not warning or not self._unreported:
            return []
        self._unreported = False
        return warning

    @property
    def without_link(self) -> str | None:
        """What these settings make of a lost link; None until both that decide are known."""
        override, throttle = (self._params.params.get(name) for name in ("RC_OVERRIDE_TIME", "FS_THR_ENABLE"))
        if override is None or throttle is None:
            return None
        if override.value < 0:
            return "by its settings it never stops"
        if throttle.value == 0:
            return "without an RC receiver it never stops"
        return f"by its settings it drives on for {override.value:g} s"

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
        """Return the read requests that are due: one for each parameter, repeated a few times, then less often."""
        if now >= self._round_due and self._unread():
            self._round_due = now + TRIES * REPEAT_AFTER + RETRY_PERIOD
            self._given_up_at = min(self._given_up_at, now + TRIES * REPEAT_AFTER)
            for name in self._unread():
                self._request(name, now)
        if now >= self._given_up_at:
            self._missing = self._unread()
        self._params.tick(now)
        return self._params.messages_to_send()

    def _unread(self) -> tuple[str, ...]:
        """Return the parameters that are not known by their present or former name."""
        names = (name for name in PARAM_CHECKS if name not in FORMER_NAMES.values())
        return tuple(name for name in names if not {name, FORMER_NAMES.get(name)} & self._found.keys())

    def _request(self, name: str, now: float) -> None:
        self._params.read(name, now)
        if name in FORMER_NAMES:
            self._params.read(FORMER_NAMES[name], now)

    def _missing_warning(self) -> list[str]:
        return [f"could not read {', '.join(self._missing)}: trying again"] if self._missing else []

    def _check(self, name: str) -> list[str]:
        param = self._params.params.get(name)
        if param is None:
            return []
        before, warning = self._found.get(name), PARAM_CHECKS[name](param.value, self._system)
        self._found[name] = warning
        self._missing = tuple(each for each in self._missing if each in self._unread())
        return [warning] if warning is not None and warning != before else []
