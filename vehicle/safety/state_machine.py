"""May it move? State, mode, arming and emergency stop: the verbs behind the commands. What time does is monitor.py's.

It knows no messages: vehicle/commands/arming.py translates them into these verbs.
"""

from __future__ import annotations

from typing import Protocol

from dialects.enums import Failsafe, Severity
from dialects.modes import Mode
from vehicle.drive.control import Control
from vehicle.modes import MODES, initial_mode
from vehicle.params import Params
from vehicle.safety.arming import ArmingFacts, find_problems
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.failsafe import RULES, Failsafes
from vehicle.safety.pi_monitor import PiMonitor
from vehicle.safety.states import TRANSITIONS, SafetyEvent, SafetyState
from vehicle.statustext import StatusTextQueue


class Readiness(Protocol):
    """Why self-driving cannot work now; vehicle.autonomy.navigator.Navigator is one."""

    def unready_reason(self, mode: Mode) -> str | None:
        """Return why a mode cannot be chosen now, or None."""

    @property
    def fence_unenforceable_reason(self) -> str | None:
        """Why an enabled fence would stop nothing, or None."""


class Safety:
    """The one place that arms, disarms and changes the mode."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: StatusTextQueue,
        now: float,
        readiness: Readiness,
    ) -> None:
        self.state = SafetyState.BOOT
        self.mode = self.intended = initial_mode(params["INITIAL_MODE"])
        self.terminated = False
        """Emergency stop that only a restart ends (DO_FLIGHTTERMINATION)."""
        self.estop_reason: str | None = None
        """Why the emergency stop's own input stops the vehicle, while it does."""
        self.motor_fault: str | None = None
        self.loop_overrun = False
        """A late cycle has disarmed; until the next arming."""
        self.mode_generation = 0
        """Counts choices of a mode, arming, and everything that ends a drive: self-driving begins anew with each."""
        self.autonomy_confirmed = False
        """Self-driving was asked for since the vehicle was armed: as neutral first for a stick, nothing goes on by
        itself what went on before."""
        self.failsafes = Failsafes(params)
        self.battery = BatteryMonitor(params)
        self.computer = PiMonitor(params, texts)
        self._params = params
        self._control = control
        self._texts = texts
        self._readiness = readiness
        self.armed_at = now
        """When it was armed last."""

    @property
    def armed(self) -> bool:
        """Motors may turn."""
        return self.state is SafetyState.ARMED

    @property
    def latched(self) -> Failsafe:
        """What stays until somebody does something."""
        latched = self.failsafes.latched
        if self.state is SafetyState.ESTOP:
            latched |= Failsafe.ESTOP
        if self.motor_fault is not None:
            latched |= Failsafe.MOTOR_DRIVER
        if self.loop_overrun:
            latched |= Failsafe.LOOP_OVERRUN
        return latched

    def prearm_problems(self, now: float, *, force: bool = False) -> list[str]:
        """What forbids to arm; empty where nothing does."""
        facts = ArmingFacts(
            params=self._params,
            state=self.state,
            terminated=self.terminated,
            estop_reason=self.estop_reason,
            fault=self.motor_fault,
            battery_low=self.battery.low_since(now) is not None,
            battery_critical=self.battery.critical_since(now) is not None,
            battery_silent=self.battery.is_silent(now),
            computer=self.computer.problem(),
            mode=self._readiness.unready_reason(self.mode),
            fence=self._readiness.fence_unenforceable_reason,
            sticks_moving=self._control.requests_motion() and not self._control.is_demand_stale(now),
        )
        return find_problems(facts, force=force)

    def arm(self, system: int, now: float, *, force: bool = False) -> list[str]:
        """Arm for `system`, which takes control. Returns what forbids it, and has said so."""
        if self.armed and self._control.owner == system:
            return []
        refusals = self._arm_refusals(system, now, force=force)
        for problem in refusals:
            self._texts.send(Severity.WARNING, f"PreArm: {problem}", now)
        if refusals:
            return refusals
        self._control.set_owner(system, now)
        self._control.reset()
        self._handle_event(SafetyEvent.ARM)
        self._start_generation(cleared=False)
        self.armed_at = now
        self.loop_overrun = False
        self.failsafes.acknowledge()
        self._texts.send(Severity.NOTICE, f"Armed by GCS {system}, mode {self.mode.name}", now)
        if MODES[self.mode].autonomous and self.mode is not Mode.GUIDED:
            self._texts.send(Severity.NOTICE, f"Stands until {self.mode.name} is chosen again", now)
        return []

    def disarm(self, why: str, now: float) -> None:
        """Motors to zero at once."""
        if not self.armed:
            return
        self._handle_event(SafetyEvent.DISARM)
        self._texts.send(Severity.NOTICE, f"Disarmed: {why}", now)
        self.free_lost_owner(now)

    def end_motor_test(self) -> None:
        """Nothing goes on that was asked for while disarmed: a motor test is over."""
        if not self.armed:
            self._start_generation(cleared=False)

    def emergency_stop(self, who: str, now: float, *, terminate: bool = False) -> None:
        """Motors to zero at once, until somebody releases it. `terminate`: until a restart."""
        self.terminated |= terminate
        if self.state is not SafetyState.ESTOP:
            self._handle_event(SafetyEvent.STOP)
            self._texts.send(Severity.EMERGENCY, f"EMERGENCY STOP by {who}", now)

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """Why the emergency stop's own input stops the vehicle, or None while it is closed."""
        self.estop_reason = reason
        if reason is not None:
            self.emergency_stop(f"button: {reason}", now)

    def release_estop(self, now: float) -> str | None:
        """End the emergency stop; stays disarmed. Returns why not."""
        if self.terminated:
            return "terminated, restart the vehicle"
        if self.estop_reason is not None:
            return self.estop_reason
        if self.state is SafetyState.ESTOP:
            self._handle_event(SafetyEvent.RELEASE)
            self._texts.send(Severity.NOTICE, "Emergency stop released, disarmed", now)
            if self.motor_fault:
                self._handle_event(SafetyEvent.FAIL)
        return None

    def choose_mode(self, mode: Mode, now: float) -> str | None:
        """The driver's choice of a mode. Returns why not."""
        blocking = self.failsafes.mode_blocking_conditions()
        if blocking and MODES[mode].moves:
            return " and ".join(RULES[cause].label for cause in Failsafe if cause & blocking)
        unready = self._readiness.unready_reason(mode)
        if unready:
            return unready
        self.intended = mode
        self._start_generation(cleared=self.armed)
        if MODES[mode].moves:  # HOLD is everybody's to choose: it must not end a countdown to disarming
            self.failsafes.acknowledge()
        if mode is not self.mode:
            self.mode = mode
            self._control.reset() if MODES[mode].moves else self._control.require_neutral()
            self._texts.send(Severity.INFO, f"Mode {mode.name}", now)
        return None

    def confirm_autonomy(self) -> None:
        """Self-driving was asked for, in the mode that is: by a setpoint or a mission's start."""
        self.autonomy_confirmed = self.armed

    def finish_autonomy(self, why: str, now: float) -> None:
        """Self-driving has nothing more to do."""
        self._texts.send(Severity.NOTICE, f"{self.mode.name}: {why}: HOLD", now)
        self.hold()

    def hold(self) -> None:
        """Neutral, and the mode becomes HOLD: the driver has to choose another."""
        self.mode = Mode.HOLD
        self._start_generation(cleared=False)
        self._control.require_neutral()

    def motor_failed(self, reason: str, now: float) -> None:
        """The motor driver does not do what it should."""
        if self.motor_fault is None:
            self._texts.send(Severity.CRITICAL, f"Motor driver failed: {reason}", now)
        self.motor_fault = reason
        self._handle_event(SafetyEvent.FAIL)

    def motor_repaired(self, now: float) -> None:
        """The motor driver works again."""
        if self.motor_fault is not None:
            self._texts.send(Severity.NOTICE, "Motor driver works again", now)
        self.motor_fault = None
        self._handle_event(SafetyEvent.REPAIR)

    def handle_loop_overrun(self, gap: float, now: float) -> None:
        """The control loop stood still for `gap` s while armed."""
        self.loop_overrun = True
        self.disarm(f"control loop was {gap:.2f} s late", now)

    def free_lost_owner(self, now: float) -> None:
        """A ground station that is silent keeps no disarmed vehicle."""
        if self._control.owner and self._control.is_owner_lost(now):
            self._control.release("is silent", now)

    def boot_done(self) -> None:
        """The first cycle ends BOOT."""
        if self.state is SafetyState.BOOT:
            self._handle_event(SafetyEvent.READY)

    def shutdown(self) -> None:
        """The end."""
        self._handle_event(SafetyEvent.SHUTDOWN)

    def _arm_refusals(self, system: int, now: float, *, force: bool) -> list[str]:
        if self.armed:  # who wants to drive an armed vehicle asks for control, and does not slip in by arming
            return [f"armed already by GCS {self._control.owner}"]
        refusal = self._control.takeover_denial_reason(system, now)
        return [refusal] if refusal else self.prearm_problems(now, force=force)

    def _start_generation(self, *, cleared: bool) -> None:
        self.mode_generation += 1
        self.autonomy_confirmed = cleared

    def _handle_event(self, event: SafetyEvent) -> None:
        self.state = TRANSITIONS[self.state, event]
        if not self.armed:
            self._control.require_neutral()
            self._start_generation(cleared=False)
