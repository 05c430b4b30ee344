"""The rover as a core: messages, readings and time in; messages and motor outputs out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects import messages as m
from dialects.enums import Severity
from dialects.modes import Mode
from link.core import LinkReport, Outgoing, Received
from vehicle.accessories.accessory_set import Rack
from vehicle.autonomy.navigator import Navigator
from vehicle.commands.actuator_test import ActuatorTest
from vehicle.commands.buttons import Buttons
from vehicle.commands.dispatch import COMPONENT, Answers, Keepers
from vehicle.commands.params import Keeper
from vehicle.commands.reboot import Leave
from vehicle.drive.control import Control
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Outputs, Permit
from vehicle.modes import OFFERED
from vehicle.params import Params
from vehicle.readings import NO_READINGS, Readings
from vehicle.safety.failsafe import Action
from vehicle.safety.health_notices import Complaints, of_fence, of_sensors
from vehicle.safety.monitor import Watch
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import State
from vehicle.statustext import Texts
from vehicle.storage.logbook import Recording
from vehicle.storage.plan_keeping import PlanKeeper
from vehicle.telemetry import build_status as status
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.host import Host
from vehicle.telemetry.link_status import Links
from vehicle.telemetry.streams import Family
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import View


class Rover:
    """A `link.core.Core`. Drive it with `receive` as messages come, `sense` with readings, `tick` at 50 Hz."""

    def __init__(
        self,
        params: Params,
        *,
        now: float,
        keeper: Keeper | None = None,
        plan_keeper: PlanKeeper | None = None,
        recording: Recording | None = None,
        host: Host | None = None,
        told: Callable[[Severity, str], None] = lambda severity, text: None,
        rack: Rack | None = None,
    ) -> None:
        """`now` is the monotonic time of boot.

        `keeper` remembers parameters that are set, `plan_keeper` plans; without them they end with the program.
        `recording` writes logs. `host` is told of as it is. `told` hears what the driver reads. `rack` holds relays
        and servos.
        """
        self._params = params
        self._boot = now
        self._system = int(params["MAV_SYSID"])
        self._host = host or Host()
        self._readings = NO_READINGS
        self._outgoing: list[Outgoing] = []
        self._texts = Texts(told)
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
            unfenced=lambda: self._navigator.boundary.unfenced,
        )
        self._watch = Watch(params, self._safety, self._control, self._texts, now)
        self._telemetry = Telemetry(self._system, now, logged=recording is not None)
        self._demanded: float | None = None
        """When a demand came that has not been told yet."""
        self._ticked: float | None = None
        """The cycle that has been driven, and whose messages are still to be made."""
        self._bandwidth = Bandwidth(lambda: self._safety.armed)
        self._actuator_test = ActuatorTest(params, self._safety, self._control, self._texts, self._drive.mixer.motors)
        self._buttons = Buttons(params, self._safety, self._control, self._texts)
        self._rack = rack or Rack()
        self._links = Links(self._control, self._texts, (self._system, COMPONENT))
        self._answers = Answers(
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
            keepers=Keepers(keeper, plan_keeper, recording),
            rack=self._rack,
            look=self._look,
        )

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
        return self._answers.commands

    def leaving(self, now: float) -> Leave | None:
        """How the program is to end because a ground station asked for it, or None."""
        return self._answers.leaving(now)

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
        elif (answers := self._answers.order(received, now)) is not None:
            self._outgoing += answers
            self._move(now)
            self._tell(now)
        else:
            self._outgoing += self._answers.receive(received, now)

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
        self._answers.observe(now)
        among = self._telemetry.speakers(Family.ROVER)
        self._outgoing += [Outgoing(status, among=among) for status in self._links.observe(reports, now)]

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
        self._outgoing += self._answers.tick(now)

    def sense(self, readings: Readings, now: float) -> None:
        """Take the newest readings."""
        self._readings = readings
        self._navigator.sense(readings, now)
        self._safety.battery.sense(readings.battery_voltage, now, expected="battery" in readings.configured)
        self._safety.computer.sense(readings.computer, now)
        self._complaints.update(of_sensors(readings) | of_fence(self._navigator.boundary), now)

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
            params=self._params,
            readings=self._readings,
            safety=self._safety,
            control=self._control,
            drive=self._drive,
            navigator=self._navigator,
            logs=self._answers.logbook.well,
            host=self._host,
            rack=self._rack,
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
