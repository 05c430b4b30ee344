"""Is a vehicle one of ours? It tells ROVER_* and CONTROL_STATUS only to who has asked for one of them, so we ask.

UNASKED --no ROVER_DRIVE_STATUS comes--> ASKED --accepted, or it comes--> TELLING (or asked again, ever more seldom)
   ^                                       |                                  |
   |                                       +--refused--> FOREIGN              |
   +------------ lost and back, whatever it was -----------+------------------+
"""

from __future__ import annotations

from dialects.enums import Autopilot, Result
from link.services.command.client import CommandOutcome

FOREIGN_AUTOPILOTS = frozenset({Autopilot.ARDUPILOT, Autopilot.PX4})
"""They say in each HEARTBEAT that they are not ours."""

FIRST_RETRY, LONGEST_RETRY = 0.3, 60.0
"""s between two questions, at first and at last: it may not have heard our HEARTBEAT yet, or its answer was lost."""


class DialectProbe:
    """When to ask one vehicle for ROVER_DRIVE_INFO. Repeats of one question are the command protocol's matter."""

    def __init__(self) -> None:
        self._due = 0.0
        self._pause = FIRST_RETRY
        self._refused = False

    def is_due(self, autopilot: int, telling: bool, now: float) -> bool:
        """Is it time to ask? `telling`: its ROVER_DRIVE_STATUS comes. To be called while no question is under way."""
        if telling:
            self._due, self._pause = now, FIRST_RETRY
        return not (telling or self._refused or autopilot in FOREIGN_AUTOPILOTS or now < self._due)

    def handle_outcome(self, outcome: CommandOutcome, now: float) -> None:
        """What became of the question. Whoever says yes and tells nothing is asked again, and so is who is mute."""
        self._refused = outcome.result not in (None, Result.ACCEPTED, Result.TEMPORARILY_REJECTED)
        self._due, self._pause = now + self._pause, min(LONGEST_RETRY, self._pause * 2)
