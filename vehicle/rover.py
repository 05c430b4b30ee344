"""The rover as a core: messages, readings and time in; messages and motor outputs out."""

from __future__ import annotations

from collections.abc import Sequence

from dialects import messages as m
from dialects.enums import Severity
from dialects.modes import Mode
from link.core import LinkReport, Outgoing, Received
from link.services import timesync
from link.services.command import CommandServer
from vehicle import status
from vehicle.actuator_test import ActuatorTest
from vehicle.bandwidth import Bandwidth
from vehicle.buttons import Buttons
from vehicle.commands import Commands
from vehicle.complaints import Complaints, of_sensors
from vehicle.control import Control
from vehicle.demand import Demand
from vehicle.drive import Drive
from vehicle.failsafe import Action
from vehicle.fields import UINT8, UINT32, whole
from vehicle.leaving import Leave
from vehicle.logbook import Logbook, Recording
from vehicle.modes import OFFERED
from vehicle.navigator import Navigator
from vehicle.orders import Orders
from vehicle.outputs import Outputs, Permit
from vehicle.param_service import Keeper, ParamService
from vehicle.params import Params
from vehicle.plans import PlanKeeper, Plans
from vehicle.preflight import Preflight
from vehicle.readings import NO_READINGS, Readings
from vehicle.requests import Requests
from vehicle.safety import Safety
from vehicle.services import Services
from vehicle.states import State
from vehicle.streams import Family
from vehicle.telemetry import Telemetry
from vehicle.texts import Texts
from vehicle.view import View
from vehicle.watch import Watch

COMPONENT = 1
"""MAV_COMP_ID_AUTOPILOT1: QGroundControl makes a vehicle only of this one."""
ROUND_TRIP_UNKNOWN = m.UINT16_MAX


