"""Closes a link in order: neutral first to every vehicle behind it that gets demands, then the vehicle is forgotten."""

from __future__ import annotations

from groundstation.station.driving.operator import OperatorSession
from groundstation.station.links.link_stats import LinkStats
from groundstation.vehicles.fleet import Contact, Fleet

CLOSE_WITHIN = 1.0
"""s for the final neutrals, which need 0.25 s; then the link is closed in any case."""


class LinkClosing:
    """The links that the operator closes, by index, until their last neutral is sent."""

    def __init__(self, operator: OperatorSession, fleet: Fleet, links: LinkStats) -> None:
        self._operator = operator
        self._fleet = fleet
        self._links = links
        self._until: dict[int, float] = {}

    def begin(self, link: int, now: float) -> None:
        """Go neutral for the vehicles behind a link; no demand follows."""
        if link < 0:  # it is not open
            return
        self._until.setdefault(link, now + CLOSE_WITHIN)
        for contact in self._behind(link):
            contact.closing = True
            if contact is self._fleet.selected:
                self._operator.reset_demand(now)

    def is_ready(self, link: int, now: float) -> bool:
        """Return whether the link may be closed: the final neutrals are sent, or it takes too long."""
        finished = all(contact.demand_stream.finished for contact in self._behind(link))
        return finished or now >= self._until.get(link, now)

    def end(self, link: int, now: float) -> None:
        """Forget a closed link, and the vehicles that no other link reaches. One that is armed stays on the list."""
        behind = self._behind(link)
        self._links.remove(link)
        self._until.pop(link, None)
        reached = self._links.all_systems
        for contact in behind:
            contact.closing = False
            if contact.state.system not in reached and not contact.state.armed:
                if contact is self._fleet.selected:  # another one is selected in its place
                    self._operator.reset_demand(now)
                self._fleet.forget(contact.state.system, now)

    def _behind(self, link: int) -> list[Contact]:
        """Return the vehicles that are reached through a link."""
        systems = self._links.systems(link)
        return [each for each in self._fleet if each.link == link or each.state.system in systems]
