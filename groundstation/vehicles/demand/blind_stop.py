"""A stop for vehicles that were not heard: sent again and again, to a system id or to all. Time is an argument.

A vehicle that has no place for us sends us nothing, and one that was switched on just now has not sent its HEARTBEAT
yet; both obey a stop. Nobody knows whether it flies, so that no stop but CUT lets one in the air fall.
COMMAND_LONG and COMMAND_INT alternate, because a vehicle may take one of them only.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.command_places import to_command_int
from dialects.enums import Result, result_name
from groundstation.vehicles.demand.stop_commands import BLIND, BLIND_LATER, StopCommand, StopKind
from link.core import Received

PERIOD = 0.15
"""s between two tries: at 30 % loss six tries of one command fail once in 1400 times within 1 s."""

LATER = 1.2
"""s in which a vehicle that sends would have been heard: a heartbeat interval and a delay."""


class BlindStop:
    """One stop. `system` is the id of the vehicle, 0 for all; `ids` are ours."""

    def __init__(self, kind: StopKind, system: int, ids: tuple[int, int], now: float) -> None:
        self.kind = kind
        self.system = system
        self.tries = 0
        self.answers: dict[int, dict[int, int]] = {}
        """System id -> command -> MAV_RESULT of the newest answer."""
        self._ids = ids
        self._began = now
        self._due = -math.inf

    def tick(self, now: float, *, heard: bool = False) -> list[m.Message]:
        """Return what is due. `heard`: a vehicle was heard, which gets the stop in its own form besides."""
        if now < self._due:
            return []
        self._due = now + PERIOD
        later = () if heard or now - self._began < LATER else BLIND_LATER.get(self.kind, ())
        self.tries += 1
        return [self._message(stop) for stop in (*BLIND[self.kind], *later)]

    def receive(self, received: Received) -> None:
        """Handle a COMMAND_ACK; other messages are ignored."""
        message = received.message
        if not isinstance(message, m.CommandAck) or message.target_system not in (0, self._ids[0]):
            return
        if any(message.command == each.command for each in (*BLIND[self.kind], *BLIND_LATER.get(self.kind, ()))):
            self.answers.setdefault(received.system, {})[message.command] = message.result

    def describe(self) -> str:
        """Return what is known: how often it was sent, and who has answered."""
        target = f"vehicle {self.system}" if self.system else "all vehicles"
        sent = f"sent {self.tries} times to {target} (system {self.system})"
        if not self.answers:
            return f"{sent}, no answer: not known whether it has arrived"
        answers = ", ".join(f"vehicle {system} has {_best(found)}" for system, found in sorted(self.answers.items()))
        return f"{sent}; {answers}, but no heartbeat tells whether it is done"

    def _message(self, stop: StopCommand) -> m.Message:
        params = (*stop.params, *(0.0,) * (7 - len(stop.params)))
        message = m.CommandLong(self.system, 0, stop.command, 0, *params)
        return (to_command_int(message) if self.tries % 2 == 0 else None) or message


def _best(results: dict[int, int]) -> str:
    """Return in words what a vehicle has answered to several commands: it has accepted if it has accepted one."""
    if Result.ACCEPTED in results.values():
        return "accepted"
    return f"answered {result_name(next(iter(results.values())))}"
