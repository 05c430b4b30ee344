"""The parameter protocol over Params: list and read; setting is refused. One list run a peer, a few values a cycle."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import ParamFault, Severity
from link.core import Outgoing, Peer, Received
from vehicle.params import TABLE, Params
from vehicle.texts import Texts

REAL32 = 9
"""MAV_PARAM_TYPE_REAL32: the only type that every ground station decodes alike."""
NO_INDEX = m.UINT16_MAX
MAX_RUNS = 8
"""Peers that may be listed to at once: as many as a link has."""
_INDEX = {parameter.name: index for index, parameter in enumerate(TABLE)}


class ParamService:
    """Answers for one system and component."""

    def __init__(self, params: Params, texts: Texts, system: int, component: int) -> None:
        self._params = params
        self._texts = texts
        self._ids = (system, component)
        self._runs: dict[Peer, int] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing where it is not for us or its sender has shown no HEARTBEAT."""
        message = received.message
        if not isinstance(message, m.ParamRequestList | m.ParamRequestRead | m.ParamSet) or not received.introduced:
            return []
        if message.target_system != self._ids[0] or message.target_component not in (0, self._ids[1]):
            return []
        if isinstance(message, m.ParamRequestList):
            self._begin(received.peer)
            return []
        return (
            self._read(message, received)
            if isinstance(message, m.ParamRequestRead)
            else self._set(message, received, now)
        )

    def tick(self) -> list[Outgoing]:
        """The next value of every running list."""
        values = [Outgoing(self._value(index), peer) for peer, index in self._runs.items()]
        self._runs = {peer: index + 1 for peer, index in self._runs.items() if index + 1 < len(TABLE)}
        return values

    def _begin(self, peer: Peer) -> None:
        if peer in self._runs or len(self._runs) < MAX_RUNS:
            self._runs.setdefault(peer, 0)

    def _read(self, message: m.ParamRequestRead, received: Received) -> list[Outgoing]:
        index = _INDEX.get(message.param_id) if message.param_index == -1 else message.param_index
        if index is None or not 0 <= index < len(TABLE):
            return [self._fault(message.param_id, message.param_index, ParamFault.DOES_NOT_EXIST, received)]
        return [Outgoing(self._value(index), received.peer)]

    def _set(self, message: m.ParamSet, received: Received, now: float) -> list[Outgoing]:
        """Refused, with the value that stays."""
        name = message.param_id
        index = _INDEX.get(name)
        if index is None:
            self._texts.say(Severity.WARNING, f"No parameter {m.printable(name)}", now)
            return [self._fault(name, -1, ParamFault.DOES_NOT_EXIST, received)]
        self._texts.say(Severity.WARNING, f"{name} not changed: set it where the vehicle starts", now)
        return [Outgoing(self._value(index)), self._fault(name, index, ParamFault.READ_ONLY, received)]

    def _value(self, index: int) -> m.ParamValue:
        name = TABLE[index].name
        return m.ParamValue(name.encode(), self._params[name], REAL32, len(TABLE), index)

    def _fault(self, name: str, index: int, fault: ParamFault, received: Received) -> Outgoing:
        encoded = name.encode("ascii", "replace")[:16]
        return Outgoing(m.ParamError(received.system, received.component, encoded, index, fault), received.peer)
