"""Client half of the parameter protocol: fetches all parameters of a vehicle, and reads or sets one.

Gaps in a list are filled by index. A set is repeated until the vehicle answers with the wanted value, with another one
(rejected) or with PARAM_ERROR. Source: https://mavlink.io/en/services/parameter.html.
"""

from __future__ import annotations

from dataclasses import dataclass

from dialects import messages as m
from dialects.enums import ParamErrorCode
from link.core import Outgoing, Received
from link.services.param.values import NAME_SIZE, REAL32, from_wire, is_float32, same_float32, to_wire

LIST_TIMEOUT = 1.0
"""s without a new parameter before gaps are filled: a 57600 baud radio with telemetry takes 0.3 s per value."""
REPEAT_AFTER = 0.7
"""s without an answer before a set or read is repeated: ArduPilot answers a read in 0.1 s, a radio adds 0.4 s."""
TRIES = 8
"""At 30 % loss each way all eight fail once in 218 requests of the worst kind."""
WINDOW = 10
"""Gaps requested at once: 320 bytes, a twentieth of a second of a 57600 baud radio."""
REFUSED_AFTER = 2
"""Answers with another value before a set counts as rejected: the first may have been sent before the set arrived."""
NO_INDEX = m.UINT16_MAX
"""`param_index` of an answer without a list index (ArduPilot)."""


@dataclass(frozen=True, slots=True)
class Param:
    """A parameter as the vehicle reported it."""

    name: str
    value: float
    kind: int
    """MAV_PARAM_TYPE."""
    index: int | None


@dataclass(frozen=True, slots=True)
class ParamOutcome:
    """How a set or read ended."""

    name: str
    wanted: float | None
    """None: a read."""
    value: float | None
    """Value that the vehicle reported; None: no answer."""
    fault: int | None
    """MAV_PARAM_ERROR of the vehicle, or ours where the request cannot be encoded."""

    @property
    def done(self) -> bool:
        """Whether the value was read, or is as wanted."""
        if self.fault is not None or self.value is None:
            return False
        return self.wanted is None or same_float32(self.value, self.wanted)


@dataclass(slots=True)
class _ParamRequest:
    """A set (`wanted`) or read under way."""

    wanted: float | None
    due: float = 0.0
    sent: int = 0
    answers: int = 0
    """Values received since the request."""