class Rover:
    """A `link.core.Core`. Drive it with `receive` as messages come, `sense` with readings, `tick` at 50 Hz."""

    def __init__(
        self,
        params: Params,
        *,
        now: float,
        wall_clock: float | None = None,
        keeper: Keeper | None = None,
        plan_keeper: PlanKeeper | None = None,
        recording: Recording | None = None,
    ) -> None:
        """`now` is the monotonic time of boot; `wall_clock` the Unix time at `now`, None where it is not known.

        `keeper` remembers parameters that are set, `plan_keeper` plans; without them they end with the program.
        `recording` writes logs.
        """
        self._params = params
        self._boot = now
        self._wall_clock = wall_clock
        self._system = int(params["MAV_SYSID"])
        self._readings = NO_READINGS
        self._outgoing: list[Outgoing] = []
        self._texts = Texts()
        self._complaints = Complaints(self._texts)
        self._control = Control(params, self._texts, system=self._system, boot=now)
        self._drive = Drive(params, now)
        self._navigator = Navigator(params, self._drive.kind)
        self._safety = Safety(
            params,
            self._control,
            self._texts,
            now,
            self._navigator.unready,
            unfenced=lambda: self._navigator.boundary.fence.missing,
        )
        self._watch = Watch(params, self._safety, self._control, self._texts, now)
        self._telemetry = Telemetry(self._system, now, logged=recording is not None)
        self._demanded: float | None = None
        """When a demand came that has not been told yet."""
        self._ticked: float | None = None
        """The cycle that has been driven, and whose messages are still to be made."""
        self._bandwidth = Bandwidth(lambda: self._safety.armed)
        self._param_service = ParamService(
            params,
            self._control,
            self._texts,
            ids=(self._system, COMPONENT),
            pacer=self._bandwidth.pacer,
            armed=lambda: self._safety.armed,
            keeper=keeper,
        )
        self._commands = Commands(self._safety, self._control, self._texts)
        self._actuator_test = ActuatorTest(params, self._safety, self._control, self._texts, self._drive.mixer.motors)
        self._buttons = Buttons(params, self._safety, self._control, self._texts)
        self._orders = Orders(params, self._safety, self._control, self._navigator, self._texts)
        self._plans = Plans(
            params,
            self._safety,
            self._control,
            self._navigator,
            self._texts,
            self._drive.mixer.servos,
            pacer=self._bandwidth.pacer,
            keeper=plan_keeper,
        )
        self._logbook = Logbook(params, self._control, self._texts, lambda: self._safety.armed, recording)
        self._services = Services(
            params,
            self._control,
            self._logbook,
            missions=self._plans.folder(),
            ids=(self._system, COMPONENT),
            pacer=self._bandwidth.pacer,
        )
        self._preflight = Preflight(params, self._safety, self._control, self._param_service, self._texts)
        self._requests = Requests(self._telemetry, self._look, self._services.messages())
        handlers = self._commands.handlers() | self._requests.handlers()
        handlers |= self._orders.handlers() | self._plans.handlers() | self._actuator_test.handlers()
        handlers |= self._preflight.handlers()
        self._server = CommandServer(handlers, system=self._system, component=COMPONENT)

    @property
    def outputs(self) -> Outputs:
        """What the motors must get now; recomputed inside `receive` and `tick`."""
        return self._drive.outputs

    @property
    def state(self) -> State:
        """Safety state, for the daemon's log and for tests."""
        return self._safety.state

    @property
    def commands(self) -> frozenset[int]:
        """What is answered with more than UNSUPPORTED."""
        return self._server.commands

    def leaving(self, now: float) -> Leave | None:
        """How the program is to end because a ground station asked for it, or None."""
        return self._preflight.leaving(now)

    def receive(self, received: Received, now: float) -> None:
        """Take one message; a fresh demand is in `outputs` when this returns."""
        if self._safety.state is State.OFF:
            return
        self._control.hear(received, now)
        self._actuator_test.hear(received, now)
        self._telemetry.receive(received, now)
        if isinstance(received.message, m.RoverOperatorPresence):
            # It says what the demand behind it is worth and asks for nothing: the ramp's time is the demand's to use.
            self._control.operator(received, received.message, now)
        elif self._demand(received, now):
            self._move(now)
            self._demanded = now
        elif self._order(received, now):
            self._move(now)
            self._tell(now)
        else:
            self._outgoing += timesync.answer(received, now, (self._system, COMPONENT))
            self._outgoing += self._plans.receive(received, now)
            self._outgoing += self._param_service.receive(received, now)
            self._outgoing += self._services.receive(received, now)
            self._preflight.receive(received, now)

    def tick(self, now: float) -> None:
        """Let time pass: act on silence. What is due is said by `messages_to_send`."""
        if self._safety.state is State.OFF:
            return
        late = self._watch.is_late(now)
        self._cycle(now)
        self._move(now, late=late)
        self._ticked = now

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take what the links say of themselves, about once a second."""
        if self._safety.state is State.OFF:
            return
        self._bandwidth.observe(reports)
        audience = [peer for report in reports for peer in report.audience]
        self._telemetry.attend(audience, self._bandwidth.telemetry, now)
        self._param_service.observe(now)
        self._logbook.observe(now)
        for report in reports:
            self._outgoing.append(Outgoing(self._link_status(report), among=self._telemetry.speakers(Family.ROVER)))
            for name in report.dialect_mismatch:
                text = f"Dialect mismatch on {report.name}: {name} has another definition"
                self._texts.say_once(f"mismatch {report.name} {name}", Severity.WARNING, text, now)
            if report.own_id:
                text = f"Somebody on {report.name} uses our own ids {self._system}/{COMPONENT}"
                self._texts.say_once(f"own id {report.name}", Severity.WARNING, text, now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns. What a demand or a cycle gives to say is made here, when the
        motors have what was decided already."""
        if self._demanded is not None:
            self._outgoing += self._telemetry.of_demand(self._look(self._demanded))
            self._demanded = None
        if self._ticked is not None and self._safety.state is not State.OFF:
            self._go_on(self._ticked)
        self._ticked = None
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def _go_on(self, now: float) -> None:
        """What is due in this cycle besides driving."""
        self._tell(now)
        self._outgoing += self._server.tick(now)
        self._outgoing += self._param_service.tick(now)
        self._outgoing += self._services.tick(now)
        self._outgoing += self._plans.tick(now)
        self._outgoing += self._logbook.tick(now)

    def sense(self, readings: Readings, now: float) -> None:
        """Take the newest readings."""
        self._readings = readings
        self._navigator.sense(readings, now)
        self._safety.battery.sense(readings.battery_voltage, now, expected="battery" in readings.configured)
        self._safety.computer.sense(readings.computer, now)
        self._complaints.update(of_sensors(readings), now)

    def stop_input(self, reason: str | None, now: float) -> None:
        """The emergency stop's own input, each cycle: why it stops the rover, or None while it is closed."""
        before = self._safety.state
        if before is not State.OFF:
            self._safety.stop_input(reason, now)
        if self._safety.state is not before:
            self._move(now)

    def motor_failed(self, reason: str, now: float) -> None:
        """The motor driver reports an error: zero, disarm, and no arming until `motor_repaired`."""
        self._safety.motor_failed(reason, now)
        self._move(now)

    def motor_repaired(self, now: float) -> None:
        """The motor driver has passed its self test again: arming is possible."""
        self._safety.motor_repaired(now)

    def shutdown(self, now: float) -> None:
        """The last call: neutral, disarmed, and one HEARTBEAT that says POWEROFF."""
        if self._safety.state is not State.OFF:
            self._safety.shutdown()
            self._outgoing.append(Outgoing(status.heartbeat(self._look(now))))
        self._drive.step(None, self._watch.clearance(now, None, late=False), limited=False, now=now)

    def _move(self, now: float, *, late: bool | None = None) -> None:
        """Outputs of this moment."""
        late = self._watch.is_late(now) if late is None else late
        trial = self._actuator_test.trial(now, late=late)
        clearance = self._watch.clearance(now, self._navigator.demand, late=late, trial=trial)
        limited = self._safety.failsafes.action(now) >= Action.LIMIT
        self._drive.step(self._wanted(now), clearance, limited=limited, now=now)
        if clearance.permit is not Permit.DRIVE:
            self._navigator.rest()

    def _tell(self, now: float) -> None:
        """What the outputs and the state make worth telling."""
        self._outgoing += self._telemetry.due(self._look(now))
        self._outgoing += [Outgoing(text) for text in self._texts.due(now)]

    def _wanted(self, now: float) -> Demand | None:
        """Whose demand the mode drives by; whether it may is the clearance's matter."""
        if OFFERED[self._safety.mode].own:
            return self._navigator.demand
        if self._safety.mode is Mode.ACRO:
            return self._navigator.acro(self._control.demand, now)
        return self._control.demand

    def _cycle(self, now: float) -> None:
        """What fails, what follows, and what self-driving wants then."""
        driving = self._drive.driving
        hazards = self._navigator.hazards(self._safety, driving, now)
        moves = OFFERED[self._safety.mode].own and any(driving)
        self._watch.update(now, self._drive.refused, hazards, driving=moves)
        self._navigator.step(self._safety, now)
        if self._navigator.ended is not None:
            self._safety.end(self._navigator.ended, now)
            self._navigator.step(self._safety, now)

    def _look(self, now: float) -> View:
        since_boot = now - self._boot
        return View(
            now=now,
            since_boot=since_boot,
            unix_time=None if self._wall_clock is None else self._wall_clock + since_boot,
            params=self._params,
            readings=self._readings,
            safety=self._safety,
            control=self._control,
            drive=self._drive,
            navigator=self._navigator,
            logs=self._logbook.well,
        )

    def _link_status(self, report: LinkReport) -> m.Message:
        return m.RoverLinkStatus(
            frames_ok=whole(report.frames, UINT32),
            crc_errors=whole(report.crc_errors, UINT32),
            resync_bytes=whole(report.resync_bytes, UINT32),
            bad_signature=0,
            replayed=whole(report.duplicates + report.late, UINT32),
            unsigned_rejected=0,
            not_in_control=whole(self._control.not_in_control, UINT32),
            rate_limited=whole(report.rate_limited, UINT32),
            rtt_ms=ROUND_TRIP_UNKNOWN,
            jitter_ms=ROUND_TRIP_UNKNOWN,
            link_id=whole(report.index, UINT8),
            peers=whole(report.peers, UINT8),
        )

    def _demand(self, received: Received, now: float) -> bool:
        """What may move the rover."""
        match received.message:
            case m.ManualControl() as message:
                self._buttons.take(received, message, now)
                self._control.manual(received, message, now)
            case m.RcChannelsOverride(target_component=component) as message if component in (0, COMPONENT):
                self._control.rc_override(received, message, now)
            case _:
                return False
        return True

    def _order(self, received: Received, now: float) -> bool:
        """What changes the rover or what it tells."""
        match received.message:
            case m.CommandLong() | m.CommandInt() as message:
                self._command(message, received, now)
            case m.CommandCancel():
                self._outgoing += self._server.receive(received, now)
            case m.SetPositionTargetLocalNed() | m.SetPositionTargetGlobalInt() | m.SetAttitudeTarget() as message:
                if self._orders.setpoint(received, message, now):
                    self._navigator.step(self._safety, now)
            case m.SetMode(target_system=self._system) as message:
                self._commands.set_mode(received, message, now)
            case _:
                return False
        self._navigator.renew(self._safety, now)
        return True

    def _command(self, message: m.CommandLong | m.CommandInt, received: Received, now: float) -> None:
        if message.target_system == 0 and not self._commands.for_everybody(message):
            return
        self._outgoing += self._server.receive(received, now)
        self._outgoing += self._commands.messages_to_send() + self._requests.messages_to_send()
