"""Finds out whether a vehicle speaks our dialect, by requesting ROVER_DRIVE_INFO.

Our rover sends ROVER_* and CONTROL_STATUS only to ground stations that have requested one of them.

UNKNOWN --no ROVER_DRIVE_STATUS--> REQUESTED --accepted, or it arrives--> SENDING (else requested ever less often)
   ^                                  |                                     |
   |                                  +--refused--> FOREIGN                 |
   +---------- lost and back, from any state ----------+--------------------+
"""

from __future__ import annotations

from dialects.enums import Autopilot, Result
from link.services.command.client import CommandOutcome

FOREIGN_AUTOPILOTS = frozenset({Autopilot.ARDUPILOT, Autopilot.PX4})
"""Autopilots whose HEARTBEAT shows that the vehicle is not one of ours."""

FIRST_RETRY, LONGEST_RETRY = 0.3, 60.0
"""First and longest time between requests, s: the vehicle may not have received our HEARTBEAT yet, or its answer got
lost."""


class DialectProbe:
    """When to request ROVER_DRIVE_INFO from one vehicle. Repeats of one request are made by the command protocol."""

    def __init__(self) -> None:
        self._due = 0.0
        self._pause = FIRST_RETRY
        self._refused = self._asked = False
        self.foreign = False
        """It has refused, or not answered the newest request: nobody need wait for our dialect."""

    def is_due(self, autopilot: int, sending: bool, now: float) -> bool:
        """Return whether a request is to be sent now. `sending`: ROVER_DRIVE_STATUS is arriving.

        Call only while no request is pending, and send it if it is due.
        """
        if sending:
            self._due, self._pause = now, FIRST_RETRY
        self._asked = not (sending or self._refused or autopilot in FOREIGN_AUTOPILOTS or now < self._due)
        return self._asked

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """Record how a request ended. Without an answer, or accepted without effect, it is sent again later.

        The end of one that was sent for another probe says nothing here: this one asks by itself.
        """
        if not self._asked:
            return
        self._refused = outcome.result not in (None, Result.ACCEPTED, Result.TEMPORARILY_REJECTED)
        self.foreign = self._refused or outcome.result is None
        self._due, self._pause = now + self._pause, min(LONGEST_RETRY, self._pause * 2)
