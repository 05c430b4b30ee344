"""Attention: which vehicles the station looks at. Of the others a little of their telemetry is enough.

A link of a fleet asks them for less (link/fleet/brevity.py): a table of a hundred vehicles needs neither their attitude
nor ten positions a second.
"""

from __future__ import annotations

from collections.abc import Iterator

from groundstation.station.core_listener import CoreListener
from groundstation.station.relay.verb_relay import VerbRelay
from groundstation.vehicles.fleet import Contact, Fleet


class Attention:
    """Says what is looked at: what is shown, driven or asked for something."""

    def __init__(self, fleet: Fleet, relay: VerbRelay, listener: CoreListener) -> None:
        self._fleet, self._relay, self._listener = fleet, relay, listener

    @property
    def systems(self) -> frozenset[int] | None:
        """System ids; None while a verb is connected, which gets what all vehicles send."""
        return None if self._relay.busy else self._listener.systems.union(self._find())

    def _find(self) -> Iterator[int]:
        yield from (each.state.system for each in self._fleet if self._is_busy(each))

    def _is_busy(self, contact: Contact) -> bool:
        return (
            contact is self._fleet.selected
            or contact.ours
            or not contact.demand_stream.finished
            or (contact.services is not None and bool(contact.services.book.running))
        )
