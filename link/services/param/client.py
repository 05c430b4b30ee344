"""Client half of the parameter protocol: fetches all parameters of a vehicle, and reads or sets one.

A set is repeated until the vehicle answers with the wanted value, with another one (rejected) or with PARAM_ERROR.
Source: https://mavlink.io/en/services/parameter.html.
"""

from __future__ import annotations

from collections.abc import Iterable

import msgspec
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import ParamErrorCode
from link.core import Outgoing, Received
from link.services.param.float32 import same_float32
from link.services.param.listing import ParamListing
from link.services.param.values import (
    REAL32,
    from_wire,
    is_carried,
    is_whole,
    name_from_wire,
    name_to_wire,
    same_value,
    to_wire,
    value_fault,
)

REPEAT_AFTER = 0.7
"""s without an answer before a set or read is repeated: ArduPilot answers a read in 0.1 s, a radio adds 0.4 s."""
TRIES = 8
"""At 30 % loss each way all eight fail once in 218 requests of the worst kind."""
REFUSED_AFTER = 2
"""Answers with another value before a set counts as rejected: the first may have been sent before the set arrived."""
NO_INDEX = m.UINT16_MAX
"""`param_index` of an answer without a list index (ArduPilot)."""
LARGEST_EXACT = 2**24
"""float32 carries each integer up to here."""
MAX_PARAMS = 8192
"""Parameters that are kept: five times what the largest autopilot has. More names would be an attack on our memory."""
HASH_CHECK = "_HASH_CHECK"
"""PX4 sends a hash of all values under this name. It is not a parameter."""


class Param(msgspec.Struct, frozen=True):
    """A parameter as the vehicle reported it."""

    name: str
    """Bytes that are not printable ASCII are escaped, see values.name_from_wire."""
    value: float
    kind: int
    """MAV_PARAM_TYPE."""
    index: int | None
    default: float | None = None
    """None: not known."""
    rounded: bool = False
    """An integer that came as float32 and may have been another one there: it is above 2**24."""

    @property
    def is_changed(self) -> bool:
        """Whether the value is not the default; False where that is not known."""
        return self.default is not None and not same_value(self.value, self.default, self.kind)

    def equals(self, value: float) -> bool:
        """Return whether the vehicle would report the same for `value`."""
        return same_float32(self.value, value) if self.rounded else same_value(self.value, value, self.kind)


class ParamOutcome(msgspec.Struct, frozen=True):
    """How a set or read ended."""

    name: str
    wanted: float | None
    """None: a read."""
    value: float | None
    """Value that the vehicle reported; None: no answer."""
    fault: int | None
    """MAV_PARAM_ERROR of the vehicle, or ours where the request cannot be encoded."""
    tries: int = 0
    """How often the request was sent."""
    kind: int = REAL32
    """MAV_PARAM_TYPE."""

    @property
    def done(self) -> bool:
        """Whether the value was read, or is as wanted."""
        if self.fault is not None or self.value is None:
            return False
        return self.wanted is None or same_value(self.value, self.wanted, self.kind)


class _ParamRequest(msgspec.Struct):
    """A set (`wanted`) or read under way."""

    raw: bytes
    wanted: float | None
    due: float = 0.0
    sent: int = 0
    answers: int = 0
    """Values received since the request."""


