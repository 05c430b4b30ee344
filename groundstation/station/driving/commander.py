"""Commands to vehicles (COMMAND_LONG): arming, modes, emergency stop, and the station's own queries."""

from __future__ import annotations

from collections.abc import Callable

from dialects.enums import Command, Result, Severity
from dialects.messages import Message
from dialects.mode_tables import HOLD
from groundstation.intents.vehicle import TAKE_OFF_ALTITUDE
from groundstation.snapshot import EmergencyProgress
from groundstation.station.driving.arming import ArmSequence, ArmStep, send_mode
from groundstation.station.driving.claims import Claims
from groundstation.station.driving.command_results import CommandResults
from groundstation.station.driving.stops.blind_stops import EVERYBODY, BlindStops
from groundstation.station.driving.stops.emergency import EmergencyLock
from groundstation.station.driving.stops.stop_questions import FALLS, StopQuestions
from groundstation.station.outbox import StationOutbox
from groundstation.vehicles.demand.repeated_stop import RepeatedStop, StopEnd, StopTimes, disarm_stop, mode_stop
from groundstation.vehicles.demand.stop_commands import DANGEROUS, StopKind
from groundstation.vehicles.demand.take_off import find_fence_refusal, find_refusal, take_off_params
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.vehicles.stops.altitude_fence import AltitudeFence
from link.core import Received
from link.services.command.client import CommandClient, CommandOutcome

QUERY_COMMANDS = (
    Command.REQUEST_MESSAGE,
    Command.SET_MESSAGE_INTERVAL,
    Command.VIDEO_START_STREAMING,
    Command.VIDEO_STOP_STREAMING,
)
"""Commands that the station sends on its own: their results are not logged."""

STOP_TIMEOUT = 6.0
"""s for which disarm and HOLD are repeated; then what the heartbeat reports is shown as a failure."""


