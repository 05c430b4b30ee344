"""Whether parameters, plans, files and logs wait: on a slow line they would delay the demands of a driver."""

from __future__ import annotations

from groundstation.station.driving.operator import OperatorSession
from groundstation.station.links.link_stats import LinkStats
from groundstation.vehicles.fleet import Contact, Fleet

SLOW_LINE = 20_000.0
"""Bytes/s below which transfers wait while the operator drives: a telemetry radio has 5.8 k, 115200 baud 11.5 k."""


class TransferHold:
    """Knows the lines and the operator's hands."""

    def __init__(self, fleet: Fleet, operator: OperatorSession, links: LinkStats) -> None:
        self._fleet = fleet
        self._operator = operator
        self._links = links

    def is_held(self, contact: Contact, now: float) -> bool:
        """Return whether the transfers of a vehicle wait: the operator drives over the same, slow line."""
        selected = self._fleet.selected
        if selected is None or selected.link != contact.link or self._operator.demand(now).neutral:
            return False
        capacity = self._links.capacity(contact.link)
        return capacity is not None and capacity < SLOW_LINE
