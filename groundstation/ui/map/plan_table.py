"""Table of the items of a plan: number, command, value, leg and bearing, state."""

from __future__ import annotations

import msgspec
from msgspec.structs import replace
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.look.colours import AMBER, BLUE, DIM, FAINT, GREEN, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.columns import Column, fit, header, row
from groundstation.ui.widgets.instrument import Instrument, strip

COLUMNS = (
    Column("#", 2, 0, right=True, most=4),
    Column("command", 9, 0, most=16),
    Column("value", 5, 2, right=True, most=9),
    Column("leg m", 5, 1, right=True, most=7),
    Column("brg", 4, 3, right=True),
    Column("", 2, 0),
)
_COLOURS = {"done": DIM, "now": YELLOW, "edited": BLUE, "warned": AMBER, "": TEXT}
_MARKS = {"✓": GREEN, "▶": YELLOW, "✎": BLUE, "+": BLUE, "!": AMBER}


class PlanTableRow(msgspec.Struct, frozen=True):
    """One item as texts."""

    number: str
    command: str
    value: str = ""
    leg: str = ""
    bearing: str = ""
    mark: str = ""
    """✓ reached, ▶ current, ✎ changed here, + new, ! warned of."""
    look: str = ""
    """"done", "now", "edited" or "warned"."""


class PlanTableValue(msgspec.Struct, frozen=True):
    """The rows in view."""

    rows: tuple[PlanTableRow, ...] = ()
    selected: int | None = None
    """Index in `rows`."""
    summary: str = ""
    """The line below them."""
    note: str = ""
    """Why there are no items."""

    def with_reason(self, reason: str) -> PlanTableValue:
        """Return the table with the reason why there is no map in place of the summary."""
        return replace(self, summary=reason) if reason else self


class PlanTable(Instrument[PlanTableValue]):
    """The table."""

    def cursor_line(self) -> int | None:
        """Return the line of the selected item, below the titles."""
        return None if self.value.selected is None else self.value.selected + 1

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw titles, rows and the summary."""
        widths = fit(COLUMNS, width)
        lines = [header(COLUMNS, widths)]
        for index, item in enumerate(self.value.rows[: max(0, height - 2)]):
            lines.append(_draw_row(item, widths, selected=index == self.value.selected, width=width))
        if self.value.note:
            lines.append(strip((f" {self.value.note}"[:width], style(DIM))))
        lines += [strip()] * (height - 1 - len(lines))
        return [*lines[: height - 1], strip((f" {_fitting(self.value.summary, width - 1)}"[:width], style(DIM)))]


def _fitting(summary: str, width: int) -> str:
    """Return as many whole parts of a summary as fit, the first in any case."""
    while len(summary) > width and " · " in summary:
        summary = summary.rpartition(" · ")[0]
    return summary


def _draw_row(item: PlanTableRow, widths: tuple[int, ...], *, selected: bool, width: int) -> Strip:
    ground = FAINT if selected else None
    colour = WHITE if selected and not item.look else _COLOURS[item.look]
    look, faint = _style(colour, ground, bold=selected or item.look == "now"), _style(DIM, ground)
    marks = [mark for mark in item.mark if mark in _MARKS]
    mark = _style(_MARKS[marks[-1]] if marks else DIM, ground, bold=True)
    cells = [(item.number, look), (item.command, look), (item.value, look), (item.leg, look), (item.bearing, faint),
             (item.mark, mark)]  # fmt: skip
    return row(COLUMNS, widths, cells, _style(TEXT, ground)).adjust_cell_length(width, _style(TEXT, ground))


def _style(colour: str, ground: str | None, *, bold: bool = False) -> Style:
    return style(colour, bold=bold) if ground is None else style(colour, ground, bold=bold)
