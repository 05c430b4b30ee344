"""Stops that are repeated until the vehicle has done them: disarm, HOLD, emergency stop. Time is an argument."""

from __future__ import annotations

import msgspec

from dialects.enums import result_token
from groundstation.snapshot import EmergencyProgress
from groundstation.station.driving.arming import CONFIRM_WITHIN
from groundstation.station.driving.stops.emergency import EmergencyLock
from groundstation.vehicles.demand.repeated_stop import (
    RepeatedStop,
    StopEnd,
    StopTimes,
    disarm_stop,
    hold_stop,
    mode_stop,
)
from groundstation.vehicles.probes.dialect_probe import FOREIGN_AUTOPILOTS
from groundstation.vehicles.requests.requests import RequestBook
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

LOCKED = "disarmed, and locked by its safety switch; `estop --clear` releases it"
UNLOCKED = "disarmed; it reports no lock, so that arming is possible"
"""What an emergency stop has done to a vehicle that does not report it: ArduPilot locks its motors without a word."""


class StopJob(msgspec.Struct):
    """A disarm or HOLD, as the station repeats it (vehicles/demand/repeated_stop.py)."""

    number: int
    stop: RepeatedStop
    detail: str = ""
    """What it has done, where that is not what the verb is called."""

    def tick(self, client: CommandClient, book: RequestBook, now: float) -> None:
        """Repeat, until the vehicle reports the effect."""
        self.stop.tick(client, now)
        if self.stop.end is StopEnd.DONE:
            book.accept(self.number, self.detail)
        elif self.stop.end is StopEnd.NOT_DONE:
            book.refuse(self.number, f"accepted, but {self.stop.find_doubt(now)}", now, by_vehicle=False)
        elif self.stop.end is StopEnd.NO_ANSWER:
            book.fail(self.number, "after all tries")

    def handle_outcome(self, outcome: CommandOutcome, client: CommandClient, book: RequestBook, now: float) -> None:
        """Note an answer; end with a refusal."""
        self.stop.handle_outcome(outcome, now)
        if self.stop.end is StopEnd.REFUSED:
            book.refuse(self.number, refusal_words(outcome), now, answer=outcome.number)


def disarm_job(number: int, state: VehicleState, times: StopTimes) -> StopJob:
    """Return the job that disarms."""
    return StopJob(number, disarm_stop(state, times))


def hold_job(number: int, state: VehicleState, times: StopTimes) -> StopJob | RefusedJob:
    """Return the job that changes to HOLD. The number of HOLD means another mode to a kind that is not driven."""
    hold = hold_stop(state, times)
    if state.model.refusal or hold is None:
        return RefusedJob(number, f"{state.model.refusal}; `mode` takes a mode that it lists, `disarm` ends its power")
    return StopJob(number, hold)


def cut_job(number: int, state: VehicleState, times: StopTimes) -> EmergencyJob:
    """Return the emergency stop that ends the power of every vehicle; what flies falls."""
    return EmergencyJob(number, EmergencyLock(state, times.began), times)


def emergency_job(number: int, state: VehicleState, times: StopTimes) -> EmergencyJob | StopJob:
    """Return the emergency stop of this vehicle: what flies lands, and is disarmed on the ground.

    What would fall and has no mode that lands it is only disarmed, which it refuses in the air.
    """
    if not state.model.falls:
        return cut_job(number, state, times)
    if not state.model.flies:
        return disarm_job(number, state, times)
    landing = None if state.is_landed(times.began) else mode_stop(state, state.model.land, times)
    if landing is None or not state.armed:
        return disarm_job(number, state, times)
    return StopJob(number, landing, "it lands; `estop --cut` cuts its motors, and it falls")


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
            book.refuse(self.number, refusal_words(outcome), now, answer=outcome.number)


def refusal_words(outcome: CommandOutcome) -> str:
    """Return the MAV_RESULT of a refusal, e.g. "FAILED (4)"."""
    number = outcome.number or 0
    return f"{result_token(number)} ({number})"
