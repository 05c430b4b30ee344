"""The parameter protocol of a ground station: fetch all of a vehicle's parameters and set one, until it is certain.

A list that comes with holes is filled by index; a set is repeated until the vehicle answers with the value that was
wanted, with another one (refused) or with PARAM_ERROR. The other half is server.py.
"""

from __future__ import annotations

from dataclasses import dataclass

from dialects import messages as m
from dialects.enums import ParamErrorCode
from link.core import Outgoing, Received
from link.services.param.values import NAME_SIZE, REAL32, from_wire, is_float32, same_float32, to_wire

LIST_TIMEOUT = 1.0
"""s without a new parameter before holes are filled: a 57600 baud radio with telemetry takes 0.3 s for a value."""
REPEAT_AFTER = 0.7
"""s without an answer before a set or read is repeated: ArduPilot answers a read in 0.1 s, a radio adds 0.4 s."""
TRIES = 8
"""At 30 % loss each way all eight fail once in 218 tries of the worst kind."""
WINDOW = 10
"""Holes asked for at once: 320 bytes, a twentieth of a second of a 57600 baud radio."""
REFUSED_AFTER = 2
"""Answers with another value before a set counts as refused: the first may have been under way already."""
NO_INDEX = m.UINT16_MAX
"""`param_index` of an answer that does not say where in the list it stands (ArduPilot)."""


@dataclass(frozen=True, slots=True)
class Param:
    """A parameter as the vehicle told it."""

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
    """None: it was only read."""
    value: float | None
    """What the vehicle says it is now; None: it said nothing."""
    fault: int | None
    """MAV_PARAM_ERROR, where it sent one, or of ours where the wish cannot be said."""

    @property
    def done(self) -> bool:
        """Is it as wanted?"""
        if self.fault is not None or self.value is None:
            return False
        return self.wanted is None or same_float32(self.value, self.wanted)


@dataclass(slots=True)
class _Asked:
    """A set (`wanted`) or read under way."""

    wanted: float | None
    due: float = 0.0
    sent: int = 0
    answers: int = 0
    """Values that came since it was asked."""


class ParamClient:
    """Talks to one vehicle. `bytewise`: it puts whole numbers into the float's bytes (PX4, and MAVSDK's servers).

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
        """All that is known, by name."""
        self.total: int | None = None
        """How many the vehicle says it has."""
        self.fetching = False
        self._have: set[int] = set()
        self._asked: dict[str, _Asked] = {}
        self._due = 0.0
        self._tries = 0
        self._outbox: list[Outgoing] = []
        self._outcomes: list[ParamOutcome] = []

    def fetch(self, now: float) -> None:
        """Begin to fetch all of them anew."""
        self.fetching, self.total, self._tries = True, None, 0
        self._have.clear()
        self._ask_list(now)

    @property
    def complete(self) -> bool:
        """Is every parameter of the list here?"""
        return self.total is not None and len(self._have) >= self.total

    @property
    def progress(self) -> tuple[int, int | None]:
        """How many are here, and of how many."""
        return len(self._have), self.total

    def set(self, name: str, value: float, now: float) -> None:
        """Set a parameter; a newer wish for the same one replaces the older."""
        if is_float32(value):
            self._request(name, value, now)
        else:
            self._outcomes.append(ParamOutcome(name, value, None, ParamErrorCode.VALUE_OUT_OF_RANGE))

    def read(self, name: str, now: float) -> None:
        """Ask for one parameter."""
        self._request(name, None, now)

    def receive(self, received: Received, now: float) -> None:
        """Take PARAM_VALUE and PARAM_ERROR of the vehicle; others are ignored."""
        if received.system != self._target[0]:
            return
        match received.message:
            case m.ParamValue() as message:
                self._value(message, now)
            case m.ParamError(target_system=target) as message if target in (0, self._own_system):
                self._finish(message.param_id, fault=message.error)

    def tick(self, now: float) -> None:
        """Repeat what is overdue, fill holes, give up what was asked enough."""
        for name, asked in list(self._asked.items()):
            if now >= asked.due:
                if asked.sent >= self._max_tries:
                    self._finish(name)
                else:
                    self._ask(name, asked, now)
        if self.fetching and now >= self._due:
            self._continue(now)

    def messages_to_send(self) -> list[Outgoing]:
        """What to send now; empties what it returns."""
        outbox, self._outbox = self._outbox, []
        return outbox

    def outcomes(self) -> list[ParamOutcome]:
        """Sets and reads that ended since the last call."""
        outcomes, self._outcomes = self._outcomes, []
        return outcomes

    def _request(self, name: str, wanted: float | None, now: float) -> None:
        """Ask, unless the name cannot be said: cut to 16 characters it would be another parameter's."""
        if len(name) > NAME_SIZE or not name.isascii() or not name:
            self._outcomes.append(ParamOutcome(name, wanted, None, ParamErrorCode.DOES_NOT_EXIST))
            return
        self._asked[name] = asked = _Asked(wanted)
        self._ask(name, asked, now)

    def _value(self, message: m.ParamValue, now: float) -> None:
        value = from_wire(message.param_value, message.param_type, bytewise=self._bytewise)
        index = None if message.param_index == NO_INDEX else message.param_index
        self.params[message.param_id] = Param(message.param_id, value, message.param_type, index)
        if self.fetching and index is not None and index < message.param_count:
            self._listed(index, message.param_count, now)
        asked = self._asked.get(message.param_id)
        if asked is None:
            return
        asked.answers += 1
        if asked.wanted is None or same_float32(value, asked.wanted) or asked.answers >= REFUSED_AFTER:
            self._finish(message.param_id, value=value)

    def _listed(self, index: int, total: int, now: float) -> None:
        if index not in self._have:
            self._due, self._tries = now + LIST_TIMEOUT, 0
        if total != self.total:
            self.total = total
            self._have = {each for each in self._have if each < total}
        self._have.add(index)
        self.fetching = not self.complete

    def _finish(self, name: str, *, value: float | None = None, fault: int | None = None) -> None:
        asked = self._asked.pop(name, None)
        if asked is not None:
            known = self.params.get(name)
            now_is = value if value is not None else known.value if fault is not None and known else None
            self._outcomes.append(ParamOutcome(name, asked.wanted, now_is, fault))

    def _continue(self, now: float) -> None:
        """The list has gone quiet: ask for it again, or for what is missing, or give up."""
        if self._tries >= TRIES:
            self.fetching = False
        elif self.total is None:
            self._ask_list(now)
        else:
            self._tries += 1
            self._due = now + REPEAT_AFTER
            missing = (index for index in range(self.total) if index not in self._have)
            for _, index in zip(range(WINDOW), missing, strict=False):
                self._outbox.append(Outgoing(m.ParamRequestRead(*self._target, b"", index)))

    def _ask_list(self, now: float) -> None:
        self._outbox.append(Outgoing(m.ParamRequestList(*self._target)))
        self._tries += 1
        self._due = now + LIST_TIMEOUT

    def _ask(self, name: str, asked: _Asked, now: float) -> None:
        encoded = name.encode("ascii")
        if asked.wanted is None:
            self._outbox.append(Outgoing(m.ParamRequestRead(*self._target, encoded, -1)))
        else:
            known = self.params.get(name)
            kind = known.kind if known else REAL32
            value = to_wire(asked.wanted, kind, bytewise=self._bytewise)
            self._outbox.append(Outgoing(m.ParamSet(*self._target, encoded, value, kind)))
        asked.sent += 1
        asked.due = now + self._repeat_after
