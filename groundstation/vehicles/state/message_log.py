"""Message log: STATUSTEXT, results of commands, changes of state, events of the station. Repeats are counted."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from itertools import islice, takewhile
from typing import NamedTuple

import msgspec

from dialects.enums import Severity
from dialects.messages import StatusText
from dialects.printable import printable
from groundstation.snapshot import LogLine
from groundstation.snapshot.log_origin import LogOrigin
from groundstation.vehicles.state.chunked_texts import ChunkedText, TextJoiner
from groundstation.views.log import LogPage, LogRequest

MAX_LINES = 2000
MAX_LENGTH = 160
"""Characters kept of a text: three full STATUSTEXT chunks."""

NEWEST = 16
"""Lines in each snapshot: what the log panel of the Drive screen can show."""

PAGE = 250
"""Lines in one view of the log. With the longest texts, 4 bytes a character, they take 175 kB: less than a packet."""

STATE = "state"
"""Label of changes of mode, arming and control."""

OPERATOR = "you"
"""Label of what the operator did."""


class _Line(msgspec.Struct):
    time: float
    severity: int
    label: str
    text: str
    number: int
    state: int
    """State of the log after the line was added or counted again."""
    origin: LogOrigin | None
    first: float
    count: int = 1


class VehicleText(NamedTuple):
    """A whole text of a vehicle, or one with a gap where chunks were lost."""

    system: int
    text: str
    severity: int


class MessageLog:
    """Texts in the order of arrival. Times are of the monotonic clock; `build_lines` converts them to wall clock."""

    def __init__(self) -> None:
        self.listener: Callable[[float, str, str, int], None] | None = None
        """Gets each line that is added: time, label, text, severity."""
        self.name_of: Callable[[int], str] = lambda system: ""
        """Returns the name of the vehicle with a system id, "" where it has none."""
        self._lines: deque[_Line] = deque(maxlen=MAX_LINES)
        self._joiner = TextJoiner()
        self._number = 0
        self._state = 0
        self._built: tuple[tuple[int, float], tuple[LogLine, ...]] = ((-1, 0.0), ())
        """State and the clocks' distance, and the newest lines then: snapshots ask five times a second."""

    @property
    def state(self) -> int:
        """Changes with each line that is added or counted again."""
        return self._state

    def add(
        self, now: float, label: str, text: str, severity: int = Severity.INFO, *, origin: LogOrigin | None = None
    ) -> None:
        """Add a line, or count it if it repeats the last line. The name of the vehicle is filled in."""
        text = printable(text)[:MAX_LENGTH]
        if self.listener is not None:
            self.listener(now, label, text, severity)
        self._state += 1
        if origin is not None:
            origin = msgspec.structs.replace(origin, vehicle=self.name_of(origin.system))
        last = self._lines[-1] if self._lines else None
        if last is not None and _same(last, label, text, severity, origin):
            last.count += 1
            last.time, last.state = now, self._state
        else:
            self._number += 1
            self._lines.append(_Line(now, severity, label, text, self._number, self._state, origin, now))

    def handle_statustext(
        self, message: StatusText, system: int, now: float, component: int = 0
    ) -> tuple[VehicleText, ...]:
        """Handle a STATUSTEXT. Returns the texts that are whole now, and those for which it waits no more."""
        found = self._joiner.add(message, system, component, now)
        finished = list(self._joiner.pop_overdue(now))
        return self._add_texts([*finished, found] if found.complete else finished, now)

    def expire(self, now: float) -> tuple[VehicleText, ...]:
        """Log the texts whose other chunks are overdue, and return them."""
        return self._add_texts(self._joiner.pop_overdue(now), now)

    def _add_texts(self, found: Iterable[ChunkedText], now: float) -> tuple[VehicleText, ...]:
        texts = []
        for each in found:
            system, component, _ = each.key
            self.add(now, "vehicle", each.text, each.severity, origin=LogOrigin(system, component))
            texts.append(VehicleText(system, each.text, each.severity))
        return tuple(texts)

    def build_lines(self, now: float, wall: float) -> tuple[LogLine, ...]:
        """Return the NEWEST lines, oldest first; `now` and `wall` are the same moment on both clocks.

        Changes of state and what the operator did are left out: the screen shows the state itself, and they would push
        warnings out.
        """
        key = self._state, _wall_time(0.0, now, wall)
        if self._built[0] != key:
            lines = (line for line in reversed(self._lines) if line.label not in (STATE, OPERATOR))
            newest = [_build_line(line, now, wall) for line in islice(lines, NEWEST)]
            self._built = key, tuple(reversed(newest))
        return self._built[1]

    def build_page(self, request: LogRequest, now: float, wall: float) -> LogPage | None:
        """Return the lines that were added or counted again since `request.after`, oldest first; None without any."""
        changed = takewhile(lambda line: line.state > request.after, reversed(self._lines))
        lines = list(reversed(list(changed)))[:PAGE]
        if not lines:
            return None
        return LogPage(tuple(_build_line(line, now, wall) for line in lines), lines[-1].state, request.after)


def _same(line: _Line, label: str, text: str, severity: int, origin: LogOrigin | None) -> bool:
    return (line.label, line.severity, line.text, line.origin) == (label, severity, text, origin)


def _wall_time(at: float, now: float, wall: float) -> float:
    """Return a time on the wall clock, in whole ms: else no line of two snapshots is equal, and all are drawn again."""
    return round(wall - now + at, 3)


def _build_line(line: _Line, now: float, wall: float) -> LogLine:
    return LogLine(
        time=_wall_time(line.time, now, wall),
        severity=line.severity,
        label=line.label,
        text=line.text,
        count=line.count,
        number=line.number,
        first=_wall_time(line.first, now, wall) if line.count > 1 else None,
        origin=line.origin,
    )
