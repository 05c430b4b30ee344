"""Field list: the charts and their lines with values, the fields that match what is typed, and the views."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.charts.pane import COLOURS, SAMPLES
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BACKGROUND, BLUE, DIM, FAINT, GREEN, TEXT, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

VALUE = 9
"""Cells of a value."""


class ChartRow(msgspec.Struct, frozen=True):
    """A chart."""

    number: int
    title: str
    unit: str


class SeriesRow(msgspec.Struct, frozen=True):
    """A line of the chart above it."""

    slot: int
    label: str
    short: str
    """In place of the label where that does not fit."""
    at_cursor: str
    now: str
    chosen: bool = False
    pinned: bool = False
    """Recorded also while the screen is hidden."""
    heard: bool = True
    """Its message has arrived."""


class CandidateRow(msgspec.Struct, frozen=True):
    """A field that matches what is typed."""

    name: str
    value: str
    first: bool = False


class ViewRow(msgspec.Struct, frozen=True):
    """A view."""

    name: str
    shown: bool = False
    empty: bool = False
    """The vehicle sends none of its fields."""
    own: bool = False


class TextRow(msgspec.Struct, frozen=True):
    """A heading or a hint."""

    text: str


ListRow = ChartRow | SeriesRow | CandidateRow | ViewRow | TextRow


class FieldList(Instrument[tuple[ListRow, ...]]):
    """One line per row; where they do not fit, those around the chosen one."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows under a line of titles."""
        titles = ("at │" + "now".rjust(VALUE)).rjust(width - 1)[-width:]
        rows = self.value[self._first(height - 1) :][: max(0, height - 1)]
        return [strip((titles, style(DIM))), *(self._line(row, width) for row in rows)]

    def rows_to(self, line: int) -> int | None:
        """Return how many lines of charts lie between the chosen one and that on a line of the drawing."""
        at = self._first(self.size.height - 1) + line - 1
        lines = [row for row in self.value if isinstance(row, SeriesRow)]
        under = self.value[at] if 0 <= at < len(self.value) else None
        chosen = next((number for number, row in enumerate(lines) if row.chosen), None)
        if chosen is None or not isinstance(under, SeriesRow):
            return None
        return sum(isinstance(row, SeriesRow) for row in self.value[:at]) - chosen

    def _first(self, room: int) -> int:
        typed = next((at for at, row in enumerate(self.value) if isinstance(row, CandidateRow)), None)
        chosen = next((at for at, row in enumerate(self.value) if isinstance(row, SeriesRow) and row.chosen), 0)
        last = len(self.value) - 1 if typed is not None else chosen + 1
        return max(0, min(last - room + 1, len(self.value) - room))

    def _line(self, row: ListRow, width: int) -> Strip:
        match row:
            case ChartRow():
                left: list[Part] = [
                    (f"{row.number} ", style(YELLOW, bold=True)),
                    (clean(row.title), style(BLUE, bold=True)),
                ]
                return _ends(left, [(clean(row.unit), style(DIM))], width)
            case SeriesRow():
                return _series(row, width)
            case CandidateRow():
                ground = FAINT if row.first else BACKGROUND
                left = [("› " if row.first else "  ", style(YELLOW, ground)), (clean(row.name), style(TEXT, ground))]
                return _ends(left, [(f" {clean(row.value)[:16]}", style(DIM, ground))], width, ground)
            case ViewRow():
                note = "now" if row.shown else "no field yet" if row.empty else ""
                colour = GREEN if row.shown else DIM if row.empty else TEXT
                left = [("v ", style(YELLOW)), (clean(row.name) + (" *" if row.own else ""), style(colour))]
                return _ends(left, [(note, style(DIM))], width)
            case TextRow():
                return strip((clean(row.text)[:width], style(DIM)))


def _series(row: SeriesRow, width: int) -> Strip:
    ground = FAINT if row.chosen else BACKGROUND
    colour = COLOURS[row.slot]
    sample = (f"{'›' if row.chosen else ' '}{SAMPLES[row.slot]}{'●' if row.pinned else ' '} ", style(colour, ground))
    name = clean(row.label if len(row.label) + 5 + 2 * VALUE <= width else row.short)
    label = (name, style(TEXT if row.heard else DIM, ground, bold=row.chosen))
    now = clean(row.now)[: 2 * VALUE] if not row.at_cursor else clean(row.now)[:VALUE]
    right: list[Part] = (
        [(f" {clean(row.at_cursor)[:VALUE]}", style(colour, ground, bold=True))] if row.at_cursor else []
    )
    right.append((f" {now:>{VALUE - 1}}", style(AMBER if row.now == "--" else TEXT, ground)))
    return _ends([sample, label], right, width, ground)


def _ends(left: list[Part], right: list[Part], width: int, ground: str = BACKGROUND) -> Strip:
    """Return a line with a part at each end; the left one is cut."""
    room = max(0, width - length(right))
    head = strip(*left).crop(0, room)
    return Strip([*head, *strip((" " * (room - head.cell_length), style(TEXT, ground)), *right)])
