"""Periodic safety checks: late control loop, failsafes, automatic disarming, motor clearance.

Commands change the state in vehicle/safety/state_machine.py; the failsafes and their actions are in
vehicle/safety/failsafe.py; vehicle/drive/drive.py turns a Clearance into motor values.
"""

from __future__ import annotations

import math

from dialects.enums import Severity
from dialects.modes import Mode
from vehicle.drive.control import Control
from vehicle.drive.demand import Demand
from vehicle.drive.gate import Clearance, MotorTest
from vehicle.modes import MODES
from vehicle.params import Params
from vehicle.safety.failsafe import RULES, FailsafeAction
from vehicle.safety.failsafe_inputs import FailsafeInputs, MotionInputs
from vehicle.safety.failsafe_state import TriggeredStep
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue

LATE_CYCLE_TIME = 0.1
"""s between two cycles of 20 ms from which on the outputs are zero for a cycle (docs/safety.md, control loop late)."""
_NEUTRAL = FailsafeAction.NEUTRAL
BAD_CYCLES_MAX = 3
"""Cycles in a row with values that are not numbers before the mode becomes HOLD."""


class SafetyMonitor:
    """Runs the periodic checks. Call `update` once a cycle, the other methods at any time."""

    def __init__(self, params: Params, safety: Safety, control: Control, texts: StatusTextQueue, now: float) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._texts = texts
        self._last_cycle = self._last_activity = now
        self._quiet_until = -math.inf
        """Until when `update` finds nothing in a rover whose demand is fresh, without another reading of a sensor."""

    def is_late(self, now: float) -> bool:
        """Return True if the last cycle is older than LATE_CYCLE_TIME; disarm if older than FS_LOOP_TIMEOUT."""
        gap = now - self._last_cycle
        if self._safety.armed and gap > self._params["FS_LOOP_TIMEOUT"]:
            self._safety.handle_loop_overrun(gap, now)
        return gap > LATE_CYCLE_TIME

    def skip_cycle(self, now: float) -> None:
        """Note a cycle that came in time and needed no `update`."""
        self._last_cycle = now

    def has_deadline(self, now: float) -> bool:
        """Return whether the time of a failsafe runs, or one that needs no sensor is due; not that of a stale demand.

        Messages only put these times off, but for the operator's input, which is asked for here.
        """
        control = self._control
        return now >= self._quiet_until or (
            control.presence.is_lost(self._params["OPR_TIMEOUT"], now) and control.requests_motion()
        )

    def update(self, now: float, refused: int, motion: MotionInputs, *, driving: bool) -> None:
        """Evaluate the failsafes of this cycle and take their actions.

        `refused`: cycles in a row with values that are not numbers. `driving`: an autonomous mode moves the rover.
        """
        safety = self._safety
        self._last_cycle = now
        safety.boot_done()
        self._control.expire_stale_demand(now)
        if self._control.pop_succession() and MODES[safety.mode].autonomous:
            safety.hold()  # an autonomous mode never outlives a change of the driver that nobody granted
        self._update_failsafes(motion, now)
        if refused >= BAD_CYCLES_MAX and safety.armed and safety.mode is not Mode.HOLD:
            self._texts.send_event(Severity.CRITICAL, "Motor values are not numbers: HOLD", now)
            safety.hold()
        if driving:
            self._last_activity = now
        self._disarm_idle(now)
        self._quiet_until = self._find_deadline()
        if not safety.armed:
            safety.free_lost_owner(now)

    def build_clearance(
        self, now: float, own: Demand | None, *, late: bool, trial: MotorTest | None = None
    ) -> Clearance:
        """Return the facts that decide about motion now.

        `own` is the demand of the autonomous mode, `trial` the motor test in progress.
        """
        safety = self._safety
        spec = MODES[safety.mode]
        held = safety.failsafes.lasting_action(now) >= _NEUTRAL or not (spec.manual or spec.autonomous)
        if spec.autonomous:
            confirmed, timeout = safety.autonomy_confirmed, LATE_CYCLE_TIME
            age = None if own is None else now - own.time
        else:
            confirmed, timeout = self._control.neutral_seen, self._control.demand_timeout
            age = self._control.demand_age(now)
        return Clearance(safety.armed, late, held, confirmed, age, timeout, trial)

    def _update_failsafes(self, motion: MotionInputs, now: float) -> None:
        armed, failsafes = self._safety.armed, self._safety.failsafes
        before = failsafes.active
        taken = failsafes.check(self._failsafe_inputs(motion), now, armed=armed)
        if before and armed:
            for cause in before & ~failsafes.active:
                self._texts.send_event(Severity.NOTICE, f"Failsafe cleared: {RULES[cause].label}", now)
        for step in {each.cause: each for each in sorted(taken, key=lambda each: each.action)}.values():
            self._apply(step, now)

    def _failsafe_inputs(self, motion: MotionInputs) -> FailsafeInputs:
        safety = self._safety
        return FailsafeInputs(
            params=self._params,
            control=self._control,
            battery=safety.battery,
            computer=safety.computer,
            motion=motion,
            manual=MODES[safety.mode].manual,
            mission_running=safety.mode is Mode.AUTO,
            latched=safety.failsafes.latched,
            armed_at=safety.armed_at,
        )

    def _apply(self, step: TriggeredStep, now: float) -> None:
        safety = self._safety
        severity = Severity.CRITICAL if step.action >= FailsafeAction.HOLD else Severity.WARNING
        label = RULES[step.cause].label
        self._texts.send_event(severity, f"Failsafe: {label}: {step.action.label}", now)
        if step.action is FailsafeAction.NEUTRAL:
            self._control.require_neutral()
        elif step.action is FailsafeAction.HOLD or (
            step.action is FailsafeAction.RTL and safety.choose_mode(Mode.RTL, now)
        ):
            safety.hold()
        elif step.action is FailsafeAction.DISARM:
            safety.disarm(label, now)

    def _disarm_idle(self, now: float) -> None:
        demand = self._control.demand
        if demand and self._control.requests_motion():
            self._last_activity = demand.time
        if now > self._idle_until:
            self._safety.disarm(f"no demand for {self._params['DISARM_DELAY']:g} s", now)

    @property
    def _idle_until(self) -> float:
        """When the vehicle is disarmed without another demand for motion."""
        delay: float = self._params["DISARM_DELAY"]
        return max(self._safety.armed_at, self._last_activity) + delay if delay else math.inf

    def _find_deadline(self) -> float:
        """Return when the first failsafe that needs no sensor may be due; -infinite while the time of any runs."""
        if not self._safety.failsafes.quiet or self._safety.battery.counting:
            return -math.inf
        return min(self._idle_until, self._control.ownership.lost_at)
