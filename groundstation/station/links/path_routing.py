"""Sends each message over the paths that it belongs to, where a vehicle is heard on several.

Over all of them: stops, demands with proofs (the vehicle takes the newest and drops copies), what is for everybody, and
what asks for messages and rates, which each path has of its own. Over one: demands of a vehicle that knows no proofs,
and all other commands, parameters, plans, files and logs; those over the next one without an answer. MANUAL_CONTROL
beside proofs, which moves nothing, goes over the best one.
"""

from __future__ import annotations

from dialects import messages as m
from dialects.traits import ACKED, DEMANDS, is_stop, only_asks
from groundstation.vehicles.fleet import Contact, Fleet
from link.core import Outgoing

_STREAM_REQUESTS = (m.RequestDataStream,)
_SETPOINTS = frozenset(
    each.id for each in (m.SetPositionTargetLocalNed, m.SetPositionTargetGlobalInt, m.SetAttitudeTarget)
)


class PathRouting:
    """Chooses paths for what the station sends."""

    def __init__(self, fleet: Fleet) -> None:
        self._fleet = fleet

    def route(self, outgoing: Outgoing, now: float) -> Outgoing:
        """Return a message with the peers that it goes to; unchanged if it goes to all."""
        if outgoing.peer is not None or outgoing.among is not None:
            return outgoing
        message = outgoing.message
        contact = self._fleet.get(m.target_system(message))
        if contact is None or not contact.state.paths.has_several:
            return outgoing
        number = type(message).id
        if number in DEMANDS:
            return self._route_demand(outgoing, contact, now)
        goes_once = number in ACKED or number in _SETPOINTS
        if not goes_once or is_stop(message) or only_asks(message) or isinstance(message, _STREAM_REQUESTS):
            return outgoing
        paths = contact.state.paths
        live = paths.live(now)
        if len(live) < 2 or self._may_be_two(contact, now):
            return outgoing  # each must get it
        return Outgoing(message, paths.questions.choose(live, now).peer)

    @staticmethod
    def _may_be_two(contact: Contact, now: float) -> bool:
        """Return whether the paths lead to two vehicles with one id, or perhaps do."""
        return contact.state.paths.apart or contact.state.senders.differ(now)

    @staticmethod
    def _route_demand(outgoing: Outgoing, contact: Contact, now: float) -> Outgoing:
        paths = contact.state.paths
        carrier = paths.carrier.path
        if contact.state.has_rover_dialect:
            # Its driver has a session: then MANUAL_CONTROL moves nothing (docs/safety.md), and one path is enough.
            moves = not contact.state.control.session or not isinstance(outgoing.message, m.ManualControl)
            best = paths.best
            if moves or best is None or not best.is_live(now) or PathRouting._may_be_two(contact, now):
                return outgoing
            return Outgoing(outgoing.message, best.peer)
        if carrier is None or paths.apart:
            return outgoing
        return Outgoing(outgoing.message, carrier.peer)
