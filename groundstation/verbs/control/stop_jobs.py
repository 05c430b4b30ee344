"""Stops that are repeated until the vehicle has done them: disarm, HOLD, emergency stop. Time is an argument."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from dialects.enums import Command, Result, result_token
from groundstation.snapshot import EmergencyProgress
from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.station.driving.commander import STOP_RETRY
from groundstation.station.driving.emergency import EmergencyLock
from groundstation.vehicles.demand.stop_commands import DISARM, hold_command, send_stop, shows_hold
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

LOCKED = "disarmed, and locked by its safety switch; `estop --clear` releases it"
UNLOCKED = "disarmed; it reports no lock, so that arming is possible"
"""What an emergency stop has done to a vehicle that does not report it: ArduPilot locks its motors without a word."""

TOO_SHORT = "its id was not heard for long enough to know that nobody else has it"

REJECTED_RETRY = 0.5
"""s between two tries of what the vehicle rejects for the moment."""


class StopTimes(msgspec.Struct, frozen=True):
    """When a stop began, from when on it may count as done, and until when it is repeated."""

    began: float
    sure_at: float
    """Before that a sender of the same id may not have been heard."""
    until: float


class StopEvidence:
    """Whether a stop is done. What was so before it counts only with a sign that is newer than its beginning."""

    def __init__(self, find_doubt: Callable[[float], str], began: float) -> None:
        """`find_doubt` takes the time; returns which sender of its id does not report the effect, "" if each does."""
        self.find_doubt = find_doubt
        self._was_done = not find_doubt(began)

    def is_done(self, now: float, *, newer: bool) -> bool:
        """Return whether it is done. `newer`: there is such a sign, an answer or a HEARTBEAT."""
        return (newer or not self._was_done) and not self.find_doubt(now)


@dataclass(slots=True)
class RepeatedCommand:
    """One command until its effect is seen. An answer alone is not an end, and neither is silence before `until`."""

    number: int
    command: Command
    send: Callable[[CommandClient, float, int], None]
    """Takes the client, the time, and the number of tries before."""
    evidence: StopEvidence
    times: StopTimes
    _due: float = 0.0
    _tries: int = 0
    _accepted: bool = False

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Repeat, until the vehicle reports the effect."""
        if now >= self.times.sure_at and self.evidence.is_done(now, newer=self._accepted):
            client.cancel(self.command)
            book.accept(self.number)
        elif now >= self.times.until:
            self._give_up(client, book, now)
        elif now >= self._due:
            self._due = now + STOP_RETRY
            self.send(client, now, self._tries)
            self._tries += 1

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
            doubt = self.evidence.find_doubt(now) or TOO_SHORT
            book.refuse(self.number, f"accepted, but {doubt}", now, by_vehicle=False)
        else:
            book.fail(self.number, "after all tries")


def disarm_job(number: int, state: VehicleState, times: StopTimes) -> RepeatedCommand:
    """Return the job that disarms."""

    def send(client: CommandClient, now: float, tries: int) -> None:
        send_stop(client, state, DISARM, now, attempt=tries)

    evidence = StopEvidence(state.senders.find_doubt, times.began)
    return RepeatedCommand(number, DISARM.command, send, evidence, times)


def hold_job(number: int, state: VehicleState, times: StopTimes) -> RepeatedCommand | RefusedJob:
    """Return the job that changes to HOLD. The number of HOLD means another mode to a kind that is not driven."""
    hold = hold_command(state)
    if state.model.refusal or hold is None:
        return RefusedJob(number, f"{state.model.refusal}; `mode` takes a mode that it lists, `disarm` ends its power")

    def send(client: CommandClient, now: float, tries: int) -> None:
        send_stop(client, state, hold, now, attempt=tries)

    evidence = StopEvidence(lambda now: find_hold_doubt(state, now), times.began)
    return RepeatedCommand(number, Command.DO_SET_MODE, send, evidence, times)


def find_hold_doubt(state: VehicleState, now: float) -> str:
    """Return which sender of its id does not report HOLD; "" if each does."""
    return state.senders.find_doubt(now, lambda sender: shows_hold(state, sender))


class RefusedJob(msgspec.Struct):
    """A stop that a vehicle of this kind has not got, so that nothing is sent."""

    number: int
    why: str

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """End at once."""
        book.refuse(self.number, self.why, now, by_vehicle=False)

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Ignore acknowledgements: no command is sent."""


class EmergencyJob(msgspec.Struct):
    """The emergency stop, as the station makes it (station/driving/emergency.py)."""

    number: int
    lock: EmergencyLock
    times: StopTimes
    _stopped_at: float | None = None

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Repeat, until the vehicle reports that it is disarmed and, if it is of our dialect, locked."""
        self.lock.tick(client, now)
        vehicle, doubt = self.lock.vehicle, self.lock.doubt(now)
        if self.lock.accepted and not doubt and now >= self.times.sure_at:
            self._stopped_at = now if self._stopped_at is None else self._stopped_at
            waited = now - self._stopped_at
            if vehicle.emergency_stop:
                book.accept(self.number)
            elif (vehicle.autopilot in FOREIGN_AUTOPILOTS and self.lock.switch_answered) or waited > CONFIRM_WITHIN:
                book.accept(self.number, LOCKED if self.lock.switched else UNLOCKED)
        elif now >= self.times.until and self.lock.accepted:
            book.refuse(
                self.number, f"accepted, but {doubt or 'it was not heard for long enough'}", now, by_vehicle=False
            )
        elif now >= self.times.until:
            book.fail(self.number, "after all tries")

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Note an answer. A vehicle that refuses both commands is not stopped."""
        self.lock.handle_outcome(outcome)
        if self.lock.progress(now) is EmergencyProgress.REFUSED and not self.lock.clearing:
            book.refuse(self.number, refusal_words(outcome), now)


def refusal_words(outcome: CommandOutcome) -> str:
    """Return the MAV_RESULT of a refusal, e.g. "FAILED (4)"."""
    number = outcome.number or 0
    return f"{result_token(number)} ({number})"
