"""Lines of the log: the newest ones on the Drive screen, and rows of the Log screen."""

from __future__ import annotations

import time

from rich.style import Style
from textual.strip import Strip

from groundstation.snapshot import LogLine
from groundstation.ui.display.wrap import clean
from groundstation.ui.log.filter import LABELS, tag_of
from groundstation.ui.log.model import LogRow, LogWindow
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, GREEN, RED, TEXT, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

PREFIX = 16
"""Cells in front of the text: time and tag."""

JOINED = " joined "
"""At the right of lines that belong to the marked one."""

_COLOURS = (RED, RED, RED, RED, AMBER, BLUE, BLUE, DIM)
"""By MAV_SEVERITY."""

_LABEL_COLOURS = {"ack": GREEN, "you": YELLOW}


class LogPanel(Instrument[tuple[LogLine, ...]]):
    """One line per text, the newest at the bottom."""

    BORDER_TITLE = "log"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw lines cut at the right edge with an ellipsis, never wrapped: the Log screen shows them whole."""
        return [_cut(strip(*_line(line)), width) for line in self.value[-height:]]


def _cut(line: Strip, width: int) -> Strip:
    """Return a line that fits; one that is cut ends with an ellipsis."""
    if line.cell_length <= width:
        return line
    return Strip([*line.crop(0, max(0, width - 1)), *strip(("…", style(DIM)))])


class LogRows(Instrument[LogWindow]):
    """A window on the whole log, with wrapped lines, the marked one and those that belong to it."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows; further rows of a line are indented."""
        return [strip(*_row(row, self.value, width)).crop(0, width) for row in self.value.rows[:height]]

    def rows_to(self, line: int) -> int | None:
        """Return how many messages lie between the marked one and that on a line of the drawing."""
        numbers = list(dict.fromkeys(row.line.number for row in self.value.rows))
        if line >= len(self.value.rows) or self.value.marked not in numbers:
            return None
        return numbers.index(self.value.rows[line].line.number) - numbers.index(self.value.marked)


def _row(row: LogRow, window: LogWindow, width: int) -> list[Part]:
    marked = row.line.number == window.marked
    ground = FAINT if marked else BACKGROUND
    head = _head(row.line, "›" if marked else " ", ground) if row.part == 0 else [(" " * PREFIX, style(TEXT, ground))]
    parts = [*head, (row.text, _text_style(row.line, ground))]
    room = width - length(parts)
    joined = JOINED if row.part == 0 and row.line.number in window.joined and room > len(JOINED) else ""
    return [*parts, (" " * (room - len(joined)), style(TEXT, ground)), (joined, style(DIM, ground))]


def _line(line: LogLine) -> list[Part]:
    parts = [*_head(line), (clean(line.text), _text_style(line))]
    if line.count > 1:
        parts += [(" ", style()), (f" ×{line.count} ", badge(DIM))]
    return parts


def _head(line: LogLine, mark: str = " ", ground: str = BACKGROUND) -> list[Part]:
    severity = max(0, min(7, line.severity))
    colour = _COLOURS[severity]
    if severity > 4 and line.label in LABELS:
        colour = _LABEL_COLOURS.get(line.label, BLUE)
    when = time.strftime("%H:%M:%S", time.localtime(line.time))
    return [
        (mark, style(BLUE, ground, bold=True)),
        (f"{when} ", style(DIM, ground)),
        (f"{tag_of(line):<5} ", style(colour, ground, bold=severity <= 3)),
    ]


def _text_style(line: LogLine, ground: str = BACKGROUND) -> Style:
    return style(TEXT if line.severity > 2 else RED, ground, bold=line.severity <= 2)