class Commander:
    """Sends commands to all vehicles. `system` and `component` are our ids."""

    def __init__(
        self,
        log: MessageLog,
        outbox: StationOutbox,
        system: int,
        component: int,
        *,
        take_off_altitude: float = TAKE_OFF_ALTITUDE,
    ) -> None:
        self._log = log
        self._results = CommandResults(log)
        self._client = CommandClient(system, component, outbox.commands)
        self._arming: ArmSequence | None = None
        self._stops: dict[tuple[int, int], RepeatedStop] = {}
        """By system id and command."""
        self._locks: dict[int, EmergencyLock] = {}
        self._claims = Claims()
        self._stop_questions = StopQuestions()
        self.blind_stops = BlindStops((system, component), log)
        self._outbox = outbox.commands
        self._vehicles: dict[int, VehicleState] = {}
        """Vehicles that were sent a command, by system id."""
        self._query_outcomes: list[CommandOutcome] = []
        self.take_off_refusal: Callable[[int], str] = lambda system: ""
        """Takes a system id; returns why keys may not take off this vehicle, "" if they may."""
        self.altitude_fence: Callable[[int], AltitudeFence | None] = lambda system: None
        """Takes a system id; returns how high the fence of this vehicle lets it fly."""
        self.take_off_altitude = take_off_altitude
        """m above the ground, of the key."""

    # ---- commands of the operator ----

    def send(self, vehicle: VehicleState, label: str, command: str, *params: float, now: float) -> None:
        """Send the command of this name; `label` names it in the log and in refusals."""
        number = Command[command]
        self._results.set_label(vehicle.system, number, label)
        self._send(vehicle, now, number, *params)

    def arm(self, vehicle: VehicleState, now: float) -> None:
        """Send neutral demands, change from HOLD to MANUAL, then arm; refused for a kind that keys do not drive."""
        if vehicle.model.refusal:
            self._results.add_refusal(vehicle.system, f"arm: {vehicle.name}: {vehicle.model.refusal}", now)
            return
        if vehicle.system in self._locks or vehicle.emergency_stop:
            self._results.add_refusal(vehicle.system, "arm: emergency stop active, clear it first", now)
            return
        if why := self.take_off_refusal(vehicle.system):
            self._results.add_refusal(vehicle.system, f"arm: no take-off: {why}", now)
            return
        self._stops.pop((vehicle.system, Command.COMPONENT_ARM_DISARM), None)
        self._stops.pop((vehicle.system, Command.DO_SET_MODE), None)
        self._results.set_label(vehicle.system, Command.DO_SET_MODE, f"mode {vehicle.model.drive_mode}")
        self._vehicles[vehicle.system] = vehicle
        self._arming = ArmSequence.start(vehicle, now)

    def disarm(self, vehicle: VehicleState, now: float) -> None:
        """Disarm, and repeat until the heartbeat agrees: the vehicle may still act on an earlier arm command."""
        self._arming = None
        self._begin_stop(disarm_stop(vehicle, StopTimes(now, now, now + STOP_TIMEOUT)), now)

    def release_control(self, vehicle: VehicleState, now: float, *, station: int = 0) -> None:
        """Release control: at once as far as we are concerned, and with a command for a vehicle that manages it.

        Our own vehicle gives it to the `station` that has asked for it; with 0 to any that has.
        """
        self._claims.remove(vehicle.system)
        self.send(vehicle, "release control", Command.REQUEST_OPERATOR_CONTROL.name, 0, 0, 0, station, now=now)

    def take_off(self, vehicle: VehicleState, altitude: float | None, now: float) -> None:
        """Take off to an altitude above the ground, m; None: to the one that is set.

        Refused for what does not fly, flies already or is disarmed, and above its altitude fence.
        """
        altitude = self.take_off_altitude if altitude is None else altitude
        why = find_refusal(vehicle, self.take_off_refusal(vehicle.system), now)
        why = why or find_fence_refusal(altitude, self.altitude_fence(vehicle.system))
        if why:
            self._results.add_refusal(vehicle.system, f"take-off: {vehicle.name}: {why}", now)
            return
        params = take_off_params(vehicle, altitude)
        self.send(vehicle, f"take off to {altitude:g} m", Command.NAV_TAKEOFF.name, *params, now=now)

    def cut_motors(self, vehicle: VehicleState, now: float) -> None:
        """Cut the motors of what flies, which falls: the operator has held the key for it."""
        if not vehicle.model.flies:
            self._results.add_refusal(vehicle.system, "cut motors: the emergency stop does that here", now)
            return
        self._cut(vehicle, now)

    def set_mode(self, vehicle: VehicleState, name: str, now: float) -> None:
        """Change the mode to the one of this name (dialects/kinds.py); refused if its kind has no such mode.

        HOLD, and the landing of what flies, is repeated until each sender of its id reports it, or another mode is
        chosen.
        """
        stops = name == HOLD or (vehicle.model.flies and vehicle.model.number_of(name) in _landing(vehicle))
        stop = mode_stop(vehicle, name, StopTimes(now, now, now + STOP_TIMEOUT)) if stops else None
        self._stops.pop((vehicle.system, Command.DO_SET_MODE), None)
        if stop is not None:
            self._begin_stop(stop, now)
        if stop is not None or send_mode(self._client, vehicle, name, now):
            self._results.set_label(vehicle.system, Command.DO_SET_MODE, f"mode {name}")
            return
        why = vehicle.model.refusal or f"it has no mode {name}"
        self._results.add_refusal(vehicle.system, f"mode {name}: {vehicle.name}: {why}", now)

    def emergency_stop(self, vehicle: VehicleState, now: float) -> None:
        """Stop and lock the motors; repeated until the vehicle has done it. One in the air is asked about first.

        What keys fly lands instead; on the ground it is disarmed, which it refuses itself in the air.
        """
        if vehicle.model.flies:
            self._arming = None
            if vehicle.is_landed(now) or not vehicle.armed:
                self.disarm(vehicle, now)
                return
            self._log.add(now, "station", f"EMERGENCY STOP {vehicle.name}: it lands", Severity.EMERGENCY)
            self.set_mode(vehicle, vehicle.model.land, now)
            return
        if vehicle.may_fall and not self._stop_questions.confirms(vehicle.system, now):
            self._log.add(now, "station", f"{vehicle.name} {FALLS}", Severity.CRITICAL)
            return
        self._cut(vehicle, now)

    def _cut(self, vehicle: VehicleState, now: float) -> None:
        self._stop_questions.forget(vehicle.system)
        self._arming = None
        self._log.add(now, "station", f"EMERGENCY STOP {vehicle.name}", Severity.EMERGENCY)
        self._locks[vehicle.system] = EmergencyLock(vehicle, now)
        self.tick(now)

    def stop_blindly(self, now: float, kind: StopKind = StopKind.EMERGENCY, system: int = EVERYBODY) -> None:
        """Stop all vehicles, or one, though not heard: they may hear us without having a place for us."""
        self.blind_stops.begin(kind, system, now)
        self.tick(now)

    def stop_late(self, vehicle: VehicleState, now: float) -> None:
        """Stop a vehicle that is heard after a blind stop."""
        kind = self.blind_stops.hear(vehicle.system)
        if kind is not None and not (kind is StopKind.EMERGENCY and vehicle.system in self._locks):
            self.stop(vehicle, kind, now)

    def stop(self, vehicle: VehicleState, kind: StopKind, now: float) -> None:
        """Stop a vehicle in its own form, until it reports it."""
        if kind is StopKind.EMERGENCY:
            self.emergency_stop(vehicle, now)
        elif kind is StopKind.DISARM:
            self.disarm(vehicle, now)
        else:
            self.set_mode(vehicle, HOLD, now)

    def clear_emergency_stop(self, vehicle: VehicleState, now: float) -> None:
        """Release the lock; it stays until the vehicle has accepted."""
        self.blind_stops.clear()
        if vehicle.system in self._locks or vehicle.emergency_stop:
            self._locks.setdefault(vehicle.system, _answered_lock(vehicle, now)).clear(self._client, now)

    # ---- queries of the station ----

    def request_message(self, vehicle: VehicleState, message_id: int, now: float) -> None:
        """Request one message; the result is not logged."""
        self._send(vehicle, now, Command.REQUEST_MESSAGE, message_id)

    def set_message_interval(self, vehicle: VehicleState, message_id: int, rate: float, now: float) -> None:
        """Request a message at `rate` Hz; the result is not logged."""
        self._send(vehicle, now, Command.SET_MESSAGE_INTERVAL, message_id, round(1e6 / rate))

    def stream_video(self, vehicle: VehicleState, now: float, *, on: bool) -> None:
        """Start or stop all video streams to us; the result is not logged."""
        self._send(vehicle, now, Command.VIDEO_START_STREAMING if on else Command.VIDEO_STOP_STREAMING, 0)

    def pop_query_outcomes(self) -> list[CommandOutcome]:
        """Return the results of the station's own queries since the last call."""
        outcomes, self._query_outcomes = self._query_outcomes, []
        return outcomes

    # ---- state ----

    def is_locked(self, system: int) -> bool:
        """Return whether our emergency stop is active."""
        return system in self._locks

    def emergency_progress(self, system: int, now: float) -> EmergencyProgress | None:
        """Return how far our emergency stop of this vehicle is; None without one."""
        lock = self._locks.get(system)
        return lock.progress(now) if lock else None

    def stop_doubt(self, system: int, now: float) -> str:
        """Return which sender of its id does not show our emergency stop; "" if each does, or without one."""
        lock = self._locks.get(system)
        return lock.doubt(now) if lock else ""

    def stop_question(self, system: int, now: float) -> float | None:
        """Return the s left to press the emergency stop of a vehicle in the air once more; None without a question."""
        return self._stop_questions.left(system, now)

    def is_arming(self, system: int) -> bool:
        """Return whether the vehicle is being armed; neutral demands then go out although it is disarmed."""
        return self._arming is not None and self._arming.vehicle.system == system

    @property
    def busy(self) -> bool:
        """Whether a command is under way or is to be repeated."""
        stopping = self._stops or self._locks or self.blind_stops
        return self._arming is not None or bool(stopping) or self._client.busy

    def is_pending(self, command: Command, vehicle: VehicleState) -> bool:
        """Return whether this vehicle has not acknowledged a command of this kind yet."""
        return self._client.is_waiting(command, vehicle.system)

    def claim(self, vehicle: VehicleState, now: float) -> None:
        """Note that a vehicle has accepted arming from a verb."""
        self._claims.add(vehicle, now, by_arming=True)

    def is_claimed(self, system: int) -> bool:
        """Return whether this vehicle accepted arming or a control request from us and has not disarmed since.

        That counts as control of a vehicle that sends no CONTROL_STATUS.
        """
        return system in self._claims

    def last_refusal(self, system: int, now: float) -> str | None:
        """Return what this vehicle refused last and why, while that may still hold."""
        vehicle = self._vehicles.get(system)
        ready_at = None if vehicle is None else now if vehicle.armed else vehicle.ready_at
        return self._results.last_refusal(system, ready_at, now)

    # ---- time and messages ----

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of a vehicle: a COMMAND_ACK, or what its state shows of our claim."""
        self._claims.update(now)
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def handle_refused(self, message: Message, why: str, now: float) -> None:
        """End the command whose message is not sent, because our role does not allow it."""
        self._client.refuse(message, why)
        self._handle_outcomes(now)

    def handle_statustext(self, system: int, text: str, severity: int, now: float) -> None:
        """Attach a warning of the vehicle to its refusal, which it may explain."""
        self._results.handle_statustext(system, text, severity, now)

    def tick(self, now: float) -> None:
        """Repeat and time out what is in progress."""
        self._claims.update(now)
        for lock in self._locks.values():
            lock.tick(self._client, now)
        self._outbox += self.blind_stops.tick(now, heard=bool(self._vehicles))
        if self._arming is not None:
            self._arming.tick(self._client, now)
            self._end_arming(self._arming, now)
        for stop in self._stops.values():
            stop.tick(self._client, now)
        self._end_stops(now)
        self._client.tick(now)
        self._handle_outcomes(now)

    # ---- results ----

    def _send(self, vehicle: VehicleState, now: float, command: Command, *params: float) -> None:
        system, component = vehicle.system, vehicle.component
        self._vehicles[system] = vehicle
        self._client.send(command, *params, target_system=system, target_component=component, now=now)

    def _begin_stop(self, stop: RepeatedStop, now: float) -> None:
        self._stops[stop.vehicle.system, stop.stop.command] = stop
        self._vehicles[stop.vehicle.system] = stop.vehicle
        stop.tick(self._client, now)

    def _end_stops(self, now: float) -> None:
        """Forget the stops that have ended, and report those without effect; a refusal is reported by its answer."""
        for (system, command), stop in list(self._stops.items()):
            if stop.end is None:
                continue
            del self._stops[system, command]
            label = stop.label
            if stop.end is StopEnd.NOT_DONE:
                self._results.add_refusal(system, f"{label}: {stop.vehicle.name}: {stop.find_doubt(now)}", now)
            elif stop.end is StopEnd.NO_ANSWER:
                self._results.add_refusal(system, f"{label}: no answer", now)

    def _end_arming(self, arming: ArmSequence, now: float) -> None:
        if arming.step is ArmStep.DONE and self._arming is arming:
            self._arming = None
            if arming.failure:
                self._results.add_refusal(arming.vehicle.system, arming.failure, now)

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            if outcome.command in QUERY_COMMANDS:
                self._query_outcomes.append(outcome)
            else:
                self._results.handle_outcome(outcome, now)
                self._apply_outcome(outcome, now)

    def _apply_outcome(self, outcome: CommandOutcome, now: float) -> None:
        system = outcome.target_system
        if _grants_control(outcome):
            by_arming = outcome.command == Command.COMPONENT_ARM_DISARM
            self._claims.add(self._vehicles[system], now, by_arming=by_arming)
        lock = self._locks.get(system)
        if lock is not None:
            lock.handle_outcome(outcome)
            if _released(outcome):
                del self._locks[system]
        if self._arming is not None and self._arming.vehicle.system == system:
            self._arming.handle_outcome(outcome, self._client, now)
            self._end_arming(self._arming, now)
        stop = self._stops.get((system, outcome.command))
        if stop is not None:
            stop.handle_outcome(outcome, now)
            self._end_stops(now)


def _grants_control(outcome: CommandOutcome) -> bool:
    """Return whether this result gives us control of a vehicle that sends no CONTROL_STATUS.

    It does when the vehicle accepts arming or a control request, or does not know control requests.
    """
    if outcome.command == Command.COMPONENT_ARM_DISARM:
        return outcome.params[0] == 1 and outcome.result is Result.ACCEPTED
    requested = outcome.command == Command.REQUEST_OPERATOR_CONTROL and outcome.params[0] == 1
    return requested and outcome.result in (Result.ACCEPTED, Result.UNSUPPORTED)


def _landing(vehicle: VehicleState) -> tuple[int | None, ...]:
    """Return the numbers of the modes that land what flies."""
    return vehicle.model.number_of(vehicle.model.land), vehicle.model.number_of(vehicle.model.home)


def _answered_lock(vehicle: VehicleState, now: float) -> EmergencyLock:
    """Return the lock of a stop that somebody else requested, so that it can be cleared."""
    return EmergencyLock(vehicle, now, switch_answered=True, disarm_answered=True, accepted=True)


def _released(outcome: CommandOutcome) -> bool:
    """Return whether the lock is off: released, or unknown to the vehicle, which is then only disarmed."""
    switched = outcome.command == Command.DO_SET_SAFETY_SWITCH_STATE and outcome.params[0] == DANGEROUS
    return switched and outcome.result in (Result.ACCEPTED, Result.UNSUPPORTED)