class ParamClient:
    """Talks to one vehicle. `bytewise`: integers lie in the float's bytes (PX4, and MAVSDK's servers).

    A read or set is sent up to `tries` times, `repeat_after` s apart.
    """

    def __init__(
        self,
        system: int,
        component: int,
        *,
        target_system: int,
        target_component: int = 1,
        bytewise: bool = False,
        repeat_after: float = REPEAT_AFTER,
        tries: int = TRIES,
    ) -> None:
        self._own_system = system
        self._target = (target_system, target_component)
        self._bytewise = bytewise
        self._repeat_after = repeat_after
        self._max_tries = tries
        self.params: dict[str, Param] = {}
        """All known parameters, by name."""
        self.total: int | None = None
        """Number of parameters that the vehicle reports."""
        self.fetching = False
        self._received: set[int] = set()
        self._requests: dict[str, _ParamRequest] = {}
        self._due = 0.0
        self._tries = 0
        self._outbox: list[Outgoing] = []
        self._outcomes: list[ParamOutcome] = []

    def fetch(self, now: float) -> None:
        """Start to fetch all parameters."""
        self.fetching, self.total, self._tries = True, None, 0
        self._received.clear()
        self._request_list(now)

    @property
    def complete(self) -> bool:
        """Whether every parameter of the list has arrived."""
        return self.total is not None and len(self._received) >= self.total

    @property
    def progress(self) -> tuple[int, int | None]:
        """Parameters that have arrived, and the total."""
        return len(self._received), self.total

    def set(self, name: str, value: float, now: float) -> None:
        """Set a parameter; replaces an unfinished request for the same one."""
        if is_float32(value):
            self._request(name, value, now)
        else:
            self._outcomes.append(ParamOutcome(name, value, None, ParamErrorCode.VALUE_OUT_OF_RANGE))

    def read(self, name: str, now: float) -> None:
        """Request one parameter."""
        self._request(name, None, now)

    def receive(self, received: Received, now: float) -> None:
        """Handle PARAM_VALUE and PARAM_ERROR of the vehicle; other messages are ignored."""
        if received.system != self._target[0]:
            return
        match received.message:
            case m.ParamValue() as message:
                self._value(message, now)
            case m.ParamError(target_system=target) as message if target in (0, self._own_system):
                self._finish(message.param_id, fault=message.error)

    def tick(self, now: float) -> None:
        """Repeat overdue requests, fill gaps, give up what was sent `tries` times."""
        for name, request in list(self._requests.items()):
            if now >= request.due:
                if request.sent >= self._max_tries:
                    self._finish(name)
                else:
                    self._send_request(name, request, now)
        if self.fetching and now >= self._due:
            self._continue(now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[ParamOutcome]:
        """Return the sets and reads that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _request(self, name: str, wanted: float | None, now: float) -> None:
        """Send a request, unless the name does not fit: cut to 16 characters it could be another parameter's."""
        if len(name) > NAME_SIZE or not name.isascii() or not name:
            self._outcomes.append(ParamOutcome(name, wanted, None, ParamErrorCode.DOES_NOT_EXIST))
            return
        self._requests[name] = request = _ParamRequest(wanted)
        self._send_request(name, request, now)

    def _value(self, message: m.ParamValue, now: float) -> None:
        value = from_wire(message.param_value, message.param_type, bytewise=self._bytewise)
        index = None if message.param_index == NO_INDEX else message.param_index
        self.params[message.param_id] = Param(message.param_id, value, message.param_type, index)
        if self.fetching and index is not None and index < message.param_count:
            self._listed(index, message.param_count, now)
        request = self._requests.get(message.param_id)
        if request is None:
            return
        request.answers += 1
        if request.wanted is None or same_float32(value, request.wanted) or request.answers >= REFUSED_AFTER:
            self._finish(message.param_id, value=value)

    def _listed(self, index: int, total: int, now: float) -> None:
        if index not in self._received:
            self._due, self._tries = now + LIST_TIMEOUT, 0
        if total != self.total:
            self.total = total
            self._received = {each for each in self._received if each < total}
        self._received.add(index)
        self.fetching = not self.complete

    def _finish(self, name: str, *, value: float | None = None, fault: int | None = None) -> None:
        request = self._requests.pop(name, None)
        if request is not None:
            known = self.params.get(name)
            now_is = value if value is not None else known.value if fault is not None and known else None
            self._outcomes.append(ParamOutcome(name, request.wanted, now_is, fault))

    def _continue(self, now: float) -> None:
        """Request the list again, or what is missing of it, or give up."""
        if self._tries >= TRIES:
            self.fetching = False
        elif self.total is None:
            self._request_list(now)
        else:
            self._tries += 1
            self._due = now + REPEAT_AFTER
            missing = (index for index in range(self.total) if index not in self._received)
            for _, index in zip(range(WINDOW), missing, strict=False):
                self._outbox.append(Outgoing(m.ParamRequestRead(*self._target, b"", index)))

    def _request_list(self, now: float) -> None:
        self._outbox.append(Outgoing(m.ParamRequestList(*self._target)))
        self._tries += 1
        self._due = now + LIST_TIMEOUT

    def _send_request(self, name: str, request: _ParamRequest, now: float) -> None:
        encoded = name.encode("ascii")
        if request.wanted is None:
            self._outbox.append(Outgoing(m.ParamRequestRead(*self._target, encoded, -1)))
        else:
            known = self.params.get(name)
            kind = known.kind if known else REAL32
            value = to_wire(request.wanted, kind, bytewise=self._bytewise)
            self._outbox.append(Outgoing(m.ParamSet(*self._target, encoded, value, kind)))
        request.sent += 1
        request.due = now + self._repeat_after
