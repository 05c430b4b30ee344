"""Arming, mode and emergency-stop state machine. Timeouts are handled in vehicle/safety/monitor.py.

The methods know no messages: vehicle/commands/arming.py translates commands into calls.
"""

from __future__ import annotations

from typing import Protocol

from dialects.enums import Failsafe, Severity
from dialects.modes import Mode
from vehicle.drive.control import Control
from vehicle.drive.conversation import Conversation
from vehicle.modes import MODES, initial_mode
from vehicle.params import Params
from vehicle.safety.arming import ArmingFacts, find_problems
from vehicle.safety.battery import BatteryMonitor
from vehicle.safety.failsafe import RULES
from vehicle.safety.failsafe_state import Failsafes
from vehicle.safety.param_report import list_changed_safety_params
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
    """Arms, disarms and changes the mode; nothing else does."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: StatusTextQueue,
        now: float,
        readiness: Readiness,
    ) -> None:
        """Start in BOOT and in the mode INITIAL_MODE. `readiness` knows whether autonomous modes can work."""
        self.state = SafetyState.BOOT
        self.mode = self.intended = initial_mode(params["INITIAL_MODE"])
        self.terminated = False
        """The emergency stop lasts until a restart (DO_FLIGHTTERMINATION)."""
        self.estop_reason: str | None = None
        """Why the emergency stop button stops the vehicle; None while its contact is closed."""
        self.motor_fault: str | None = None
        self.loop_overrun = False
        """A late cycle has disarmed the vehicle; cleared by the next arming."""
        self.mode_generation = 0
        """Counts mode choices, armings and everything that ends motion: the autonomous mode begins anew with each."""
        self.autonomy_confirmed = False
        """An autonomous mode, a start or a setpoint was requested since arming. As with neutral first for a stick,
        nothing resumes by itself after arming."""
        self.failsafes = Failsafes(params)
        self.battery = BatteryMonitor(params)
        self.computer = PiMonitor(params, texts)
        self._params = params
        self._control = control
        self._ownership = control.ownership
        self._texts = texts
        self._readiness = readiness
        self.armed_at = now
        """Time of the last arming."""

    @property
    def armed(self) -> bool:
        """True if motors may turn."""
        return self.state is SafetyState.ARMED

    @property
    def latched(self) -> Failsafe:
        """The conditions that last until a command clears them."""
        latched = self.failsafes.latched
        if self.state is SafetyState.ESTOP:
            latched |= Failsafe.ESTOP
        if self.motor_fault is not None:
            latched |= Failsafe.MOTOR_DRIVER
        if self.loop_overrun:
            latched |= Failsafe.LOOP_OVERRUN
        return latched

    def prearm_problems(self, now: float, *, force: bool = False) -> list[str]:
        """Return what prevents arming; empty if nothing does."""
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

    def arm(self, asker: Conversation, now: float, *, force: bool = False) -> list[str]:
        """Arm and give control to `asker`. Return what prevents arming, for the reply; empty if armed."""
        if self.armed and self._ownership.is_driver(asker, now):
            return []
        refusals = self._arm_refusals(asker, now, force=force)
        if refusals:
            return refusals
        self._control.take(asker, now)
        self._control.reset()
        self._handle_event(SafetyEvent.ARM)
        self._start_generation(confirmed=False)
        self.armed_at = now
        self.loop_overrun = False
        self.failsafes.acknowledge()
        self._texts.send_event(Severity.NOTICE, f"Armed by GCS {asker.system}, mode {self.mode.name}", now)
        if MODES[self.mode].autonomous and self.mode is not Mode.GUIDED:
            self._texts.send_event(Severity.NOTICE, f"Choose {self.mode.name} again to start", now)
        self._texts.send_list(Severity.WARNING, list_changed_safety_params(self._params), now)
        return []

    def disarm(self, why: str, now: float) -> None:
        """Disarm; the motors get zero at once."""
        if not self.armed:
            return
        self._handle_event(SafetyEvent.DISARM)
        self._texts.send_event(Severity.NOTICE, f"Disarmed: {why}", now)
        self.free_lost_owner(now)

    def end_motor_test(self) -> None:
        """End a motor test: no autonomous motion requested while disarmed may start."""
        if not self.armed:
            self._start_generation(confirmed=False)

    def emergency_stop(self, who: str, now: float, *, terminate: bool = False) -> None:
        """Stop the motors at once, until the stop is released, or with `terminate` until a restart."""
        self.terminated |= terminate
        if self.state is not SafetyState.ESTOP:
            self._handle_event(SafetyEvent.STOP)
            self._texts.send_event(Severity.EMERGENCY, f"EMERGENCY STOP by {who}", now)

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """Set why the emergency stop button stops the vehicle; None while its contact is closed."""
        self.estop_reason = reason
        if reason is not None:
            self.emergency_stop(f"button: {reason}", now)

    def release_estop(self, now: float) -> str | None:
        """Release the emergency stop; the vehicle stays disarmed. Return why that is refused, or None."""
        if self.terminated:
            return "terminated, restart the vehicle"
        if self.estop_reason is not None:
            return self.estop_reason
        if self.state is SafetyState.ESTOP:
            self._handle_event(SafetyEvent.RELEASE)
            self._texts.send_event(Severity.NOTICE, "Emergency stop released, disarmed", now)
            if self.motor_fault:
                self._handle_event(SafetyEvent.FAIL)
        return None

    def choose_mode(self, mode: Mode, now: float) -> str | None:
        """Change to the mode that the operator chose. Return why that is refused, or None."""
        blocking = self.failsafes.mode_blocking_conditions()
        if blocking and MODES[mode].moves:
            return " and ".join(RULES[cause].label for cause in Failsafe if cause & blocking)
        if self.armed and MODES[mode].autonomous and self._ownership.driver is None:
            return "no GCS is in control"  # nobody's silence would stop it
        unready = self._readiness.unready_reason(mode)
        if unready:
            return unready
        self.intended = mode
        self._start_generation(confirmed=self.armed)
        if MODES[mode].moves:  # any station may choose HOLD: it must not end the countdown to disarming
            self.failsafes.acknowledge()
        if mode is not self.mode:
            self.mode = mode
            if MODES[mode].moves:
                self._control.reset()
            else:
                self._control.require_neutral()
            self._texts.send_event(Severity.INFO, f"Mode {mode.name}", now)
        return None

    def confirm_autonomy(self) -> None:
        """Let the autonomous mode drive: a setpoint or the start of the mission was requested in it."""
        self.autonomy_confirmed = self.armed

    def finish_autonomy(self, why: str, now: float) -> None:
        """Report that the autonomous mode has finished, and change to HOLD."""
        self._texts.send_event(Severity.NOTICE, f"{self.mode.name}: {why}: HOLD", now)
        self.hold()

    def hold(self) -> None:
        """Ramp down to neutral and change to HOLD: the operator has to choose another mode to continue."""
        self.mode = Mode.HOLD
        self._start_generation(confirmed=False)
        self._control.require_neutral()

    def motor_failed(self, reason: str, now: float) -> None:
        """Handle a failure of the motor driver: zero, disarmed, and no arming until `motor_repaired`."""
        if self.motor_fault is None:
            self._texts.send_event(Severity.CRITICAL, f"Motor driver failed: {reason}", now)
        self.motor_fault = reason
        self._handle_event(SafetyEvent.FAIL)

    def motor_repaired(self, now: float) -> None:
        """Handle that the motor driver has recovered."""
        if self.motor_fault is not None:
            self._texts.send_event(Severity.NOTICE, "Motor driver recovered", now)
        self.motor_fault = None
        self._handle_event(SafetyEvent.REPAIR)

    def handle_loop_overrun(self, gap: float, now: float) -> None:
        """Disarm because the control loop was late by `gap` s."""
        self.loop_overrun = True
        self.disarm(f"control loop was {gap:.2f} s late", now)

    def free_lost_owner(self, now: float) -> None:
        """Release control if the ground station in control has timed out (FS_GCS_TIMEOUT)."""
        if self._ownership.driver and self._ownership.is_lost(now):
            self._control.release("timed out", now)

    def boot_done(self) -> None:
        """End BOOT; called in each cycle, effective in the first."""
        if self.state is SafetyState.BOOT:
            self._handle_event(SafetyEvent.READY)

    def shutdown(self) -> None:
        """Enter OFF, for good."""
        self._handle_event(SafetyEvent.SHUTDOWN)

    def _arm_refusals(self, asker: Conversation, now: float, *, force: bool) -> list[str]:
        if self.armed:  # control of an armed vehicle is taken by a request, not by arming again
            return [f"armed already by GCS {self._ownership.owner}"]
        refusal = self._ownership.takeover_denial_reason(asker, now)
        return [refusal] if refusal else self.prearm_problems(now, force=force)

    def _start_generation(self, *, confirmed: bool) -> None:
        self.mode_generation += 1
        self.autonomy_confirmed = confirmed

    def _handle_event(self, event: SafetyEvent) -> None:
        self.state = TRANSITIONS[self.state, event]
        if not self.armed:
            self._control.require_neutral()
            self._start_generation(confirmed=False)
