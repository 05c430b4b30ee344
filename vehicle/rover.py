"""The rover as a core: messages, readings and time in; messages and motor outputs out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects import messages as m
from dialects.enums import Severity
from dialects.modes import Mode
from link.core import LinkReport, Outgoing, Received
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.actuator_test import ActuatorTest
from vehicle.commands.buttons import Buttons
from vehicle.commands.dispatch import COMPONENT, Dispatcher, Stores
from vehicle.commands.reboot import RebootRequest
from vehicle.drive.control import Control
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Outputs, Permit
from vehicle.modes import MODES
from vehicle.params import Params
from vehicle.readings import NO_READINGS, Readings
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.health_notices import HealthNotices, fence_notices, sensor_notices
from vehicle.safety.monitor import SafetyMonitor
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import SafetyState
from vehicle.statustext import StatusTextQueue
from vehicle.storage.logbook import LogRecorder
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry import build_status as status
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.host import HostInfo
from vehicle.telemetry.link_status import LinkStatusReporter
from vehicle.telemetry.streams import DialectLevel
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView


class Rover:
    """A `link.core.Core`. Drive it with `receive` as messages come, `sense` with readings, `tick` at 50 Hz."""

    def __init__(
        self,
        params: Params,
        *,
        now: float,
        param_store: ParamStore | None = None,
        plan_store: PlanStore | None = None,
        recording: LogRecorder | None = None,
        host: HostInfo | None = None,
        told: Callable[[Severity, str], None] = lambda severity, text: None,
        rack: AccessorySet | None = None,
    ) -> None:
        """`now` is the monotonic time of boot.

        `param_store` saves parameters that are set, `plan_store` plans; without them they end with the program.
        `recording` writes logs. `host` is told of as it is. `told` hears what the driver reads. `rack` holds relays
        and servos.
        """
        self._params = params
        self._boot = now
        self._system = int(params["MAV_SYSID"])
        self._host = host or HostInfo()
        self._readings = NO_READINGS
        self._outgoing: list[Outgoing] = []
        self._texts = StatusTextQueue(told)
        self._complaints = HealthNotices(self._texts)
        self._control = Control(params, self._texts, system=self._system, boot=now)
        self._drive = Drive(params, now)
        self._navigator = Navigator(params, self._drive.kind)
        self._safety = Safety(
            params,
            self._control,
            self._texts,
            now,
            self._navigator.unready_reason,
            unfenced=lambda: self._navigator.fence_avoidance.unenforceable_reason,
        )
        self._monitor = SafetyMonitor(params, self._safety, self._control, self._texts, now)
        self._telemetry = Telemetry(self._system, now, logged=recording is not None)
        self._demanded: float | None = None
        """When a demand came that has not been told yet."""
        self._ticked: float | None = None
        """The cycle that has been driven, and whose messages are still to be made."""
        self._bandwidth = Bandwidth(lambda: self._safety.armed)
        self._actuator_test = ActuatorTest(params, self._safety, self._control, self._texts, self._drive.mixer.motors)
        self._buttons = Buttons(params, self._safety, self._control, self._texts)
        self._rack = rack or AccessorySet()
        self._links = LinkStatusReporter(self._control, self._texts, (self._system, COMPONENT))
        self._answers = Dispatcher(
            params,
            self._safety,
            self._control,
            self._navigator,
            self._drive,
            self._texts,
            telemetry=self._telemetry,
            bandwidth=self._bandwidth,
            links=self._links,
            trials=self._actuator_test,
            stores=Stores(param_store, plan_store, recording),
            rack=self._rack,
            look=self._build_view,
        )

    @property
    def outputs(self) -> Outputs:
        """What the motors must get now; recomputed inside `receive` and `tick`."""
        return self._drive.outputs

    @property
    def state(self) -> SafetyState:
        """Safety state, for the daemon's log and for tests."""
        return self._safety.state

    @property
    def commands(self) -> frozenset[int]:
        """What is answered with more than UNSUPPORTED."""
        return self._answers.commands

    def reboot_request(self, now: float) -> RebootRequest | None:
        """How the program is to end because a ground station asked for it, or None."""
        return self._answers.reboot_request(now)

    def receive(self, received: Received, now: float) -> None:
        """Take one message; a fresh demand is in `outputs` when this returns."""
        if self._safety.state is SafetyState.OFF:
            return
        self._control.update_liveness(received, now)
        self._actuator_test.update_liveness(received, now)
        self._telemetry.receive(received, now)
        if isinstance(received.message, m.RoverOperatorPresence):
            # It says what the demand behind it is worth and asks for nothing: the ramp's time is the demand's to use.
            self._control.handle_operator_presence(received, received.message, now)
        elif self._handle_demand(received, now):
            self._update_outputs(now)
            self._demanded = now
        elif (answers := self._answers.dispatch_command(received, now)) is not None:
            self._outgoing += answers
            self._update_outputs(now)
            self._queue_due_messages(now)
        else:
            self._outgoing += self._answers.dispatch(received, now)

    def tick(self, now: float) -> None:
        """Let time pass: act on silence. What is due is said by `messages_to_send`."""
        if self._safety.state is SafetyState.OFF:
            return
        late = self._monitor.is_late(now)
        self._cycle(now)
        self._update_outputs(now, late=late)
        self._ticked = now

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take what the links say of themselves, about once a second."""
        if self._safety.state is SafetyState.OFF:
            return
        self._bandwidth.update(reports)
        audience = [peer for report in reports for peer in report.audience]
        self._telemetry.update_audience(audience, self._bandwidth.telemetry_rates, now)
        self._answers.handle_link_reports(now)
        among = self._telemetry.peers_at_level(DialectLevel.ROVER)
        self._outgoing += [Outgoing(status, among=among) for status in self._links.update(reports, now)]

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns. What a demand or a cycle gives to say is made here, when the
        motors have what was decided already."""
        if self._demanded is not None:
            self._outgoing += self._telemetry.build_after_demand(self._build_view(self._demanded))
            self._demanded = None
        if self._ticked is not None and self._safety.state is not SafetyState.OFF:
            self._run_services(self._ticked)
        self._ticked = None
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def _run_services(self, now: float) -> None:
        """What is due in this cycle besides driving."""
        self._queue_due_messages(now)
        self._outgoing += self._answers.tick(now)

    def sense(self, readings: Readings, now: float) -> None:
        """Take the newest readings."""
        self._readings = readings
        self._navigator.sense(readings, now)
        self._safety.battery.update(readings.battery_voltage, now, expected="battery" in readings.configured)
        self._safety.computer.update(readings.computer, now)
        self._complaints.update(sensor_notices(readings) | fence_notices(self._navigator.fence_avoidance), now)

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """The emergency stop's own input, each cycle: why it stops the rover, or None while it is closed."""
        before = self._safety.state
        if before is not SafetyState.OFF:
            self._safety.update_estop_input(reason, now)
        if self._safety.state is not before:
            self._update_outputs(now)

    def motor_failed(self, reason: str, now: float) -> None:
        """The motor driver reports an error: zero, disarm, and no arming until `motor_repaired`."""
        self._safety.motor_failed(reason, now)
        self._update_outputs(now)

    def motor_repaired(self, now: float) -> None:
        """The motor driver has passed its self test again: arming is possible."""
        self._safety.motor_repaired(now)

    def shutdown(self, now: float) -> None:
        """The last call: neutral, disarmed, and one HEARTBEAT that says POWEROFF."""
        if self._safety.state is not SafetyState.OFF:
            self._safety.shutdown()
            self._outgoing.append(Outgoing(status.heartbeat(self._build_view(now))))
        self._drive.update(None, self._monitor.build_clearance(now, None, late=False), limited=False, now=now)

    def _update_outputs(self, now: float, *, late: bool | None = None) -> None:
        """Outputs of this moment."""
        late = self._monitor.is_late(now) if late is None else late
        trial = self._actuator_test.current_test(now, late=late)
        clearance = self._monitor.build_clearance(now, self._navigator.demand, late=late, trial=trial)
        limited = self._safety.failsafes.lasting_action(now) >= FailsafeAction.LIMIT
        self._drive.update(self._demand_in_use(now), clearance, limited=limited, now=now)
        if clearance.permit is not Permit.DRIVE:
            self._navigator.reset_controller()

    def _queue_due_messages(self, now: float) -> None:
        """What the outputs and the state make worth telling."""
        self._outgoing += self._telemetry.build_due(self._build_view(now))
        self._outgoing += [Outgoing(text) for text in self._texts.pop_due(now)]

    def _demand_in_use(self, now: float) -> Demand | None:
        """Whose demand the mode drives by; whether it may is the clearance's matter."""
        if MODES[self._safety.mode].autonomous:
            return self._navigator.demand
        if self._safety.mode is Mode.ACRO:
            return self._navigator.acro_demand(self._control.demand, now)
        return self._control.demand

    def _cycle(self, now: float) -> None:
        """What fails, what follows, and what self-driving wants then."""
        driving = self._drive.driven_wheels
        inputs = self._navigator.build_failsafe_inputs(self._safety, driving)
        moves = MODES[self._safety.mode].autonomous and any(driving)
        self._monitor.update(now, self._drive.rejected_cycles, inputs, driving=moves)
        self._navigator.step(self._safety, now)
        if self._navigator.end_reason is not None:
            self._safety.finish_autonomy(self._navigator.end_reason, now)
            self._navigator.step(self._safety, now)

    def _build_view(self, now: float) -> TelemetryView:
        since_boot = now - self._boot
        return TelemetryView(
            now=now,
            since_boot=since_boot,
            params=self._params,
            readings=self._readings,
            safety=self._safety,
            control=self._control,
            drive=self._drive,
            navigator=self._navigator,
            logs=self._answers.logbook.is_healthy,
            host=self._host,
            rack=self._rack,
        )

    def _handle_demand(self, received: Received, now: float) -> bool:
        """What may move the rover."""
        match received.message:
            case m.ManualControl() as message:
                self._buttons.handle_manual_control(received, message, now)
                self._control.handle_manual_control(received, message, now)
            case m.RcChannelsOverride(target_component=component) as message if component in (0, COMPONENT):
                self._control.handle_rc_override(received, message, now)
            case _:
                return False
        return True
