"""RepeatedStop: one command that stops a vehicle, sent until its effect is seen. The station and the verbs stop by it.

An answer alone is not an end, and neither is silence. Time is an argument.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, auto

import msgspec

from dialects.enums import Result
from dialects.mode_tables import HOLD
from groundstation.vehicles.demand.stop_commands import DISARM, StopCommand, mode_command, send_stop, shows_mode
from groundstation.vehicles.state.senders import ReportingSender, Senders, is_disarmed
from groundstation.vehicles.state.vehicle_state import VehicleState
from link.services.command.client import CommandClient, CommandOutcome

STOP_RETRY = 0.5
"""s after which disarm and HOLD are repeated while a heartbeat reports that it is not so, as the emergency stop is."""

REJECTED_RETRY = 0.5
"""s between two tries of what the vehicle rejects for the moment."""

TOO_SHORT = "its id was not heard for long enough to know that nobody else has it"


class StopTimes(msgspec.Struct, frozen=True):
    """When a stop began, from when on it may count as done, and until when it is repeated."""

    began: float
    sure_at: float
    """Before that a sender of the same id may not have been heard."""
    until: float


class StopEvidence:
    """Whether a stop is done. What was so before it counts only with a sign that is newer than its beginning."""

    def __init__(self, senders: Senders, shows: Callable[[ReportingSender], bool], began: float) -> None:
        """Begin; `shows` returns whether the last report of a sender of its id shows the effect."""
        self._senders, self._shows, self._began = senders, shows, began
        self._was_done = not senders.find_doubt(began, shows)

    def find_doubt(self, now: float) -> str:
        """Return which sender of its id does not report the effect, "" if each does."""
        return self._senders.find_doubt(now, self._shows, self._began)

    def is_done(self, now: float, *, newer: bool) -> bool:
        """Return whether it is done. `newer`: there is such a sign, an answer or a HEARTBEAT."""
        return (newer or not self._was_done) and not self.find_doubt(now)


class StopEnd(Enum):
    """How a stop ended."""

    DONE = auto()
    """Each sender of the id reports the effect."""
    NOT_DONE = auto()
    """Accepted, but `find_doubt` says who does not report it."""
    NO_ANSWER = auto()
    REFUSED = auto()
    """By the vehicle, or never sent because our role does not allow it: the outcome of the command says which."""


class RepeatedStop:
    """One stop of one vehicle. `end` says how it ended; None while it is repeated."""

    def __init__(
        self,
        vehicle: VehicleState,
        stop: StopCommand,
        shows: Callable[[ReportingSender], bool],
        times: StopTimes,
        label: str,
    ) -> None:
        """Begin; `shows` returns whether a sender reports the effect, `label` names it in the log and in refusals."""
        self.vehicle, self.stop, self.label = vehicle, stop, label
        self.end: StopEnd | None = None
        self._times = times
        self._evidence = StopEvidence(vehicle.senders, shows, times.began)
        self._due = times.began
        self._tries = 0
        self._accepted = False

    def find_doubt(self, now: float) -> str:
        """Return why it does not count as done yet."""
        return self._evidence.find_doubt(now) or TOO_SHORT

    def tick(self, client: CommandClient, now: float) -> None:
        """Repeat, until the vehicle reports the effect."""
        if self.end is not None:
            return
        if now >= self._times.sure_at and self._evidence.is_done(now, newer=self._accepted):
            self._finish(StopEnd.DONE, client)
        elif now >= self._times.until:
            self._finish(StopEnd.NOT_DONE if self._accepted else StopEnd.NO_ANSWER, client)
        elif now >= self._due:
            self._due = now + STOP_RETRY
            send_stop(client, self.vehicle, self.stop, now, attempt=self._tries)
            self._tries += 1

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """Handle an answer: end with a refusal; repeat what was not answered, or rejected for the moment."""
        if outcome.command != self.stop.command or outcome.params[: len(self.stop.params)] != self.stop.params:
            return
        if outcome.result is Result.ACCEPTED:
            self._accepted = True
        elif outcome.result is None:
            self._due = now
        elif outcome.result is Result.TEMPORARILY_REJECTED:
            self._due = now + REJECTED_RETRY
        else:
            self.end = StopEnd.REFUSED

    def _finish(self, end: StopEnd, client: CommandClient) -> None:
        self.end = end
        client.cancel(self.stop.command, self.vehicle.system)


def disarm_stop(vehicle: VehicleState, times: StopTimes) -> RepeatedStop:
    """Return the stop that disarms."""
    return RepeatedStop(vehicle, DISARM, is_disarmed, times, "disarm")


def hold_stop(vehicle: VehicleState, times: StopTimes) -> RepeatedStop | None:
    """Return the change to HOLD, of PX4 to AUTO/LOITER, of ArduCopter to BRAKE; None for a kind that has none."""
    return mode_stop(vehicle, HOLD, times)


def mode_stop(vehicle: VehicleState, name: str, times: StopTimes) -> RepeatedStop | None:
    """Return the change to a mode that stops or lands; None for a kind that has none of this name."""
    command = mode_command(vehicle, name)
    if command is None:
        return None
    return RepeatedStop(vehicle, command, lambda sender: shows_mode(vehicle, sender, name), times, f"mode {name}")
