"""Settings of an ArduPilot rover that would let it drive on without us: which to read, and what to say of them.

ArduPilot keeps the last demand for RC_OVERRIDE_TIME (3 s by default) and its ground station failsafe is off by default
(measured on ArduRover 4.7). The station only reads; what is right for this vehicle is its owner's decision.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from dialects.enums import Autopilot
from dialects.messages import Message, ParamRequestRead, ParamValue

REPEAT_AFTER = 1.0
"""s: a parameter takes 0.1 s over UDP and up to 1 s over 57600 baud; silence is ArduPilot's only way to say no."""

TRIES = 3

LONGEST_OVERRIDE = 1.0
"""s that a vehicle may go on with a demand that is not renewed before we warn."""

ParamCheck = Callable[[float, int], str | None]


def _override_time(value: float, system: int) -> str | None:
    if value < 0:
        return "RC_OVERRIDE_TIME -1: it never stops when the link is cut"
    if value > LONGEST_OVERRIDE:
        return f"RC_OVERRIDE_TIME {value:g}: it drives on for {value:g} s when the link is cut"
    return None


def _gcs_failsafe(value: float, system: int) -> str | None:
    return "FS_GCS_ENABLE 0: no failsafe when the ground station is lost" if value == 0 else None


def _throttle_failsafe(value: float, system: int) -> str | None:
    return "FS_THR_ENABLE 0: without a receiver it never stops when the link is cut" if value == 0 else None


def _station_system(value: float, system: int) -> str | None:
    wanted = int(value) & 0xFF  # it takes 300 and uses the low byte
    return None if wanted == system else f"it obeys ground station {wanted} only and we are {system}: use --system"


PARAM_CHECKS: dict[str, ParamCheck] = {
    "RC_OVERRIDE_TIME": _override_time,
    "FS_GCS_ENABLE": _gcs_failsafe,
    "FS_THR_ENABLE": _throttle_failsafe,
    "MAV_GCS_SYSID": _station_system,
    "SYSID_MYGCS": _station_system,
}
"""Parameter -> what to warn of. SYSID_MYGCS is the name of MAV_GCS_SYSID up to 4.6; the other one stays silent."""


class ArduPilotChecks:
    """Reads the settings of one vehicle, once, and keeps the warnings."""

    def __init__(self, system: int, target: tuple[int, int]) -> None:
        self._system = system
        self._target = target
        self._missing = dict.fromkeys(PARAM_CHECKS, 0)
        self._due = 0.0
        self._found: dict[str, str | None] = {}

    @classmethod
    def applies_to(cls, autopilot: int) -> bool:
        """Only ArduPilot has these settings."""
        return autopilot == Autopilot.ARDUPILOT

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line each."""
        return tuple(warning for warning in self._found.values() if warning)

    def handle_param(self, message: ParamValue) -> str | None:
        """Take a parameter; returns a new warning."""
        name = message.param_id
        if name not in PARAM_CHECKS or not math.isfinite(message.param_value):
            return None
        self._missing.pop(name, None)
        before, self._found[name] = self._found.get(name), PARAM_CHECKS[name](message.param_value, self._system)
        return self._found[name] if self._found[name] != before else None

    def tick(self, now: float) -> list[Message]:
        """Ask for what is missing, a few times."""
        if now < self._due or not self._missing:
            return []
        self._due = now + REPEAT_AFTER
        self._missing = {name: tries + 1 for name, tries in self._missing.items() if tries < TRIES}
        return [ParamRequestRead(*self._target, name.encode(), -1) for name in self._missing]
