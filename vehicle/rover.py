"""The vehicle as a core: messages, sensor readings and time in; messages and motor outputs out."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects.enums import Severity
from dialects.messages import target_system
from dialects.modes import Mode
from dialects.traits import is_stop
from link.core import LinkReport, Outgoing, Peer, Received
from link.protocol.rate import SenderLimit
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.autonomy.navigator import Navigator
from vehicle.camera.camera import Camera
from vehicle.commands.access import CommandAccess
from vehicle.commands.command_table import CommandTable
from vehicle.commands.context import COMPONENT, Context, Reporting
from vehicle.commands.dispatch import Dispatcher, Stores
from vehicle.commands.inbound import Effect, InboundTable
from vehicle.commands.reboot import RebootRequest
from vehicle.commands.signing import Pairing
from vehicle.drive.control import Control
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.freshness import FreshnessLimit
from vehicle.drive.gate import DRIVE, Outputs
from vehicle.modes import MODES
from vehicle.outbox import Outbox
from vehicle.pace import PERIOD, REST_PERIOD, ROUTINE, Activity, Pace
from vehicle.params import Params
from vehicle.proximity.obstacles import Obstacles
from vehicle.proximity.override import ObstacleOverride
from vehicle.readings import NO_READINGS, Readings
from vehicle.safety.failsafe import FailsafeAction
from vehicle.safety.health_notices import HealthNotices, fence_notices, obstacle_notices, sensor_notices
from vehicle.safety.monitor import SafetyMonitor
from vehicle.safety.state_machine import Safety
from vehicle.safety.states import SafetyState
from vehicle.safety.steady_driving import SteadyDriving
from vehicle.statustext import StatusTextQueue
from vehicle.storage.logbook import LogRecorder
from vehicle.storage.param_store import ParamStore
from vehicle.storage.plan_store import PlanStore
from vehicle.telemetry import build_status
from vehicle.telemetry.bandwidth import Bandwidth
from vehicle.telemetry.host import HostInfo
from vehicle.telemetry.link_status import LinkStatusReporter
from vehicle.telemetry.streams import DialectLevel
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView

_LIMIT, _DEMAND, _MOTION, _OFF = FailsafeAction.LIMIT, Effect.DEMAND, Effect.MOTION, SafetyState.OFF
"""Shortcuts for what runs with each demand: a lookup in an enum costs as much as three comparisons."""
STOP_ANSWER_PERIOD = 1.0
"""s between two HEARTBEATs to the sender of stops who gets no telemetry, as between those to all others."""
STOP_ANSWERS_MAX = 32
"""Senders that are answered so in that time."""


class Rover:
    """A `link.core.Core`. Call `receive` for each message, `sense` with readings, and `tick` at 50 Hz."""

    def __init__(
        self,
        params: Params,
        *,
        now: float,
        param_store: ParamStore | None = None,
        plan_store: PlanStore | None = None,
        recording: LogRecorder | None = None,
        pairing: Pairing | None = None,
        arming_note: str | None = None,
        host: HostInfo | None = None,
        on_text: Callable[[Severity, str], None] = lambda severity, text: None,
        rack: AccessorySet | None = None,
        camera: Camera | None = None,
    ) -> None:
        """`now` is the monotonic time of boot.

        `param_store` saves parameters and `plan_store` plans; without them both end with the program. `recording`
        writes logs. `pairing` keeps keys. `arming_note` is said at each arming. `host` describes the computer.
        `on_text` is called with every STATUSTEXT. `rack` holds relays and servos.
        `camera` says who watches it.
        """
        self._params = params
        self._boot = now
        self._host = host or HostInfo()
        self._rack = rack or AccessorySet()
        self._camera = camera
        self._readings = NO_READINGS
        self._activity = Activity(now)
        self._cycles = Pace(self._activity)
        self._texts = texts = StatusTextQueue(on_text)
        self._health_notices = HealthNotices(texts)
        self._control = Control(params, texts, system=int(params["MAV_SYSID"]), boot=now)
        self._drive = Drive(params, now)
        self._freshness = FreshnessLimit(params)
        self._obstacles = Obstacles(params, self._drive.kind)
        self._override = ObstacleOverride(self._obstacles, texts)
        self._moved_at = now
        self._navigator = Navigator(params, self._drive.kind)
        self._safety = Safety(params, self._control, texts, now, self._navigator)
        self._monitor = SafetyMonitor(params, self._safety, self._control, self._texts, now)
        self._steady = SteadyDriving(self._safety, self._control, self._monitor, now)
        self._telemetry = Telemetry(self._control.system, now, logged=recording is not None)
        self._telemetry.greet = self._activity.resume_full_rate  # it does not wait for the end of a rest
        self._bandwidth = Bandwidth(self._safety, lambda peer: self._telemetry.has_level(peer, DialectLevel.ROVER))
        self._links = LinkStatusReporter(self._control, self._texts, (self._control.system, COMPONENT))
        self._dispatcher = self._build_dispatcher(Stores(param_store, plan_store, recording, pairing), arming_note)
        self._actuator_test = self._dispatcher.actuator_test
        self._outbox = Outbox(
            self._telemetry, texts, self._dispatcher, self._safety, self._rack, self._build_view, self._activity
        )
        self._stop_answers = SenderLimit(STOP_ANSWER_PERIOD, STOP_ANSWERS_MAX)
        self._routes = {row.message: row for row in self._dispatcher.messages}
        self._observers = (  # called with every message, before its handler and whoever sent it
            self._control.hear,
            self._actuator_test.update_liveness,
            self._telemetry.observe,
            self._dispatcher.signing.observe,
            *((self._dispatcher.camera.observe,) if camera is not None else ()),
        )

    @property
    def outputs(self) -> Outputs:
        """What the motors must get now; `receive` and `tick` update it."""
        return self._drive.outputs

    @property
    def state(self) -> SafetyState:
        """Safety state, for the daemon's log and for tests."""
        return self._safety.state

    @property
    def reserved_ids(self) -> tuple[int, int] | None:
        """Ids of the ground station in control: it gets a place on each link even if all are taken."""
        driver = self._control.ownership.driver
        return driver.conversation.ids if driver else None

    @property
    def messages(self) -> InboundTable:
        """The messages that are handled; others need not be decoded."""
        return self._dispatcher.messages

    @property
    def message_ids(self) -> frozenset[int]:
        """Ids of `messages`."""
        return frozenset(row.message.id for row in self.messages)

    @property
    def commands(self) -> CommandTable:
        """The MAV_CMDs that are handled; others are answered UNSUPPORTED."""
        return self._dispatcher.commands

    def reboot_request(self, now: float) -> RebootRequest | None:
        """Return how the program must end because a ground station requested it, or None."""
        return self._dispatcher.reboot_request(now)

    def receive(self, received: Received, now: float) -> None:
        """Handle one message; a new demand is in `outputs` when this returns."""
        if self._safety.state is _OFF:
            return
        for observe in self._observers:
            observe(received, now)
        message = received.message
        route = self._routes.get(type(message))
        if route is None or not (received.introduced or route.accepts_unintroduced(received)):
            return
        if not isinstance(message, ROUTINE):
            self._activity.resume_full_rate(now)
        effect = route.effect
        before = self._motion_inputs() if effect is _DEMAND else None
        replies = route.handle(received, message, now)
        if replies:
            self._outbox.add(replies)
        if effect is _MOTION or (effect is _DEMAND and before is not None and self._has_changed(before, now)):
            self._act(effect, now)
        if effect is _MOTION and not received.may_ask:
            self._show_stop(received, now)

    def tell_time(self, peer: Peer, now: float) -> None:
        """Answer a sender who signs with a wrong time with a HEARTBEAT, as `link.core.TimeTeller` says."""
        if self._safety.state is not _OFF:
            self._outbox.add([Outgoing(build_status.heartbeat(self._build_view(now)), peer)])

    def tick(self, now: float) -> None:
        """Run one control cycle. `messages_to_send` then builds the messages that are due."""
        if self._safety.state is SafetyState.OFF:
            return
        late = self._monitor.is_late(now)
        self._cycle(now)
        self._update_outputs(now, late=late)
        self._cycles.mark_done(now)
        self._outbox.note_cycle(now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Store the reports of the links, about once a second."""
        if self._safety.state is SafetyState.OFF:
            return
        self._bandwidth.update(reports)
        audience = [peer for report in reports for peer in report.audience]
        self._telemetry.update_audience(audience, self._bandwidth.telemetry_rates, now)
        self._dispatcher.check_storage(now)
        among = self._telemetry.peers_at_level(DialectLevel.ROVER)
        self._outbox.add(Outgoing(status, among=among) for status in self._links.update(reports, now))

    def messages_to_send(self) -> list[Outgoing]:
        """Return what to send now and forget it. What follows a demand or a cycle is built here, after the motors."""
        return self._outbox.pop()

    def sense(self, readings: Readings, now: float) -> None:
        """Store the newest readings."""
        self._readings = readings
        self._navigator.sense(readings, now)
        self._safety.battery.update(readings.battery_voltage, now, expected="battery" in readings.configured)
        self._safety.computer.update(readings.computer, now)
        self._avoid(now)
        notices = sensor_notices(readings) | fence_notices(self._navigator.fence_avoidance)
        self._health_notices.update(notices | obstacle_notices(self._obstacles.faults), now)

    def update_estop_input(self, reason: str | None, now: float) -> None:
        """Set the state of the emergency-stop input each cycle: why it stops the rover, or None while it is closed."""
        before = self._safety.state
        if before is not SafetyState.OFF:
            self._safety.update_estop_input(reason, now)
        if self._safety.state is not before:
            self._activity.resume_full_rate(now)
            self._update_outputs(now)

    def motor_failed(self, reason: str, now: float) -> None:
        """Handle an error of the motor driver: zero, disarm, and no arming until `motor_repaired`."""
        self._safety.motor_failed(reason, now)
        self._update_outputs(now)

    def motor_repaired(self, now: float) -> None:
        """Allow arming again: the motor driver has passed its self-test."""
        self._safety.motor_repaired(now)

    def tick_outputs(self, now: float, *, powered: bool) -> bool:
        """Run a short cycle and return True, or return False: a whole one is due.

        A short one is enough while nothing is under way, and the rover is disarmed, or drives as steadily as before.
        Late cycles, the age of the demand and the last gate are checked in it as in a whole one.
        """
        if self._actuator_test.running or self._cycles.is_due(now) or self._monitor.is_late(now):
            return False
        if self._safety.armed:
            if self._obstacles.active or self._navigator.fence_avoidance.fence.enabled or not self._steady.lasts(now):
                return False
            self._update_outputs(now, late=False)
            self._outbox.note_short_cycle(now)
        elif powered:
            return False
        self._monitor.skip_cycle(now)
        return True

    def rest_period(self, now: float) -> float | None:
        """Return the s between cycles that are enough until the next message: disarmed, nothing under way; or None."""
        if self._safety.armed or self._actuator_test.running or self._activity.is_busy(now):
            return None
        return REST_PERIOD if self._telemetry.shortest >= REST_PERIOD else PERIOD

    def shutdown(self, now: float) -> None:
        """Set neutral outputs, disarm, and queue one HEARTBEAT with MAV_STATE_POWEROFF. The last call."""
        if self._safety.state is not SafetyState.OFF:
            self._safety.shutdown()
            self._outbox.add([Outgoing(build_status.heartbeat(self._build_view(now)))])
        self._drive.update(None, self._monitor.build_clearance(now, None, late=False), limited=False, now=now)

    def _build_dispatcher(self, stores: Stores, arming_note: str | None) -> Dispatcher:
        context = Context(
            params=self._params,
            safety=self._safety,
            control=self._control,
            navigator=self._navigator,
            obstacles=self._obstacles,
            statustext=self._texts,
            access=CommandAccess(self._control.ownership, self._texts),
            mixer=self._drive.mixer,
            pacer=self._bandwidth.pacer,
            file_pacer=self._bandwidth.file_pacer,
            arming_note=arming_note,
        )
        reporting = Reporting(self._telemetry, self._links, self._build_view, self._camera)
        return Dispatcher(context, reporting, stores, self._rack)

    def _motion_inputs(self) -> tuple[Demand | None, SafetyState, int]:
        """Return what a demand or a button may have changed."""
        return self._control.demand, self._safety.state, self._safety.mode_generation

    def _has_changed(self, before: tuple[Demand | None, SafetyState, int], now: float) -> bool:
        """Return whether a demand must be acted upon at once; one that repeats the last one waits for the cycle."""
        demand, state, generation = before
        if self._safety.state is not state or self._safety.mode_generation != generation:
            self._activity.resume_full_rate(now)
            return True
        if self._control.demand is demand:
            return False
        if self._steady.repeats(demand, now):
            self._outbox.note_short_cycle(now)
            return False
        return True

    def _show_stop(self, received: Received, now: float) -> None:
        """Let the sender of a stop who gets no telemetry see its effect: a HEARTBEAT, no larger than the request."""
        message, peer = received.message, received.peer
        if target_system(message) not in (0, self._control.system) or not is_stop(message):
            return
        if self._stop_answers.allow((peer.link, peer.address), now):
            self._outbox.add([Outgoing(build_status.heartbeat(self._build_view(now)), peer)])

    def _act(self, effect: Effect, now: float) -> None:
        """Bring outputs and telemetry up to date with what a message has changed."""
        if effect is _DEMAND:
            self._update_outputs(now)
            self._outbox.note_demand(now)
        else:
            self._navigator.restart_mode(self._safety, now)
            self._update_outputs(now)
            self._outbox.queue_due(now)

    def _update_outputs(self, now: float, *, late: bool | None = None) -> None:
        """Compute the motor outputs of this moment."""
        late = self._monitor.is_late(now) if late is None else late
        test = self._actuator_test.current_test(now, late=late)
        clearance = self._monitor.build_clearance(now, self._navigator.demand, late=late, trial=test)
        limited = self._safety.failsafes.lasting_action(now) >= _LIMIT
        driven = clearance.permit is DRIVE
        fresh_speed = self._limit_by_freshness(now, driven=driven)
        self._drive.update(
            self._demand_in_use(now), clearance, limited=limited, now=now, fresh_speed=fresh_speed,
            avoid=self._obstacles.share if self._obstacles.active else None,
        )  # fmt: skip
        self._steady.note_outputs(self._drive.wheels, driven=driven, now=now)
        if not driven:
            self._navigator.reset_controller()

    def _avoid(self, now: float) -> None:
        """Carry what range sensors see along with the rover, and find out which of them have failed."""
        dt, self._moved_at = now - self._moved_at, now
        self._obstacles.sense(self._readings.ranges)
        if not self._obstacles.active:
            return
        estimate, armed = self._navigator.estimate, self._safety.armed
        demand = self._control.demand if armed and not self._control.is_demand_stale(now) else None
        self._override.update(demand, now)
        self._obstacles.move(self._drive.wheels, estimate.speed, estimate.yaw_rate, now, dt, armed=armed)

    def _limit_by_freshness(self, now: float, *, driven: bool) -> float:
        """Return the m/s that the age of the commands allows; infinite where no command is needed."""
        params, mode = self._params, self._safety.mode
        sent_at, timeout = self._control.sent_at, self._control.longest_age
        if MODES[mode].autonomous:
            expires = self._navigator.guided.expires_at() if mode is Mode.GUIDED else None
            timeout = params["GUIDED_TIMEOUT"]
            sent_at = None if expires is None else expires - timeout
        speed = max(self._drive.travel * params["SPEED_MAX"], self._navigator.estimate.ground_speed)
        return self._freshness.update(sent_at if driven else None, timeout, speed, now)

    def _demand_in_use(self, now: float) -> Demand | None:
        """Return the demand that the mode obeys; the clearance decides whether it may move anything."""
        if MODES[self._safety.mode].autonomous:
            return self._navigator.demand
        if self._safety.mode is Mode.ACRO:
            return self._navigator.acro_demand(self._control.demand, now)
        return self._control.demand

    def _cycle(self, now: float) -> None:
        """Find hazards, apply failsafes, then let the mode that drives itself decide."""
        driving = self._drive.driven_wheels
        inputs = self._navigator.build_failsafe_inputs(self._safety, driving)
        moves = MODES[self._safety.mode].autonomous and any(driving)
        self._monitor.update(now, self._drive.rejected_cycles, inputs, driving=moves)
        self._navigator.step(self._safety, now)
        if self._navigator.end_reason is not None:
            self._finish_mode(self._navigator.end_reason, now)

    def _finish_mode(self, reason: str, now: float) -> None:
        """Change to HOLD in the cycle in which a mode ends.

        The second step makes the navigator drop the demand of the mode that has ended, before outputs are computed.
        """
        self._safety.finish_autonomy(reason, now)
        self._navigator.step(self._safety, now)

    def _build_view(self, now: float) -> TelemetryView:
        return TelemetryView(
            now=now,
            since_boot=now - self._boot,
            params=self._params,
            readings=self._readings,
            safety=self._safety,
            control=self._control,
            drive=self._drive,
            fresh_speed=self._freshness.speed,
            navigator=self._navigator,
            obstacles=self._obstacles,
            logs=self._dispatcher.logbook.is_healthy,
            host=self._host,
            rack=self._rack,
        )
