"""The lines of the Log screen: kept, filtered, wrapped and scrolled. Knows no widget."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Iterable

import msgspec
from msgspec.structs import replace

from groundstation.snapshot import LogLine
from groundstation.ui.display.wrap import wrap
from groundstation.ui.log.filter import LogFilter, tag_of
from groundstation.ui.log.join import LogGroup, find_group
from groundstation.views.log import LogPage, LogRequest

KEPT = 2000
"""Lines kept; as many as the station keeps (message_log.MAX_LINES)."""


class LogRow(msgspec.Struct, frozen=True):
    """One row of the screen: a part of a wrapped line."""

    line: LogLine
    part: int
    """0 for the first row of the line, which also shows its time and tag."""
    text: str

    @property
    def key(self) -> tuple[int, int]:
        """Position in the log, which stays when other lines come and go."""
        return self.line.number, self.part


class LogWindow(msgspec.Struct, frozen=True):
    """The rows that are on the screen."""

    rows: tuple[LogRow, ...] = ()
    marked: int = 0
    """Number of the line with the cursor; 0: none."""
    joined: frozenset[int] = frozenset()
    """Numbers of the lines that belong to the marked one, and its own."""


class LogModel:
    """The newest KEPT lines, a cursor that follows the newest line until it is moved, and the rows around it."""

    def __init__(self) -> None:
        self.filter = LogFilter()
        self._lines: list[LogLine] = []
        self._state = 0
        self._shown: list[LogLine] | None = None
        self._rows: list[LogRow] = []
        self._width = 0
        self._cursor: int | None = None
        """Number of the marked line; None: it follows the newest line."""
        self._top = (0, 0)
        """Key of the first row in the window."""
        self._before: tuple[LogFilter, int | None] | None = None
        """Filter and cursor to return to from the lines around a moment."""
        self._group: tuple[int, int, LogGroup] = (0, 0, LogGroup())
        """What belongs together, for a state of the log and a marked line."""

    # ---- lines ----

    @property
    def request(self) -> LogRequest:
        """Request for the lines that are not here yet."""
        return LogRequest(self._state)

    def add(self, page: LogPage) -> None:
        """Add the lines of a page; one that was counted again takes the place of the last line."""
        if page.after != self._state:  # not the answer to `request`
            return
        self._shown = None
        self._state = page.state
        for line in page.lines:
            if self._lines and self._lines[-1].number >= line.number:
                self._drop_rows(self._lines.pop().number)
            self._lines.append(line)
            self._rows += self._wrapped([line])
        if len(self._lines) > KEPT:
            del self._lines[:-KEPT]
            del self._rows[: bisect_left(self._rows, (self._lines[0].number, 0), key=lambda row: row.key)]

    @property
    def shown(self) -> list[LogLine]:
        """The lines that the filter shows, oldest first."""
        if self._shown is None:
            self._shown = [line for line in self._lines if self.filter.matches(line)]
        return self._shown

    @property
    def count(self) -> int:
        """Number of lines kept."""
        return len(self._lines)

    def set_filter(self, chosen: LogFilter) -> None:
        """Show other lines, the newest first of all."""
        self._before = None
        self._apply(replace(chosen, moment=None), None)

    def toggle_around(self) -> None:
        """Show only the lines around the marked one, or what was shown before; the line stays marked."""
        if self._before is not None:
            (chosen, cursor), self._before = self._before, None
            self._apply(chosen, cursor)
        elif (line := self.marked) is not None:
            self._before = self.filter, self._cursor
            self._apply(LogFilter(moment=line.time), line.number)

    def set_width(self, width: int) -> None:
        """Wrap texts to so many characters."""
        if width != self._width:
            self._width = width
            self._rows = list(self._wrapped(self._lines))

    # ---- the cursor and the window ----

    @property
    def following(self) -> bool:
        """The cursor follows the newest line."""
        return self._cursor is None

    @property
    def marked(self) -> LogLine | None:
        """The line with the cursor; None where no line is shown."""
        return self.shown[self._index()] if self.shown else None

    @property
    def group(self) -> LogGroup:
        """What belongs to the marked line."""
        line = self.marked
        if line is None:
            return LogGroup()
        if self._group[:2] != (self._state, line.number):
            self._group = self._state, line.number, find_group(self._lines, line)
        return self._group[2]

    def window(self, height: int) -> LogWindow:
        """Return the rows to show: those around the cursor, moved as little as possible."""
        line = self.marked
        if line is None:
            return LogWindow()
        start = self._start(line, height)
        self._top = self._rows[start].key if start < len(self._rows) else (0, 0)
        return LogWindow(tuple(self._rows[start : start + height]), line.number, self.group.numbers)

    def move(self, lines: int) -> None:
        """Move the cursor down by so many lines, up where negative. On the newest line it follows it again."""
        if self.shown:
            last = len(self.shown) - 1
            index = max(0, min(last, self._index() + lines))
            self._cursor = None if index == last else self.shown[index].number

    def _apply(self, chosen: LogFilter, cursor: int | None) -> None:
        self.filter, self._cursor, self._shown = chosen, cursor, None
        self._rows = list(self._wrapped(self._lines))

    def _index(self) -> int:
        last = len(self.shown) - 1
        if self._cursor is None:
            return last
        return min(last, bisect_left(self.shown, self._cursor, key=lambda line: line.number))

    def _start(self, line: LogLine, height: int) -> int:
        last = max(0, len(self._rows) - height)
        if self._cursor is None:
            return last
        first, end = (self._row_index((number, 0)) for number in (line.number, line.number + 1))
        return max(0, min(last, first, max(self._row_index(self._top), end - height)))

    def _row_index(self, key: tuple[int, int]) -> int:
        return bisect_left(self._rows, key, key=lambda row: row.key)

    def _wrapped(self, lines: Iterable[LogLine]) -> Iterable[LogRow]:
        if self._width:
            for line in lines:
                if self.filter.matches(line):
                    for part, text in enumerate(wrap(counted_text(line), self._width)):
                        yield LogRow(line, part, text)

    def _drop_rows(self, number: int) -> None:
        while self._rows and self._rows[-1].line.number == number:
            self._rows.pop()


def counted_text(line: LogLine) -> str:
    """Return the text, and how often it occurred in a row."""
    return line.text if line.count == 1 else f"{line.text}  ×{line.count}"


def format_lines(lines: Iterable[LogLine]) -> str:
    """Return lines for a file: local time with its offset from UTC, tag, text."""
    rows = (f"{_timestamp(line.time)} {tag_of(line):<5} {counted_text(line)}\n" for line in lines)
    return "".join(rows)


def _timestamp(at: float) -> str:
    local = time.localtime(at)
    return time.strftime("%Y-%m-%dT%H:%M:%S", local) + f".{int(at % 1 * 10)}" + time.strftime("%z", local)
