"""How far a vehicle is with its mission, and the altitude of its home, from its messages."""

from __future__ import annotations

import math

from dialects import messages as m
from link.core import Received

MAX_REACHED = 1000
"""Items kept as reached: more than a mission has."""
FRESH = 3.0
"""s for which NAV_CONTROLLER_OUTPUT is shown: vehicles send it only while they drive by themselves."""
NOT_STARTED, COMPLETE = 2, 5
"""MISSION_STATE."""


class PlanProgress:
    """Sequence numbers are those of the vehicle. `component` is the one that the station talks to."""

    def __init__(self, component: int) -> None:
        self.current: int | None = None
        self.state = 0
        """MISSION_STATE; 0: not reported."""
        self.ids: tuple[int, int, int] | None = None
        """Ids of mission, fence and rally points that the vehicle reports; None: it has no ids."""
        self.home_altitude: float | None = None
        """m above sea level; before HOME_POSITION that of the vehicle."""
        self._reached: list[int] = []
        self._component = component
        self._nav: m.NavControllerOutput | None = None
        self._nav_at = -math.inf
        self._has_home = False

    @property
    def reached(self) -> tuple[int, ...]:
        """Items that were reached since the mission began, in their order."""
        return tuple(sorted(set(self._reached)))

    def nav_output(self, now: float) -> m.NavControllerOutput | None:
        """Return NAV_CONTROLLER_OUTPUT while it is fresh and finite."""
        nav = self._nav if now - self._nav_at <= FRESH else None
        return nav if nav is not None and math.isfinite(nav.xtrack_error) else None

    def restart(self) -> None:
        """Forget what was reached: the mission is another one, or begins anew."""
        self._reached.clear()

    def receive(self, received: Received, now: float) -> None:
        """Handle a message of the vehicle."""
        if received.component != self._component:
            return
        match received.message:
            case m.MissionCurrent() as message:
                self._handle_current(message)
            case m.MissionItemReached() as message if len(self._reached) < MAX_REACHED:
                self._reached.append(message.seq)
            case m.NavControllerOutput() as message:
                self._nav, self._nav_at = message, now
            case m.HomePosition() as message:
                self.home_altitude, self._has_home = message.altitude / 1000, True
            case m.GlobalPositionInt() as message if not self._has_home:
                self.home_altitude = message.alt / 1000

    def _handle_current(self, message: m.MissionCurrent) -> None:
        if message.mission_state == NOT_STARTED and self.state not in (0, NOT_STARTED):
            self.restart()
        began_anew = self.state == COMPLETE and message.mission_state not in (0, COMPLETE)
        if began_anew:
            self.restart()
        if self.current is not None and message.seq < self.current and message.mission_state != COMPLETE:
            self._reached = [seq for seq in self._reached if seq < message.seq]  # jumped back
        self.current, self.state = message.seq, message.mission_state
        ids = (message.mission_id, message.fence_id, message.rally_points_id)
        self.ids = ids if any(ids) or self.ids is not None else None
