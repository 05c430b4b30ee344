"""What time does to the vehicle's safety: a late loop, failsafes, nobody who drives; and what may move at a moment.

The verbs that it uses are vehicle/safety/state_machine.py's; what follows from which condition is vehicle/safety/failsafe.py, RULES;
vehicle/drive/drive.py turns a Clearance into motor values.
"""

from __future__ import annotations

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
"""s between two cycles of 20 ms from which on the motors get zero for a cycle (vehicle.md, control loop late)."""
BAD_CYCLES_MAX = 3
"""Cycles in a row with values that are not numbers, and the mode becomes HOLD."""


class SafetyMonitor:
    """`update` once a cycle; the rest at any moment."""

    def __init__(self, params: Params, safety: Safety, control: Control, texts: StatusTextQueue, now: float) -> None:
        self._params = params
        self._safety = safety
        self._control = control
        self._texts = texts
        self._cycle = self._asked_at = now

    def is_late(self, now: float) -> bool:
        """The control loop has not run for too long. A much too late one disarms."""
        gap = now - self._cycle
        if self._safety.armed and gap > self._params["FS_LOOP_TIMEOUT"]:
            self._safety.handle_loop_overrun(gap, now)
        return gap > LATE_CYCLE_TIME

    def update(self, now: float, refused: int, motion: MotionInputs, *, driving: bool) -> None:
        """One cycle: find what fails, do what follows.

        `refused`: cycles in a row with values that are not numbers; `driving`: it moves by itself.
        """
        safety = self._safety
        self._cycle = now
        safety.boot_done()
        self._control.expire_stale_demand(now)
        self._update_failsafes(motion, now)
        if refused >= BAD_CYCLES_MAX and safety.armed and safety.mode is not Mode.HOLD:
            self._texts.send(Severity.CRITICAL, "Motor values are not numbers: HOLD", now)
            safety.hold()
        if driving:
            self._asked_at = now
        self._disarm_idle(now)
        if not safety.armed:
            safety.free_lost_owner(now)

    def build_clearance(
        self, now: float, own: Demand | None, *, late: bool, trial: MotorTest | None = None
    ) -> Clearance:
        """The facts about motion at this moment. `own` is what self-driving wants, `trial` the motor test under way."""
        safety = self._safety
        offer = MODES[safety.mode]
        if offer.autonomous:
            cleared, age, timeout = safety.autonomy_confirmed, None if own is None else now - own.time, LATE_CYCLE_TIME
        else:
            cleared, age, timeout = (
                self._control.neutral_seen,
                self._control.demand_age(now),
                self._params["MAN_TIMEOUT"],
            )
        return Clearance(
            armed=safety.armed,
            late=late,
            held=safety.failsafes.lasting_action(now) >= FailsafeAction.NEUTRAL or not offer.moves,
            neutral_seen=cleared,
            demand_age=age,
            timeout=timeout,
            motor_test=trial,
        )

    def _update_failsafes(self, motion: MotionInputs, now: float) -> None:
        armed, failsafes = self._safety.armed, self._safety.failsafes
        before = failsafes.active
        taken = failsafes.check(self._failsafe_inputs(motion), now, armed=armed)
        if before and armed:
            for cause in before & ~failsafes.active:
                self._texts.send(Severity.NOTICE, f"Failsafe over: {RULES[cause].label}", now)
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
        words = RULES[step.cause].label
        self._texts.send(severity, f"Failsafe: {words}: {step.action.label}", now)
        if step.action is FailsafeAction.NEUTRAL:
            self._control.require_neutral()
        elif step.action is FailsafeAction.HOLD or (
            step.action is FailsafeAction.RTL and safety.choose_mode(Mode.RTL, now)
        ):
            safety.hold()
        elif step.action is FailsafeAction.DISARM:
            safety.disarm(words, now)

    def _disarm_idle(self, now: float) -> None:
        delay = self._params["DISARM_DELAY"]
        demand = self._control.demand
        if demand and self._control.requests_motion():
            self._asked_at = demand.time
        if delay and now - max(self._safety.armed_at, self._asked_at) > delay:
            self._safety.disarm(f"no demand for {delay:g} s", now)
