"""The lines of the Log screen: kept, filtered, wrapped and scrolled. Knows no widget."""

from __future__ import annotations

import time
from bisect import bisect_left
from collections.abc import Iterable
from dataclasses import dataclass

from groundstation.snapshot import LogLine
from groundstation.ui.wrap import wrap
from groundstation.views.log import LogPage, LogRequest

KEPT = 2000
"""Lines kept; as many as the station keeps (message_log.MAX_LINES)."""

WARNING = 4
"""MAV_SEVERITY: this one and lower numbers are warnings and worse."""

SEVERITIES = ("EMERG", "ALERT", "CRIT", "ERROR", "WARN", "NOTE", "INFO", "DEBUG")
"""Names of MAV_SEVERITY 0 to 7."""

LABELS = {"ack": "ACK", "state": "STATE", "station": "GCS", "you": "YOU"}
"""Label of a line -> its tag below severity WARNING; STATUSTEXT lines have the name of their severity."""


@dataclass(frozen=True, slots=True)
class LogRow:
    """One row of the screen: a part of a wrapped line."""

    line: LogLine
    part: int
    """0 for the first row of the line, which also shows its time and tag."""
    text: str

    @property
    def key(self) -> tuple[int, int]:
        """Position in the log, which stays when other lines come and go."""
        return self.line.number, self.part


@dataclass(frozen=True, slots=True)
class LogFilter:
    """Which lines are shown."""

    text: str = ""
    """Must occur in the text or the tag, upper or lower case."""
    warnings: bool = False
    """Warnings and worse only."""
    labels: tuple[str, ...] = ()
    """Only lines with one of these labels; empty: all."""

    def matches(self, line: LogLine) -> bool:
        """Return whether the line is shown."""
        if self.warnings and line.severity > WARNING:
            return False
        if self.labels and line.label not in self.labels:
            return False
        return self.text.lower() in f"{tag_of(line)} {line.text}".lower()


class LogModel:
    """The newest KEPT lines, and a window of rows on them that follows the newest line until it is scrolled."""

    def __init__(self) -> None:
        self.filter = LogFilter()
        self._lines: list[LogLine] = []
        self._state = 0
        self._shown: list[LogLine] | None = None
        self._rows: list[LogRow] = []
        self._width = 0
        self._top: tuple[int, int] | None = None
        """Key of the first row in the window; None: it follows the newest line."""

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
        self.filter, self._top, self._shown = chosen, None, None
        self._rows = list(self._wrapped(self._lines))

    def set_width(self, width: int) -> None:
        """Wrap texts to so many characters."""
        if width != self._width:
            self._width = width
            self._rows = list(self._wrapped(self._lines))

    # ---- the window ----

    @property
    def following(self) -> bool:
        """The window follows the newest line."""
        return self._top is None

    def window(self, height: int) -> tuple[LogRow, ...]:
        """Return the rows to show."""
        start = self._start(height)
        return tuple(self._rows[start : start + height])

    def scroll(self, rows: int, height: int) -> None:
        """Move the window down by so many rows, up where negative. At the end it follows the newest line again."""
        last = max(0, len(self._rows) - height)
        start = max(0, min(last, self._start(height) + rows))
        self._top = None if start == last else self._rows[start].key

    def _start(self, height: int) -> int:
        last = max(0, len(self._rows) - height)
        if self._top is None:
            return last
        return min(last, bisect_left(self._rows, self._top, key=lambda row: row.key))

    def _wrapped(self, lines: Iterable[LogLine]) -> Iterable[LogRow]:
        if self._width:
            for line in lines:
                if self.filter.matches(line):
                    for part, text in enumerate(wrap(counted_text(line), self._width)):
                        yield LogRow(line, part, text)

    def _drop_rows(self, number: int) -> None:
        while self._rows and self._rows[-1].line.number == number:
            self._rows.pop()


def tag_of(line: LogLine) -> str:
    """Return the short name of what a line is."""
    severity = max(0, min(7, line.severity))
    return SEVERITIES[severity] if severity <= WARNING else LABELS.get(line.label, SEVERITIES[severity])


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
