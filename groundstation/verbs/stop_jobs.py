"""Stops that are repeated until the vehicle has done them: disarm, HOLD, emergency stop. Time is an argument."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import msgspec

from dialects.enums import Command, Result, result_name
from dialects.mode_tables import HOLD
from groundstation.snapshot import EmergencyProgress
from groundstation.station.arming import CONFIRM_WITHIN, send_mode
from groundstation.station.commander import DISARM_RETRY
from groundstation.station.emergency import EmergencyLock
from groundstation.vehicles.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.requests import RequestBook
from groundstation.vehicles.services import VehicleServices
from groundstation.vehicles.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

REJECTED_RETRY = 0.5
"""s between two tries of what the vehicle rejects for the moment."""


@dataclass(slots=True)
class RepeatedCommand:
    """One command until its effect is seen. An answer alone is no end, and neither is silence before `until`."""

    number: int
    command: Command
    send: Callable[[CommandClient, float], None]
    is_done: Callable[[], bool]
    """Whether the vehicle reports the effect."""
    missing: str
    """What it reports otherwise."""
    until: float
    _due: float = 0.0
    _accepted: bool = False
    _was_done: bool = field(init=False)
    """It was so before the first try: then it counts only with an answer."""

    def __post_init__(self) -> None:
        self._was_done = self.is_done()

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Repeat, until the vehicle reports the effect."""
        if self.is_done() and (self._accepted or not self._was_done):
            client.cancel(self.command)
            book.accept(self.number)
        elif now >= self.until:
            self._give_up(client, book, now)
        elif now >= self._due:
            self._due = now + DISARM_RETRY
            self.send(client, now)

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """End with a refusal; repeat what was not answered, or rejected for the moment."""
        if outcome.command != self.command:
            return
        if outcome.number is None:
            self._due = now
        elif outcome.result is Result.ACCEPTED:
            self._accepted = True
        elif outcome.result is Result.TEMPORARILY_REJECTED:
            self._due = now + REJECTED_RETRY
        else:
            book.refuse(self.number, refusal_words(outcome), now)

    def _give_up(self, client: CommandClient, book: RequestBook, now: float) -> None:
        client.cancel(self.command)
        if self._accepted:
            book.refuse(self.number, f"accepted, but its heartbeat reports {self.missing}", now, by_vehicle=False)
        else:
            book.fail(self.number, "after all tries")


def disarm_job(number: int, state: VehicleState, until: float) -> RepeatedCommand:
    """Return the job that disarms."""
    command = Command.COMPONENT_ARM_DISARM

    def send(client: CommandClient, now: float) -> None:
        client.send(command, 0, target_system=state.system, target_component=state.component, now=now)

    return RepeatedCommand(number, command, send, lambda: not state.armed, "armed", until)


def hold_job(number: int, state: VehicleState, services: VehicleServices, until: float) -> RepeatedCommand | RefusedJob:
    """Return the job that changes to HOLD. The number of HOLD means another mode to a kind that is not driven."""
    if state.model.refusal:
        return RefusedJob(number, f"{state.model.refusal}; `mode` takes a mode that it lists, `disarm` ends its power")

    def is_held() -> bool:
        return services.modes.current == state.model.number_of(HOLD)

    def send(client: CommandClient, now: float) -> None:
        send_mode(client, state, HOLD, now)

    return RepeatedCommand(number, Command.DO_SET_MODE, send, is_held, "another mode", until)


class RefusedJob(msgspec.Struct):
    """A stop that a vehicle of this kind has not got, so that nothing is sent."""

    number: int
    why: str

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """End at once."""
        book.refuse(self.number, self.why, now, by_vehicle=False)

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Take nothing: no command is sent."""


class EmergencyJob(msgspec.Struct):
    """The emergency stop, as the station makes it (station/emergency.py)."""

    number: int
    lock: EmergencyLock
    until: float
    _stopped_at: float | None = None

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Repeat, until the vehicle reports that it is disarmed and, if it is of our dialect, locked."""
        self.lock.tick(client, now)
        vehicle = self.lock.vehicle
        if self.lock.accepted and not vehicle.armed:
            self._stopped_at = now if self._stopped_at is None else self._stopped_at
            if vehicle.emergency_stop:
                book.accept(self.number)
            elif vehicle.autopilot in FOREIGN_AUTOPILOTS or now - self._stopped_at > CONFIRM_WITHIN:
                book.accept(self.number, "disarmed; it reports no lock, so that arming is possible")
        elif now >= self.until and self.lock.accepted:
            book.refuse(self.number, "accepted, but its heartbeat reports armed", now, by_vehicle=False)
        elif now >= self.until:
            book.fail(self.number, "after all tries")

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Note an answer. A vehicle that refuses both commands is not stopped."""
        self.lock.handle_outcome(outcome)
        if self.lock.progress(now) is EmergencyProgress.REFUSED and not self.lock.clearing:
            book.refuse(self.number, refusal_words(outcome), now)


def refusal_words(outcome: CommandOutcome) -> str:
    """Return the MAV_RESULT of a refusal, e.g. "FAILED (4)"."""
    number = outcome.number or 0
    return f"{result_name(number).upper().replace(' ', '_')} ({number})"
