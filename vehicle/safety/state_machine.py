"""May it move? State, mode, arming and emergency stop: the verbs behind the commands. What time does is monitor.py's.

It knows no messages: vehicle/commands/arming.py translates them into these verbs.
"""

from __future__ import annotations

from collections.abc import Callable

from dialects.enums import Failsafe, Severity
from dialects.modes import Mode
from vehicle.drive.control import Control
from vehicle.modes import OFFERED, first_mode
from vehicle.params import Params
from vehicle.safety.arming import Facts, problems
from vehicle.safety.battery import BatteryWatch
from vehicle.safety.failsafe import RULES, Failsafes
from vehicle.safety.pi_monitor import ComputerWatch
from vehicle.safety.states import TRANSITIONS, Event, State
from vehicle.statustext import Texts


class Safety:
    """The one place that arms, disarms and changes the mode."""

    def __init__(
        self,
        params: Params,
        control: Control,
        texts: Texts,
        now: float,
        unready: Callable[[Mode], str | None] = lambda mode: None,
        unfenced: Callable[[], str | None] = lambda: None,
    ) -> None:
        """`unready` says why a mode cannot work now, or None; `unfenced`, why a fence that counts would stop nobody."""
        self.state = State.BOOT
        self.mode = self.intended = first_mode(params["INITIAL_MODE"])
        self.terminated = False
        """Emergency stop that only a restart ends (DO_FLIGHTTERMINATION)."""
        self.pressed: str | None = None
        """Why the emergency stop's own input stops the vehicle, while it does."""
        self.fault: str | None = None
        self.overrun = False
        """A late cycle has disarmed; until the next arming."""
        self.epoch = 0
        """Counts choices of a mode, arming, and everything that ends a drive: self-driving begins anew with each."""
        self.cleared = False
        """Self-driving was asked for since the vehicle was armed: as neutral first for a stick, nothing goes on by
        itself what went on before."""
        self.failsafes = Failsafes(params)
        self.battery = BatteryWatch(params)
        self.computer = ComputerWatch(params, texts)
        self._params = params
        self._control = control
        self._texts = texts
        self._unready = unready
        self._unfenced = unfenced
        self.armed_at = now
        """When it was armed last."""

    @property
    def armed(self) -> bool:
        """Motors may turn."""
        return self.state is State.ARMED

    @property
    def latched(self) -> Failsafe:
        """What stays until somebody does something."""
        latched = self.failsafes.latched
        if self.state is State.ESTOP:
            latched |= Failsafe.ESTOP
        if self.fault is not None:
            latched |= Failsafe.MOTOR_DRIVER
        if self.overrun:
            latched |= Failsafe.LOOP_OVERRUN
        return latched

    def problems(self, now: float, *, force: bool = False) -> list[str]:
        """What forbids to arm; empty where nothing does."""
        facts = Facts(
            params=self._params,
            state=self.state,
            terminated=self.terminated,
            pressed=self.pressed,
            fault=self.fault,
            battery_low=self.battery.low_since(now) is not None,
            battery_critical=self.battery.critical_since(now) is not None,
            battery_silent=self.battery.silent(now),
            computer=self.computer.trouble(),
            mode=self._unready(self.mode),
            fence=self._unfenced(),
            sticks_moving=self._control.moving() and not self._control.stale(now),
        )
        return problems(facts, force=force)

    def arm(self, system: int, now: float, *, force: bool = False) -> list[str]:
        """Arm for `system`, which takes control. Returns what forbids it, and has said so."""
        if self.armed and self._control.owner == system:
            return []
        refusals = self._arm_refusals(system, now, force=force)
        for problem in refusals:
            self._texts.say(Severity.WARNING, f"PreArm: {problem}", now)
        if refusals:
            return refusals
        self._control.take(system, now)
        self._control.reset()
        self._happen(Event.ARM)
        self._renew(cleared=False)
        self.armed_at = now
        self.overrun = False
        self.failsafes.acknowledge()
        self._texts.say(Severity.NOTICE, f"Armed by GCS {system}, mode {self.mode.name}", now)
        if OFFERED[self.mode].own and self.mode is not Mode.GUIDED:
            self._texts.say(Severity.NOTICE, f"Stands until {self.mode.name} is chosen again", now)
        return []

    def disarm(self, why: str, now: float) -> None:
        """Motors to zero at once."""
        if not self.armed:
            return
        self._happen(Event.DISARM)
        self._texts.say(Severity.NOTICE, f"Disarmed: {why}", now)
        self.free_lost_owner(now)

    def interrupt(self) -> None:
        """Nothing goes on that was asked for while disarmed: a motor test is over."""
        if not self.armed:
            self._renew(cleared=False)

    def emergency_stop(self, who: str, now: float, *, terminate: bool = False) -> None:
        """Motors to zero at once, until somebody releases it. `terminate`: until a restart."""
        self.terminated |= terminate
        if self.state is not State.ESTOP:
            self._happen(Event.STOP)
            self._texts.say(Severity.EMERGENCY, f"EMERGENCY STOP by {who}", now)

    def stop_input(self, reason: str | None, now: float) -> None:
        """Why the emergency stop's own input stops the vehicle, or None while it is closed."""
        self.pressed = reason
        if reason is not None:
            self.emergency_stop(f"button: {reason}", now)

    def release(self, now: float) -> str | None:
        """End the emergency stop; stays disarmed. Returns why not."""
        if self.terminated:
            return "terminated, restart the vehicle"
        if self.pressed is not None:
            return self.pressed
        if self.state is State.ESTOP:
            self._happen(Event.RELEASE)
            self._texts.say(Severity.NOTICE, "Emergency stop released, disarmed", now)
            if self.fault:
                self._happen(Event.FAIL)
        return None

    def choose_mode(self, mode: Mode, now: float) -> str | None:
        """The driver's choice of a mode. Returns why not."""
        blocking = self.failsafes.blocks_modes()
        if blocking and OFFERED[mode].moves:
            return " and ".join(RULES[cause].words for cause in Failsafe if cause & blocking)
        unready = self._unready(mode)
        if unready:
            return unready
        self.intended = mode
        self._renew(cleared=self.armed)
        if OFFERED[mode].moves:  # HOLD is everybody's to choose: it must not end a countdown to disarming
            self.failsafes.acknowledge()
        if mode is not self.mode:
            self.mode = mode
            self._control.reset() if OFFERED[mode].moves else self._control.close()
            self._texts.say(Severity.INFO, f"Mode {mode.name}", now)
        return None

    def begin(self) -> None:
        """Self-driving was asked for, in the mode that is: by a setpoint or a mission's start."""
        self.cleared = self.armed

    def end(self, why: str, now: float) -> None:
        """Self-driving has nothing more to do."""
        self._texts.say(Severity.NOTICE, f"{self.mode.name}: {why}: HOLD", now)
        self.hold()

    def hold(self) -> None:
        """Neutral, and the mode becomes HOLD: the driver has to choose another."""
        self.mode = Mode.HOLD
        self._renew(cleared=False)
        self._control.close()

    def motor_failed(self, reason: str, now: float) -> None:
        """The motor driver does not do what it should."""
        if self.fault is None:
            self._texts.say(Severity.CRITICAL, f"Motor driver failed: {reason}", now)
        self.fault = reason
        self._happen(Event.FAIL)

    def motor_repaired(self, now: float) -> None:
        """The motor driver works again."""
        if self.fault is not None:
            self._texts.say(Severity.NOTICE, "Motor driver works again", now)
        self.fault = None
        self._happen(Event.REPAIR)

    def overran(self, gap: float, now: float) -> None:
        """The control loop stood still for `gap` s while armed."""
        self.overrun = True
        self.disarm(f"control loop was {gap:.2f} s late", now)

    def free_lost_owner(self, now: float) -> None:
        """A ground station that is silent keeps no disarmed vehicle."""
        if self._control.owner and self._control.lost(now):
            self._control.release("is silent", now)

    def wake(self) -> None:
        """The first cycle ends BOOT."""
        if self.state is State.BOOT:
            self._happen(Event.READY)

    def shutdown(self) -> None:
        """The end."""
        self._happen(Event.SHUTDOWN)

    def _arm_refusals(self, system: int, now: float, *, force: bool) -> list[str]:
        if self.armed:  # who wants to drive an armed vehicle asks for control, and does not slip in by arming
            return [f"armed already by GCS {self._control.owner}"]
        refusal = self._control.refusal(system, now)
        return [refusal] if refusal else self.problems(now, force=force)

    def _renew(self, *, cleared: bool) -> None:
        self.epoch += 1
        self.cleared = cleared

    def _happen(self, event: Event) -> None:
        self.state = TRANSITIONS[self.state, event]
        if not self.armed:
            self._control.close()
            self._renew(cleared=False)