class ParamClient:
    """Talks to one vehicle.

    `bytewise`: integers lie in the float's bytes (values.is_bytewise); set it before the first request. A read or set
    is sent up to `tries` times, `repeat_after` s apart.
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
        self.bytewise = bytewise
        self._repeat_after = repeat_after
        self._max_tries = tries
        self.params: dict[str, Param] = {}
        """All known parameters, by name; changed only here."""
        self.version = 0
        """Grows with each change of `params`, so that what was made of them can be kept meanwhile."""
        self._listing = ParamListing(self._target)
        self._requests: dict[str, _ParamRequest] = {}
        self._outbox: list[Outgoing] = []
        self._outcomes: list[ParamOutcome] = []

    # ---- all parameters ----

    def fetch(self, now: float) -> None:
        """Start to fetch all parameters by PARAM_REQUEST_LIST."""
        self._outbox += self._listing.start(now)

    def fetch_missing(self, now: float) -> None:
        """Fetch what is `missing`, by index."""
        self._listing.resume(now)

    @property
    def missing(self) -> tuple[int, ...]:
        """Indexes that have not arrived although the list has ended."""
        return self._listing.missing

    def stop_fetch(self) -> None:
        """End the list as it is."""
        self._listing.stop()

    def load(self, params: Iterable[Param]) -> None:
        """Load all parameters from another source, such as a file of the vehicle. Others are forgotten."""
        self.params = {param.name: param for param in params}
        self.version += 1
        self._listing.finish(len(self.params))

    def forget(self) -> None:
        """Forget all values: the vehicle may have restarted with others."""
        self.params.clear()
        self.version += 1
        self._listing.forget()

    @property
    def fetching(self) -> bool:
        """Whether the list is under way."""
        return self._listing.active

    @property
    def complete(self) -> bool:
        """Whether every parameter of the list has arrived."""
        return self._listing.complete

    @property
    def total(self) -> int | None:
        """Number of parameters that the vehicle reports."""
        return self._listing.total

    @property
    def problem(self) -> str | None:
        """Why the list ended incomplete, or None."""
        return self._listing.problem

    @property
    def progress(self) -> tuple[int, int | None]:
        """Parameters that have arrived, and the total."""
        return len(self._listing.received), self._listing.total

    # ---- one parameter ----

    def set(self, name: str, value: float, now: float) -> None:
        """Set a parameter; replaces an unfinished request for the same one."""
        known = self.params.get(name)
        fault = value_fault(value, known.kind if known else REAL32, bytewise=self.bytewise)
        if fault is None:
            self._request(name, value, now)
        else:
            self._outcomes.append(ParamOutcome(name, value, known.value if known else None, fault))

    def read(self, name: str, now: float) -> None:
        """Request one parameter."""
        self._request(name, None, now)

    def is_carried(self, name: str, value: float) -> bool:
        """Return whether a set carries this value of a known parameter as it is (values.is_carried)."""
        return is_carried(value, self.params[name].kind, bytewise=self.bytewise)

    def cancel(self) -> None:
        """Forget the reads and sets under way, without an outcome."""
        self._requests.clear()

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle PARAM_VALUE and PARAM_ERROR of the vehicle; other messages are ignored."""
        if (received.system, received.component) != self._target:
            return
        match received.message:
            case m.ParamValue() as message:
                self._value(message, now)
            case m.ParamError(target_system=target) as message if target in (0, self._own_system):
                self._finish(name_from_wire(message._param_id_raw), fault=message.error)

    def tick(self, now: float) -> None:
        """Repeat overdue requests, fill gaps, give up what was sent `tries` times."""
        for name, request in list(self._requests.items()):
            if now >= request.due:
                if request.sent >= self._max_tries:
                    self._finish(name)
                else:
                    self._send_request(name, request, now)
        self._outbox += self._listing.tick(now)

    def messages_to_send(self) -> list[Outgoing]:
        """Return the messages to send now, and remove them."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[ParamOutcome]:
        """Return the sets and reads that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _request(self, name: str, wanted: float | None, now: float) -> None:
        raw = name_to_wire(name)
        if raw is None:
            self._outcomes.append(ParamOutcome(name, wanted, None, ParamErrorCode.DOES_NOT_EXIST))
            return
        self._requests[name] = request = _ParamRequest(raw, wanted)
        self._send_request(name, request, now)

    def _value(self, message: m.ParamValue, now: float) -> None:
        name = name_from_wire(message._param_id_raw)
        if not name or name == HASH_CHECK or (name not in self.params and len(self.params) >= MAX_PARAMS):
            return
        value = from_wire(message.param_value, message.param_type, bytewise=self.bytewise)
        index = None if message.param_index == NO_INDEX else message.param_index
        rounded = is_whole(message.param_type) and not self.bytewise and abs(value) > LARGEST_EXACT
        self._store(Param(name, value, message.param_type, index, rounded=rounded))
        if index is not None:
            self._listing.handle_value(index, message.param_count, now)
        request = self._requests.get(name)
        if request is None:
            return
        request.answers += 1
        if (
            request.wanted is None
            or same_value(value, request.wanted, message.param_type)
            or request.answers >= REFUSED_AFTER
        ):
            self._finish(name, value=value)

    def _store(self, param: Param) -> None:
        """Keep a parameter, with the index and the default that an answer to a set does not have."""
        known = self.params.get(param.name)
        if known is not None:
            index = known.index if param.index is None else param.index
            param = replace(param, index=index, default=known.default)
        if param != known:
            self.params[param.name] = param
            self.version += 1

    def _finish(self, name: str, *, value: float | None = None, fault: int | None = None) -> None:
        request = self._requests.pop(name, None)
        if request is not None:
            known = self.params.get(name)
            now_is = value if value is not None else known.value if fault is not None and known else None
            self._outcomes.append(
                ParamOutcome(name, request.wanted, now_is, fault, request.sent, known.kind if known else REAL32)
            )

    def _send_request(self, name: str, request: _ParamRequest, now: float) -> None:
        if request.wanted is None:
            self._outbox.append(Outgoing(m.ParamRequestRead(*self._target, request.raw, -1)))
        else:
            known = self.params.get(name)
            kind = known.kind if known else REAL32
            value = to_wire(request.wanted, kind, bytewise=self.bytewise)
            self._outbox.append(Outgoing(m.ParamSet(*self._target, request.raw, value, kind)))
        request.sent += 1
        request.due = now + self._repeat_after
