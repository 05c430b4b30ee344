"""Lines of the log: the newest ones on the Drive screen, and rows of the Log screen."""

from __future__ import annotations

import time

from rich.style import Style
from textual.strip import Strip

from groundstation.snapshot import LogLine
from groundstation.ui.colours import AMBER, BLUE, DIM, GREEN, RED, TEXT, YELLOW, badge, style
from groundstation.ui.log_model import LABELS, LogRow, tag_of
from groundstation.ui.widgets.instrument import Instrument, Part, strip
from groundstation.ui.wrap import clean

PREFIX = 16
"""Cells in front of the text: time and tag."""

_COLOURS = (RED, RED, RED, RED, AMBER, BLUE, BLUE, DIM)
"""By MAV_SEVERITY."""

_LABEL_COLOURS = {"ack": GREEN, "you": YELLOW}


class LogPanel(Instrument[tuple[LogLine, ...]]):
    """One line per text, the newest at the bottom."""

    BORDER_TITLE = "log"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw lines cut at the right edge, never wrapped: the Log screen shows them whole."""
        return [strip(*_line(line)).crop(0, width) for line in self.value[-height:]]


class LogRows(Instrument[tuple[LogRow, ...]]):
    """A window on the whole log, with wrapped lines."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows; further rows of a line are indented."""
        return [strip(*_row(row)).crop(0, width) for row in self.value[:height]]


def _row(row: LogRow) -> list[Part]:
    head = _head(row.line) if row.part == 0 else [(" " * PREFIX, style())]
    return [*head, (row.text, _text_style(row.line))]


def _line(line: LogLine) -> list[Part]:
    parts = [*_head(line), (clean(line.text), _text_style(line))]
    if line.count > 1:
        parts += [(" ", style()), (f" ×{line.count} ", badge(DIM))]
    return parts


def _head(line: LogLine) -> list[Part]:
    severity = max(0, min(7, line.severity))
    colour = _COLOURS[severity]
    if severity > 4 and line.label in LABELS:
        colour = _LABEL_COLOURS.get(line.label, BLUE)
    when = time.strftime("%H:%M:%S", time.localtime(line.time))
    return [(f" {when} ", style(DIM)), (f"{tag_of(line):<5} ", style(colour, bold=severity <= 3))]


def _text_style(line: LogLine) -> Style:
    return style(TEXT if line.severity > 2 else RED, bold=line.severity <= 2)
