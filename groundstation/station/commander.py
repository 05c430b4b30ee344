"""The operator's orders to vehicles: sent, repeated, answered, and their answers put into words. Not the demands."""

from __future__ import annotations

from dataclasses import dataclass

from dialects.enums import Command, Result, Severity, result_name
from dialects.modes import Mode
from groundstation.station.arming import ArmSequence, ArmStep, send_mode
from groundstation.station.emergency import DANGEROUS, EmergencyLock
from groundstation.vehicles.message_log import MessageLog
from groundstation.vehicles.vehicle_state import VehicleState
from link.core import Outgoing, Received
from link.services.command.client import CommandClient, CommandOutcome

REASON_WITHIN = 1.0
"""s between a refusal and the vehicle's text that says why; either may come first."""

QUERY_COMMANDS = (Command.REQUEST_MESSAGE, Command.SET_MESSAGE_INTERVAL)
"""Commands that the station sends by itself: their answers are not told to the operator."""

DISARM_AGAIN, DISARM_GIVE_UP = 1.5, 6.0
"""s after which a heartbeat that still says armed makes us ask again, and after which we say so instead."""


@dataclass(slots=True)
class _Disarm:
    vehicle: VehicleState
    due: float
    until: float


class Commander:
    """Orders for all vehicles. `system` and `component` are ours."""

    def __init__(self, log: MessageLog, system: int, component: int) -> None:
        self.claimed: set[int] = set()
        """Vehicles that do not tell who is in control, and that obeyed us when we armed or asked."""
        self._system = system
        self._log = log
        self._client = CommandClient(system, component)
        self._arming: ArmSequence | None = None
        self._disarms: dict[int, _Disarm] = {}
        self._locks: dict[int, EmergencyLock] = {}
        self._refusals: dict[int, tuple[str, float]] = {}
        self._reasons: dict[int, tuple[str, float]] = {}
        self._modes: dict[int, str] = {}
        self._quiet: list[CommandOutcome] = []

    # ---- orders ----

    def arm(self, vehicle: VehicleState, now: float) -> None:
        """Neutral, MANUAL where it stands in HOLD, then arm."""
        if vehicle.system in self._locks or vehicle.emergency_stop:
            self._refuse(vehicle.system, "arm: the emergency stop is on, clear it first", now)
            return
        self._disarms.pop(vehicle.system, None)
        self._modes[vehicle.system] = Mode.MANUAL.name
        self._arming = ArmSequence.start(vehicle, now)

    def disarm(self, vehicle: VehicleState, now: float) -> None:
        """Disarm, and look whether it became true: the answer to an earlier arming may come in between."""
        self._arming = None
        self._disarms[vehicle.system] = _Disarm(vehicle, now + DISARM_AGAIN, now + DISARM_GIVE_UP)
        self._send(vehicle, now, Command.COMPONENT_ARM_DISARM, 0)

    def set_mode(self, vehicle: VehicleState, name: str, now: float) -> None:
        """Ask for a mode by its name."""
        try:
            send_mode(self._client, vehicle, Mode[name], now)
        except (KeyError, ValueError):
            self._refuse(vehicle.system, f"{vehicle.name} has no mode {name}", now)
        else:
            self._modes[vehicle.system] = name

    def request_control(self, vehicle: VehicleState, now: float) -> None:
        """Ask to be the ground station in control; later requests of others are granted without asking us."""
        self._send(vehicle, now, Command.REQUEST_OPERATOR_CONTROL, 1, 1)

    def request_message(self, vehicle: VehicleState, message_id: int, now: float) -> None:
        """Ask for one message, silently."""
        self._send(vehicle, now, Command.REQUEST_MESSAGE, message_id)

    def set_message_interval(self, vehicle: VehicleState, message_id: int, rate: float, now: float) -> None:
        """Ask for a message `rate` times a second, silently."""
        self._send(vehicle, now, Command.SET_MESSAGE_INTERVAL, message_id, round(1e6 / rate))

    def emergency_stop(self, vehicle: VehicleState, now: float) -> None:
        """Motors off and locked; asked for until it is true."""
        self._arming = None
        self._log.add(now, "station", f"EMERGENCY STOP {vehicle.name}", Severity.EMERGENCY)
        self._locks[vehicle.system] = EmergencyLock(vehicle, now)
        self.tick(now)

    def clear_emergency_stop(self, vehicle: VehicleState, now: float) -> None:
        """Release the lock; it stays until the vehicle has agreed."""
        if vehicle.system in self._locks or vehicle.emergency_stop:
            self._locks.setdefault(vehicle.system, EmergencyLock(vehicle, now, True, True)).clear(self._client, now)

    # ---- what the station asks ----

    def is_locked(self, system: int) -> bool:
        """Is our emergency stop on?"""
        return system in self._locks

    def is_arming(self, system: int) -> bool:
        """Is the vehicle being armed? Then neutral demands go out although it is disarmed."""
        return self._arming is not None and self._arming.vehicle.system == system

    def is_pending(self, command: Command, vehicle: VehicleState) -> bool:
        """Is a command of this kind not answered yet by this vehicle?"""
        return self._client.is_waiting(command, vehicle.system)

    def pop_query_outcomes(self) -> list[CommandOutcome]:
        """How the station's own questions ended, since the last call."""
        quiet, self._quiet = self._quiet, []
        return quiet

    def last_refusal(self, system: int) -> str | None:
        """What this vehicle refused last and why."""
        refusal = self._refusals.get(system)
        return refusal[0] if refusal else None

    # ---- time and messages ----

    def receive(self, received: Received, now: float) -> None:
        """Take an acknowledgement."""
        self._client.receive(received, now)
        self._handle_outcomes(now)

    def handle_statustext(self, system: int, text: str, severity: int, now: float) -> None:
        """A vehicle said something: it may be the reason of a refusal."""
        if severity > Severity.WARNING:
            return
        self._reasons[system] = (text, now)
        refusal = self._refusals.get(system)
        if refusal is not None and now - refusal[1] <= REASON_WITHIN and ": " not in refusal[0]:
            self._refusals[system] = (f"{refusal[0]}: {text}", refusal[1])

    def tick(self, now: float) -> None:
        """Go on with what is under way."""
        for lock in self._locks.values():
            lock.tick(self._client, now)
        if self._arming is not None:
            self._arming.tick(self._client, now)
            self._end_arming(self._arming, now)
        for disarm in list(self._disarms.values()):
            self._retry_disarm(disarm, now)
        self._client.tick(now)
        self._handle_outcomes(now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        return self._client.messages_to_send()

    # ---- inside ----

    def _send(self, vehicle: VehicleState, now: float, command: Command, *params: float) -> None:
        system, component = vehicle.system, vehicle.component
        self._client.send(command, *params, target_system=system, target_component=component, now=now)

    def _retry_disarm(self, disarm: _Disarm, now: float) -> None:
        vehicle = disarm.vehicle
        if not vehicle.armed:
            del self._disarms[vehicle.system]
        elif now >= disarm.until:
            del self._disarms[vehicle.system]
            self._refuse(vehicle.system, f"disarm: {vehicle.name} still says armed", now)
        elif now >= disarm.due and not self.is_pending(Command.COMPONENT_ARM_DISARM, vehicle):
            disarm.due = now + DISARM_AGAIN
            self._send(vehicle, now, Command.COMPONENT_ARM_DISARM, 0)

    def _end_arming(self, arming: ArmSequence, now: float) -> None:
        if arming.step is ArmStep.DONE and self._arming is arming:
            self._arming = None
            if arming.failure:
                self._refuse(arming.vehicle.system, arming.failure, now)

    def _handle_outcomes(self, now: float) -> None:
        for outcome in self._client.outcomes():
            if outcome.command in QUERY_COMMANDS:
                self._quiet.append(outcome)
            else:
                self._log_outcome(outcome, now)
                self._apply_outcome(outcome, now)

    def _apply_outcome(self, outcome: CommandOutcome, now: float) -> None:
        system = outcome.target_system
        if _grants_control(outcome):
            self.claimed.add(system)
        lock = self._locks.get(system)
        if lock is not None:
            lock.handle_outcome(outcome)
            if _released(outcome):
                del self._locks[system]
        if self._arming is not None and self._arming.vehicle.system == system:
            self._arming.handle_outcome(outcome, self._client, now)
            self._end_arming(self._arming, now)
        if outcome.command == Command.COMPONENT_ARM_DISARM and outcome.result is not Result.ACCEPTED:
            self._disarms.pop(system, None)  # refused or unanswered, and the operator has been told

    def _log_outcome(self, outcome: CommandOutcome, now: float) -> None:
        what = self._label(outcome)
        if outcome.result is Result.ACCEPTED:
            self._refusals.pop(outcome.target_system, None)
            self._log.add(now, "ack", f"{what} accepted", Severity.INFO)
        elif outcome.number is None:
            self._refuse(outcome.target_system, f"{what}: no answer", now)
        else:
            self._refuse(outcome.target_system, f"{what} {result_name(outcome.number)}", now)

    def _refuse(self, system: int, text: str, now: float) -> None:
        self._log.add(now, "ack", text, Severity.WARNING)
        reason = self._reasons.get(system)
        if reason is not None and now - reason[1] <= REASON_WITHIN and ": " not in text:
            text = f"{text}: {reason[0]}"
        self._refusals[system] = (text, now)

    def _label(self, outcome: CommandOutcome) -> str:
        first = outcome.params[0]
        match outcome.command:
            case Command.COMPONENT_ARM_DISARM:
                return "arm" if first == 1 else "disarm"
            case Command.DO_SET_SAFETY_SWITCH_STATE:
                return "clear emergency stop" if first == DANGEROUS else "emergency stop"
            case Command.DO_SET_MODE:
                return f"mode {self._modes.get(outcome.target_system, '?')}"
            case Command.REQUEST_OPERATOR_CONTROL:
                return "request control"
            case _:
                return f"command {outcome.command}"


def _grants_control(outcome: CommandOutcome) -> bool:
    """Arming by us, or asking where nobody keeps control, is the claim on a vehicle that does not tell."""
    if outcome.command == Command.COMPONENT_ARM_DISARM:
        return outcome.params[0] == 1 and outcome.result is Result.ACCEPTED
    asked = outcome.command == Command.REQUEST_OPERATOR_CONTROL
    return asked and outcome.result in (Result.ACCEPTED, Result.UNSUPPORTED)


def _released(outcome: CommandOutcome) -> bool:
    """The lock is off, or the vehicle does not know of locks and being disarmed is all there is."""
    switched = outcome.command == Command.DO_SET_SAFETY_SWITCH_STATE and outcome.params[0] == DANGEROUS
    return switched and outcome.result in (Result.ACCEPTED, Result.UNSUPPORTED)
