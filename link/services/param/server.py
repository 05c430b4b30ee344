"""Server half of the parameter protocol: lists, reads and sets the parameters of a table.

Rules (https://mavlink.io/en/services/parameter.html): a set is always answered. A rejected one is answered with
PARAM_ERROR and then with the current value, in this order, because MAVSDK takes the first answer that names the
parameter. Every value is REAL32, the only type that all ground stations read alike. The vehicle saves what is set.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Protocol

import msgspec

from dialects import messages as m
from dialects.enums import ParamErrorCode
from dialects.printable import printable
from link.core import Outgoing, Peer, Received
from link.services.pacing import MAVLINK2_OVERHEAD, BulkPacer
from link.services.param.float32 import same_float32, shortest_float32
from link.services.param.values import NAME_SIZE, REAL32

RUN_PERIOD = 1.0
"""s between the starts of two lists to one peer: less than the 2 s after which MAVProxy repeats its request."""
MAX_RUNS = 16
VALUE_FRAME = m.ParamValue.unpacker.size + MAVLINK2_OVERHEAD


class ParamDefinition(Protocol):
    """One row of the parameter table."""

    @property
    def name(self) -> str:
        """At most 16 ASCII characters."""

    @property
    def default(self) -> float:
        """Value until the parameter is set."""

    @property
    def low(self) -> float:
        """Smallest value allowed."""

    @property
    def high(self) -> float:
        """Largest value allowed."""

    @property
    def unit(self) -> str:
        """Unit as it is displayed, e.g. "m/s"; empty where there is none."""

    @property
    def description(self) -> str:
        """One sentence."""

    @property
    def whole(self) -> bool:
        """Integers only."""

    @property
    def safety(self) -> bool:
        """Cannot be changed while armed."""

    @property
    def needs_reboot(self) -> bool:
        """Takes effect after a restart."""

    @property
    def read_only(self) -> bool:
        """Cannot be set by a ground station."""


class ParamValues(Protocol):
    """The current values."""

    def __getitem__(self, name: str, /) -> float:
        """Return the current value."""

    def set(self, name: str, value: float) -> None:
        """Set a checked value. Raises ValueError, one line, if it contradicts another parameter."""


class ParamRejection(msgspec.Struct, frozen=True):
    """Why a value was rejected."""

    fault: ParamErrorCode
    reason: str
    """One line for the operator."""


class _Run(msgspec.Struct):
    """A list under way to one peer."""

    start: float
    next: int = 0


class ParamServer:
    """Answers for one system and component.

    `allowed` returns whether the sender may set parameters, `armed` whether safety parameters are locked. `changed`
    gets every value that was set and its sender, `refused` a line for the sender of a set that was rejected.
    """

    def __init__(
        self,
        table: Sequence[ParamDefinition],
        values: ParamValues,
        *,
        system: int,
        component: int,
        pacer: BulkPacer,
        allowed: Callable[[Received, float], bool] = lambda received, now: True,
        armed: Callable[[], bool] = lambda: False,
        changed: Callable[[Received, str, float], None] = lambda received, name, value: None,
        refused: Callable[[Received, str, float], None] = lambda received, text, now: None,
    ) -> None:
        self._table = tuple(table)
        self._index = {setting.name: index for index, setting in enumerate(self._table)}
        self._values = values
        self._ids = (system, component)
        self._pacer = pacer
        self._allowed, self._armed, self._changed, self._refused = allowed, armed, changed, refused
        self._runs: dict[Peer, _Run] = {}

    def receive(self, received: Received, now: float) -> list[Outgoing]:
        """Answer one message; nothing if it is not for us or its sender may not ask."""
        message = received.message
        if not isinstance(message, m.ParamRequestList | m.ParamRequestRead | m.ParamSet) or not received.may_ask:
            return []
        if message.target_system != self._ids[0] or message.target_component not in (0, self._ids[1]):
            return []
        match message:
            case m.ParamRequestList():
                self._begin(received.peer, now)
                return []
            case m.ParamRequestRead():
                return self._read(message, received)
            case _:
                return self._set(message, received, now) if received.introduced else []

    def tick(self, now: float) -> list[Outgoing]:
        """Return the next values of every list under way, as far as the links have room."""
        outgoing: list[Outgoing] = []
        for peer, run in list(self._runs.items()):
            while run.start <= now and run.next < len(self._table) and self._pacer.consume(peer, VALUE_FRAME, now):
                outgoing.append(Outgoing(self._value(run.next), peer))
                run.next += 1
            if run.next >= len(self._table) and now - run.start >= RUN_PERIOD:
                del self._runs[peer]
        return outgoing

    def broadcast(self, names: Iterable[str]) -> list[Outgoing]:
        """Return the values of parameters that the vehicle itself has changed, for all peers."""
        return [Outgoing(self._value(self._index[name])) for name in names]

    def _begin(self, peer: Peer, now: float) -> None:
        """Start a list. A request during a list is ignored; one soon after it waits for RUN_PERIOD."""
        run = self._runs.get(peer)
        if run is None and len(self._runs) < MAX_RUNS:
            self._runs[peer] = _Run(now)
        elif run is not None and run.next >= len(self._table):
            self._runs[peer] = _Run(run.start + RUN_PERIOD)

    def _read(self, message: m.ParamRequestRead, received: Received) -> list[Outgoing]:
        index = self._index.get(message.param_id, -1) if message.param_index == -1 else message.param_index
        if not 0 <= index < len(self._table):
            return [self._fault(message._param_id_raw, message.param_index, ParamErrorCode.DOES_NOT_EXIST, received)]
        return [Outgoing(self._value(index), received.peer)]

    def _set(self, message: m.ParamSet, received: Received, now: float) -> list[Outgoing]:
        name, index = message.param_id, self._index.get(message.param_id)
        if not self._allowed(received, now):
            return self._deny(message, index, received, now)
        if index is None:
            self._refused(received, f"No parameter {printable(name)}", now)
            return [self._fault(message._param_id_raw, -1, ParamErrorCode.DOES_NOT_EXIST, received)]
        rejection = self._rejection(self._table[index], message) or self._apply(name, message.param_value, received)
        if rejection:
            self._refused(received, f"{name} not changed: {rejection.reason}", now)
            fault = self._fault(message._param_id_raw, index, rejection.fault, received)
            return [fault, Outgoing(self._value(index), received.peer)]
        return [Outgoing(self._value(index))]

    def _deny(self, message: m.ParamSet, index: int | None, received: Received, now: float) -> list[Outgoing]:
        """Deny a set of a sender that may not set parameters, with the current value of those that exist."""
        self._refused(received, f"{printable(message.param_id)} not changed: you are not in control", now)
        known = -1 if index is None else index
        fault = self._fault(message._param_id_raw, known, ParamErrorCode.PERMISSION_DENIED, received)
        return [fault] if index is None else [fault, Outgoing(self._value(index), received.peer)]

    def _apply(self, name: str, wire_value: float, received: Received) -> ParamRejection | None:
        value = shortest_float32(wire_value)
        if same_float32(value, self._values[name]):
            return None
        try:
            self._values.set(name, value)
        except ValueError as error:
            return ParamRejection(ParamErrorCode.VALUE_OUT_OF_RANGE, str(error))
        self._changed(received, name, value)
        return None

    def _rejection(self, setting: ParamDefinition, message: m.ParamSet) -> ParamRejection | None:
        if setting.read_only:
            return ParamRejection(ParamErrorCode.READ_ONLY, "it is read-only")
        if message.param_type != REAL32:
            return ParamRejection(ParamErrorCode.TYPE_MISMATCH, "its type is REAL32")
        if same_float32(message.param_value, self._values[setting.name]):
            return None
        if setting.safety and self._armed():
            return ParamRejection(ParamErrorCode.PERMISSION_DENIED, "disarm first")
        return check_value(setting, message.param_value)

    def _value(self, index: int) -> m.ParamValue:
        name = self._table[index].name
        return m.ParamValue(name.encode(), self._values[name], REAL32, len(self._table), index)

    def _fault(self, name: bytes, index: int, fault: ParamErrorCode, received: Received) -> Outgoing:
        return Outgoing(
            m.ParamError(received.system, received.component, name[:NAME_SIZE], index, fault), received.peer
        )


def check_value(setting: ParamDefinition, value: float) -> ParamRejection | None:
    """Return why `value` is invalid for `setting`, or None. Values are compared as float32."""
    if not math.isfinite(value):
        return ParamRejection(ParamErrorCode.VALUE_OUT_OF_RANGE, f"{value} is not a number")
    value = shortest_float32(value)
    if not setting.low <= value <= setting.high:
        return ParamRejection(
            ParamErrorCode.VALUE_OUT_OF_RANGE, f"{value:g} is not in {setting.low:g} to {setting.high:g}"
        )
    if setting.whole and value != int(value):
        return ParamRejection(ParamErrorCode.VALUE_OUT_OF_RANGE, f"{value:g} is not a whole number")
    return None
