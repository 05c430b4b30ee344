"""The stops that a station sends to vehicles that are not heard: to all (system 0), or to one id."""

from __future__ import annotations

import msgspec

from dialects.enums import Severity
from groundstation.vehicles.demand.blind_stop import BlindStop
from groundstation.vehicles.demand.stop_commands import StopKind
from groundstation.vehicles.state.message_log import MessageLog
from link.core import Outgoing, Received

EVERYBODY = 0
"""The system id that means all vehicles."""

BLIND_FOR = 30.0
"""s for which a blind stop is repeated, as one of a verb: a radio link may be cut for some seconds."""

MOST = 32
"""Stops at the same time; a further one to a single vehicle goes to all."""


class _Sent(msgspec.Struct):
    stop: BlindStop
    until: float
    heard: set[int]
    """Vehicles that were heard while it was sent, and have got it in their own form."""


class BlindStops:
    """At most one stop for each system id. `ids` are ours."""

    def __init__(self, ids: tuple[int, int], log: MessageLog) -> None:
        self._ids = ids
        self._log = log
        self._sent: dict[int, _Sent] = {}

    def __bool__(self) -> bool:
        return bool(self._sent)

    def begin(self, kind: StopKind, system: int, now: float) -> None:
        """Begin a stop, or go on with the one that is sent; no weaker one replaces an emergency stop."""
        if len(self._sent) >= MOST and system not in self._sent:
            system = EVERYBODY
        known = self._sent.get(system)
        if known is None or known.stop.kind is not StopKind.EMERGENCY:
            target = f"vehicle {system}" if system else "all vehicles"
            text = f"{kind.value.upper()} sent to {target} (system {system})"
            self._log.add(now, "station", text, Severity.EMERGENCY)
            known = self._sent[system] = _Sent(BlindStop(kind, system, self._ids, now), now, set())
        known.until = now + BLIND_FOR

    def clear(self) -> None:
        """End them all."""
        self._sent.clear()

    def hear(self, system: int) -> StopKind | None:
        """Return the strongest stop that a vehicle has not got in its own form yet, now that it is heard."""
        kinds = []
        for target in (EVERYBODY, system):
            sent = self._sent.get(target)
            if sent is not None and system not in sent.heard:
                sent.heard.add(system)
                kinds.append(sent.stop.kind)
        self._sent.pop(system, None)  # it is heard: its own form goes on
        return next((kind for kind in STRONGEST_FIRST if kind in kinds), None)

    def receive(self, received: Received) -> None:
        """Handle an answer to one of them."""
        for sent in self._sent.values():
            sent.stop.receive(received)

    def tick(self, now: float, *, heard: bool) -> list[Outgoing]:
        """Return what is due; end those that were repeated for BLIND_FOR. `heard`: a vehicle was sent a command."""
        for system, sent in list(self._sent.items()):
            if now >= sent.until:
                self._log.add(now, "station", _describe(sent.stop), Severity.CRITICAL)
                del self._sent[system]
        due = [each.stop.tick(now, heard=heard or bool(each.heard)) for each in self._sent.values()]
        return [Outgoing(message) for messages in due for message in messages]

    def describe(self) -> str:
        """Return what is known of them; "" while none is sent."""
        return "; ".join(_describe(each.stop) for each in self._sent.values())


STRONGEST_FIRST = (StopKind.CUT, StopKind.EMERGENCY, StopKind.DISARM, StopKind.HOLD)


def _describe(stop: BlindStop) -> str:
    return f"{stop.kind.value.upper()} {stop.describe()}"
