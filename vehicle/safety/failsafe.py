"""Failsafe rules: a table of conditions and the actions that follow. The worst action wins.

To add a failsafe, write its condition function and its row in RULES, and a test. A condition that ground stations shall
see under a name of its own also needs a bit: ROVER_FAILSAFE in dialects/rover.xml and Failsafe in dialects/enums.py.
Only the action RTL starts a motion, and only if a parameter selects it.

A failed motor driver and the emergency stop act at once (vehicle/safety/state_machine.py); so does a late control loop
(vehicle/safety/monitor.py). vehicle/safety/failsafe_state.py keeps track of the steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from enum import IntEnum

import msgspec

from dialects.enums import Failsafe
from vehicle.params import Params
from vehicle.safety.failsafe_inputs import FailsafeInputs

CONTINUE_MISSION = 2
"""FS_GCS_ENABLE: AUTO continues after the ground station is lost."""
BLOCKED_THROTTLE_MIN = 0.2
"""Throttle above which a rover that is free to move ..."""
BLOCKED_SPEED_MAX = 0.05
"""... is faster than this, m/s (docs/safety.md, blocked)."""


class FailsafeAction(IntEnum):
    """What a failsafe does; the larger number wins."""

    WARN = 0
    """Report the condition."""
    LIMIT = 1
    """Limit the throttle to one half."""
    NEUTRAL = 2
    """Ramp down to neutral and stay there as long as the condition lasts."""
    RTL = 3
    """Start RTL, or HOLD if RTL is not possible."""
    HOLD = 4
    """Ramp down to neutral and change the mode to HOLD. The operator has to choose another mode to continue."""
    DISARM = 5

    @property
    def label(self) -> str:
        """Name of the action in a STATUSTEXT."""
        return ("warning", "half speed", "stopping", "RTL", "HOLD", "disarmed")[self]


class FailsafeStep(msgspec.Struct, frozen=True):
    """An action and the delay after which it is taken."""

    after: str | float
    """s from the start of the condition, or the parameter that holds them."""
    action: FailsafeAction
    only_if: str | None = None
    """Parameter that disables the step if it is 0 ..."""
    value: float | None = None
    """... or, if this is given, if it has another value."""

    def delay(self, params: Params) -> float:
        """Return the s from the start of the condition to the action; infinite if the step is disabled."""
        if self.only_if is not None and not self._is_enabled(params[self.only_if]):
            return math.inf
        return params[self.after] if isinstance(self.after, str) else self.after

    def _is_enabled(self, setting: float) -> bool:
        return bool(setting) if self.value is None else setting == self.value


class FailsafeRule(msgspec.Struct, frozen=True):
    """A condition and the steps that follow it."""

    label: str
    """Name of the condition in a STATUSTEXT and in docs/safety.md."""
    condition: Callable[[FailsafeInputs, float], float | None]
    """Returns the time since when the condition holds, None if it does not hold. Called in each cycle while armed."""
    steps: tuple[FailsafeStep, ...]
    help: str
    """How the condition is detected, as docs/safety.md has it."""
    blocks_modes: bool = False
    """While the condition holds, no mode with motion can be chosen."""
    timed_while_disarmed: bool = False
    """The time before arming counts: who arms a tilted rover gets no extra delay."""


# Conditions: operator and ground station


def _manual_control_lost(inputs: FailsafeInputs, now: float) -> float | None:
    control = inputs.control
    if control.demand is None or not control.is_demand_stale(now) or not _is_relevant(inputs, Failsafe.MANUAL_LOSS):
        return None
    lost = control.demand.time + control.demand_timeout
    # A lost neutral demand has no effect until HOLD is due: two lost frames of an idle operator raise no alarm.
    quiet = 0.0 if control.requests_motion() else inputs.params["FS_TIMEOUT"]
    return lost if now - lost >= quiet else None


def _gcs_lost(inputs: FailsafeInputs, now: float) -> float | None:
    enabled = inputs.params["FS_GCS_ENABLE"]
    continues = enabled == CONTINUE_MISSION and inputs.mission_running
    if not enabled or continues or not inputs.control.ownership.is_lost(now):
        return None
    return now - inputs.control.ownership.silence_duration(now) + inputs.params["FS_GCS_TIMEOUT"]


def _operator_inactive(inputs: FailsafeInputs, now: float) -> float | None:
    control = inputs.control
    inactive = (
        control.presence.is_lost(inputs.params["OPR_TIMEOUT"], now)
        and control.requests_motion()
        and not control.is_demand_stale(now)
    )
    return now if inactive and _is_relevant(inputs, Failsafe.OPERATOR) else None


def _is_relevant(inputs: FailsafeInputs, cause: Failsafe) -> bool:
    return inputs.manual or bool(inputs.latched & cause)


# Conditions: power and computer


def _battery_low(inputs: FailsafeInputs, now: float) -> float | None:
    return _since_arming(inputs, inputs.battery.low_since(now))


def _battery_critical(inputs: FailsafeInputs, now: float) -> float | None:
    return _since_arming(inputs, inputs.battery.critical_since(now))


def _computer_failing(inputs: FailsafeInputs, now: float) -> float | None:
    return _since_arming(inputs, inputs.computer.failing_since()) if inputs.params["FS_PI_ACT"] else None


def _since_arming(inputs: FailsafeInputs, began: float | None) -> float | None:
    """Return `began`, but not before arming: after arming by force the full delay applies."""
    return None if began is None else max(began, inputs.armed_at)


# Conditions: position, attitude and wheels


def _position_lost(inputs: FailsafeInputs, now: float) -> float | None:
    return now if inputs.motion.needs_position and not inputs.motion.estimate.good else None


def _fence_breached(inputs: FailsafeInputs, now: float) -> float | None:
    return now if inputs.motion.outside_fence else None


def _tilted(inputs: FailsafeInputs, now: float) -> float | None:
    largest = math.radians(inputs.params["CRASH_ANGLE"])
    readings = inputs.motion.readings
    tilted = largest > 0.0 and any(abs(angle or 0.0) > largest for angle in (readings.roll, readings.pitch))
    return now if tilted else None


def _blocked(inputs: FailsafeInputs, now: float) -> float | None:
    motion = inputs.motion
    if max(map(abs, motion.throttles)) < BLOCKED_THROTTLE_MIN:
        return None
    wheels = motion.readings.wheel_speeds
    if wheels:
        return now if max(map(abs, wheels)) < BLOCKED_SPEED_MAX else None
    stands = motion.estimate.speed is not None and motion.estimate.ground_speed < BLOCKED_SPEED_MAX
    return now if stands else None


def _setpoints_lost(inputs: FailsafeInputs, now: float) -> float | None:
    expires = inputs.motion.setpoint_expires
    return None if expires is None or now <= expires else expires


_LIMIT, _STOP = FailsafeStep(0, FailsafeAction.LIMIT), FailsafeStep(0, FailsafeAction.NEUTRAL)
_HOLD, _DISARM = FailsafeStep(0, FailsafeAction.HOLD), FailsafeStep("FS_DISARM_T", FailsafeAction.DISARM)
_DEMAND_LOST = (_STOP, FailsafeStep("FS_TIMEOUT", FailsafeAction.HOLD), _DISARM)

RULES: dict[Failsafe, FailsafeRule] = {
    Failsafe.MANUAL_LOSS: FailsafeRule(
        "manual control lost", _manual_control_lost, _DEMAND_LOST,
        help="no MANUAL_CONTROL from the ground station in control for MAN_TIMEOUT 0.45 s"),
    Failsafe.GCS_LOSS: FailsafeRule(
        "ground station lost", _gcs_lost, (_HOLD, FailsafeStep(60, FailsafeAction.DISARM)),
        help="no message at all from the ground station in control for FS_GCS_TIMEOUT 5 s"),
    Failsafe.OPERATOR: FailsafeRule(
        "no operator input", _operator_inactive, _DEMAND_LOST,
        help="demands continue, but no key or stick event for OPR_TIMEOUT 10 s"),
    Failsafe.BATTERY_LOW: FailsafeRule(
        "battery low", _battery_low,
        (_LIMIT, FailsafeStep(0, FailsafeAction.HOLD, only_if="FS_LOW_ACT")),
        help="below BATT_LOW_VOLT for BATT_LOW_TIMER 10 s"),
    Failsafe.BATTERY_CRITICAL: FailsafeRule(
        "battery critical", _battery_critical, (_HOLD, FailsafeStep(10, FailsafeAction.DISARM)), blocks_modes=True,
        help="below BATT_CRT_VOLT for 3 s"),
    Failsafe.OVERHEAT: FailsafeRule(
        "Pi under-voltage or too hot", _computer_failing,
        (_LIMIT, FailsafeStep("FS_PI_TIMER", FailsafeAction.HOLD, only_if="FS_PI_ACT", value=2)),
        help="the Pi reports under-voltage or is hotter than FS_PI_TEMP 85 C, now or in the last 5 s"),
    Failsafe.POSITION: FailsafeRule(
        "position lost", _position_lost, (_STOP, FailsafeStep(1, FailsafeAction.HOLD)), timed_while_disarmed=True,
        help="the mode depends on the position, and no fix for 3 s or an error above 5 m"),
    Failsafe.FENCE: FailsafeRule(
        "outside the fence", _fence_breached,
        (FailsafeStep(0, FailsafeAction.WARN),
         FailsafeStep(0, FailsafeAction.RTL, only_if="FENCE_ACTION", value=1),
         FailsafeStep(0, FailsafeAction.HOLD, only_if="FENCE_ACTION", value=2)), timed_while_disarmed=True,
        help="FENCE_ENABLE, and the estimated position is outside"),
    Failsafe.TILT: FailsafeRule(
        "tilted", _tilted, (FailsafeStep(0.5, FailsafeAction.DISARM),), timed_while_disarmed=True,
        help="roll or pitch above CRASH_ANGLE 45 degrees for 0.5 s"),
    Failsafe.BLOCKED: FailsafeRule(
        "blocked", _blocked,
        (FailsafeStep(2, FailsafeAction.HOLD, only_if="FS_CRASH_CHECK"),
         FailsafeStep(2, FailsafeAction.DISARM, only_if="FS_CRASH_CHECK", value=2)), timed_while_disarmed=True,
        help="throttle above 20 % and wheels slower than 0.05 m/s for 2 s"),
    Failsafe.GUIDED_LOSS: FailsafeRule(
        "setpoints lost", _setpoints_lost, (_STOP, FailsafeStep(4, FailsafeAction.HOLD)),
        help="no velocity setpoint in GUIDED for GUIDED_TIMEOUT 1 s"),
}  # fmt: skip
"""Condition -> what follows. HOLD is entered once, so that the operator can choose MANUAL again while the condition
lasts, unless the condition blocks modes."""
