"""What becomes of the vehicles that this station armed when the operator quits: disarmed, or named as left armed.

Neutral demands go out first (driving.py). DISARM_AFTER later the vehicles are disarmed, unless the operator quits again
meanwhile. A vehicle that drives itself, or that another ground station has taken over, is left alone.
"""

from __future__ import annotations

from groundstation.station.driving.commander import Commander
from groundstation.station.driving.driving import DrivingController
from groundstation.vehicles.fleet import Contact, Fleet

DISARM_AFTER = 2.0
"""s from quitting to disarming: the vehicle stands by then, and the operator can still decide to leave it armed."""

DISARM_TIMEOUT = 2.0
"""s for the HEARTBEAT to report disarmed: two heartbeats."""


class StationShutdown:
    """The end of the session, as far as vehicles are concerned."""

    def __init__(self, fleet: Fleet, commander: Commander, driving: DrivingController) -> None:
        self._fleet = fleet
        self._commander = commander
        self._driving = driving
        self._disarm_at: float | None = None
        self._wait_until: float | None = None

    def begin(self, now: float, *, disarm: bool) -> None:
        """Quit. `disarm`: disarm what this station armed; a later call without it leaves the vehicles armed."""
        self._wait_until = None
        self._disarm_at = now + DISARM_AFTER if disarm and self._to_disarm() else None

    def tick(self, now: float) -> None:
        """Disarm when it is due, then wait for the heartbeats."""
        if self._disarm_at is not None and now >= self._disarm_at:
            self._disarm_at, self._wait_until = None, now + DISARM_TIMEOUT
            for contact in self._to_disarm():
                self._commander.disarm(contact.state, now)
        elif self._wait_until is not None and (now >= self._wait_until or not self._to_disarm()):
            self._wait_until = None

    @property
    def finished(self) -> bool:
        """Nothing is left to disarm or to wait for."""
        return self._disarm_at is None and self._wait_until is None

    def left_armed(self, now: float) -> tuple[str, ...]:
        """Return one line for each vehicle that this station would leave armed if it ended now."""
        return tuple(_describe(contact, now) for contact in self._left())

    def end_armed(self, simulated: frozenset[int], now: float) -> tuple[str, ...]:
        """Return the lines of those among them that end with this station: its simulators, which have these ids."""
        return tuple(
            _describe(contact, now)
            for contact in self._left()
            if contact.state.system in simulated and contact.state.senders.is_one_of_here(now)
        )

    def _left(self) -> list[Contact]:
        return [contact for contact in self._fleet if contact.ours and contact.state.armed]

    def _to_disarm(self) -> list[Contact]:
        return [contact for contact in self._fleet if contact.ours and self._may_disarm(contact)]

    def _may_disarm(self, contact: Contact) -> bool:
        state = contact.state
        no_other = state.driver == 0 or self._driving.is_in_control(contact)
        return state.armed and no_other and not state.drives_itself and not state.may_fall


def _describe(contact: Contact, now: float) -> str:
    state = contact.state
    lost = "" if state.monitor.is_alive(now) else f" (no heartbeat for {state.monitor.silence(now):.0f} s)"
    return f"{state.name} is left ARMED in {state.mode}{lost}"
