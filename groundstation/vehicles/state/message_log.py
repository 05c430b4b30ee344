"""Message log: STATUSTEXT, results of commands, changes of state, events of the station. Repeats are counted."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from itertools import islice, takewhile

import msgspec

from dialects.enums import Severity
from dialects.messages import StatusText, decode_text, printable
from groundstation.snapshot import LogLine
from groundstation.snapshot.log_origin import LogOrigin
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

CHUNK = 50
"""Bytes of text in one STATUSTEXT (common.xml)."""

MAX_CHUNKS = 8
"""Chunks joined to one text; longer texts are cut."""

CHUNK_TIMEOUT = 2.0
"""s after which an incomplete text is shown without its missing chunks."""


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


class _Chunks(msgspec.Struct):
    """An incomplete text."""

    started: float
    severity: int
    parts: dict[int, str]
    origin: LogOrigin
    last: int | None = None

    @property
    def complete(self) -> bool:
        return self.last is not None and len(self.parts) > self.last

    @property
    def text(self) -> str:
        return "".join(self.parts[number] for number in sorted(self.parts))


class MessageLog:
    """Texts in the order of arrival. Times are of the monotonic clock; `build_lines` converts them to wall clock."""

    def __init__(self) -> None:
        self.listener: Callable[[float, str, str, int], None] | None = None
        """Gets each line that is added: time, label, text, severity."""
        self.name_of: Callable[[int], str] = lambda system: ""
        """Returns the name of the vehicle with a system id, "" where it has none."""
        self._lines: deque[_Line] = deque(maxlen=MAX_LINES)
        self._chunks: dict[tuple[int, int], _Chunks] = {}
        self._number = 0
        self._state = 0

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

    def handle_statustext(self, message: StatusText, system: int, now: float, component: int = 0) -> str | None:
        """Handle a STATUSTEXT. Returns the text when all its chunks have arrived."""
        severity, origin = int(message.severity), LogOrigin(system, component)
        if message.id == 0:  # an extension field: 0 means "not one of several chunks"
            self.add(now, "vehicle", decode_text(message), severity, origin=origin)
            return decode_text(message)
        key = (system, int(message.id))
        if key not in self._chunks and len(self._chunks) >= MAX_CHUNKS:
            self.expire(now, everything=True)
        chunks = self._chunks.setdefault(key, _Chunks(now, severity, {}, origin))
        part = decode_text(message)
        chunks.parts[min(int(message.chunk_seq), MAX_CHUNKS - 1)] = part
        if len(message._text_raw.split(b"\0", 1)[0]) < CHUNK or message.chunk_seq >= MAX_CHUNKS - 1:
            chunks.last = min(int(message.chunk_seq), MAX_CHUNKS - 1)
        if not chunks.complete:
            return None
        del self._chunks[key]
        self.add(now, "vehicle", chunks.text, chunks.severity, origin=chunks.origin)
        return chunks.text

    def expire(self, now: float, *, everything: bool = False) -> None:
        """Log the incomplete texts whose other chunks are overdue."""
        for key, chunks in list(self._chunks.items()):
            if everything or now - chunks.started > CHUNK_TIMEOUT:
                del self._chunks[key]
                self.add(now, "vehicle", chunks.text + " ...", chunks.severity, origin=chunks.origin)

    def build_lines(self, now: float, wall: float) -> tuple[LogLine, ...]:
        """Return the NEWEST lines, oldest first; `now` and `wall` are the same moment on both clocks.

        Changes of state and what the operator did are left out: the screen shows the state itself, and they would push
        warnings out.
        """
        lines = (line for line in reversed(self._lines) if line.label not in (STATE, OPERATOR))
        newest = [_build_line(line, now, wall) for line in islice(lines, NEWEST)]
        return tuple(reversed(newest))

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
