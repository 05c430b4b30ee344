"""Chart pane: one chart in braille, drawn from a value: header, scale, lines, cursors. It has no keys."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.charts.columns import DotColumn
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, LINE, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

AXIS = 8
"""Cells at the left for the scale."""

MAX_DECIMALS = 9

LEAST_SPAN = 1e-300
"""Of a scale: the powers of ten below it are not exact, or 0."""
LEAST_SHARE = 0.02
"""Share of its value that a scale spans at least: the noise of a constant value must not fill the chart."""

COLOURS = (GREEN, AMBER, BLUE, WHITE)
"""Colours of the lines of one chart, in their order."""

PATTERNS: tuple[tuple[int, int], ...] = ((1, 1), (4, 6), (1, 3), (6, 9))
"""Dots that are drawn of so many: solid, dashed, dotted, long dashes. Not only colours tell lines apart."""

SAMPLES = ("━━", "╌╌", "··", "━╌")
"""The same for legends."""


class PaneLine(msgspec.Struct, frozen=True, eq=False):
    """One line: its columns from the left of the picture on, and the one before, see Columns.between."""

    name: str
    value: str
    """At the cursor, or the newest; "--" where there is none."""
    columns: Sequence[DotColumn]
    slot: int
    """Index of its colour and its pattern."""
    chosen: bool = False


class ChartPaneValue(msgspec.Struct, frozen=True, eq=False):
    """A chart. Two values are equal only if they are the same object: the model makes a new one when it has changed."""

    number: int
    title: str
    unit: str
    lines: tuple[PaneLine, ...]
    left: int
    """Number of the column of dots at the left edge."""
    low: float
    high: float
    decimals: int
    cursor: int | None = None
    """Column of dots of the cursor, counted from the left edge."""
    mark: int | None = None
    """That of the second cursor."""
    chosen: bool = False


EMPTY = ChartPaneValue(0, "", "", (), 0, 0.0, 1.0, 0)


def plot_dots(width: int) -> int:
    """Return the columns of dots of a pane of this width."""
    return max(2, (width - AXIS) * 2)


def draw_chart(value: ChartPaneValue, width: int, height: int) -> list[Strip]:
    """Draw a chart of at least two rows: a header, then the picture."""
    canvas = Canvas(width, max(1, height - 1))
    _draw_scale(canvas, value)
    for line in value.lines:
        _Plotter(canvas, value, line).draw()
    for at, colour in ((value.mark, YELLOW), (value.cursor, WHITE)):
        if at is not None and 0 <= at < plot_dots(width):
            for row in range(canvas.height):
                canvas.write(AXIS + at // 2, row, "│", style(colour, bold=colour == WHITE))
    return [_header(value, width), *canvas.strips()]


class ChartPane(Instrument[ChartPaneValue]):
    """One chart."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw it."""
        return draw_chart(self.value, width, height) if height else []


def nice_scale(low: float, high: float, least: float = 0.0) -> tuple[float, float, int]:
    """Return bounds on steps of 1, 2 or 5 around two values, at least `least` apart, and decimals for a scale."""
    if 0 <= low < high / 2:
        low = 0.0  # a scale from 0 shows at once how much it is
    largest = max(abs(low), abs(high))
    span = max(high - low, LEAST_SHARE * largest, least, LEAST_SPAN) if largest else max(1.0, least)
    power = 10.0 ** math.floor(math.log10(span))
    step = next(power * each / 5 for each in (1, 2, 5, 10) if power * each >= span)
    bottom, top = math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step
    top = max(top, bottom + math.ceil(span / step - 1e-9) * step)
    return bottom, top, _decimals(bottom, top)


def _decimals(bottom: float, top: float) -> int:
    """Return the decimals with which the bounds and what is between them are right to 1 % of the scale."""
    numbers, slack = (bottom, (bottom + top) / 2, top), (top - bottom) / 100
    exact = (
        places for places in range(MAX_DECIMALS) if all(abs(round(each, places) - each) <= slack for each in numbers)
    )
    return next(exact, MAX_DECIMALS)


def scale_text(number: float, decimals: int) -> str:
    """Return a number that fits beside a chart: with an exponent, or without its first digits ("…165991")."""
    text = f"{round(number, decimals) + 0.0:.{decimals}f}"
    if len(text) < AXIS:
        return text
    return f"{number:.0e}" if decimals >= MAX_DECIMALS or abs(number) >= 1e7 else f"…{text[2 - AXIS :]}"


def _header(value: ChartPaneValue, width: int) -> Strip:
    """Return the line over a chart: number, title, legend with values, unit."""
    rule = style(BLUE if value.chosen else LINE)
    parts: list[Part] = [
        ("─ ", rule),
        (f"{value.number or ''} {value.title} ".lstrip(), style(BLUE, bold=value.chosen)),
    ]
    for line in value.lines:
        colour = COLOURS[line.slot]
        legend = [(f" {SAMPLES[line.slot]} ", style(colour)), (f"{line.name} ", style(TEXT if line.chosen else DIM)),
                  (f"{line.value} ", style(colour, bold=True))]  # fmt: skip
        if length(parts) + length(legend) + len(value.unit) + 4 > width:
            break
        parts += legend
    unit = f" {value.unit} ─" if value.unit else "─"
    parts.append(("─" * max(0, width - length(parts) - len(unit)), rule))
    return strip(*parts, (unit, style(DIM))).crop(0, width)


def _draw_scale(canvas: Canvas, value: ChartPaneValue) -> None:
    middle = ((value.low + value.high) / 2, (canvas.down - 1) // 2)
    for number, y in ((value.high, 0), *([middle] if canvas.height > 3 else []), (value.low, canvas.down - 1)):
        canvas.write(0, y // 4, scale_text(number, value.decimals).rjust(AXIS - 1), style(DIM))
        for x in range(AXIS * 2, canvas.across, 8):
            canvas.dot(x, y, style(LINE))


class _Plotter:
    """Draws one line on a canvas. Most of what a frame of the Charts screen costs is here."""

    def __init__(self, canvas: Canvas, value: ChartPaneValue, line: PaneLine) -> None:
        self._canvas, self._line = canvas, line
        self._left = value.left
        self._shift = AXIS * 2 - value.left
        self._style: Style = style(COLOURS[line.slot])
        self._on, self._period = PATTERNS[line.slot]
        self._high = value.high
        self._factor = (canvas.down - 1) / ((value.high - value.low) or 1.0)

    def draw(self) -> None:
        """Draw the columns, and a line from each to the next where no data is missing between them."""
        before, ended = -1, 0
        top, factor, left = self._high, self._factor, self._left
        for column in self._line.columns:
            number = column.number
            high, low = round((top - column.high) * factor), round((top - column.low) * factor)
            if before >= 0 and not column.broken:
                if number > before + 1:
                    ended = self._connect(before, ended, number, round((top - column.first) * factor))
                high, low = min(high, ended), max(low, ended)
            if number >= left and number % self._period < self._on:
                self._canvas.run(number + self._shift, high, low, self._style)
            before, ended = number, round((top - column.last) * factor)

    def _connect(self, before: int, start: int, number: int, end: int) -> int:
        """Draw the columns between two that have points; return where the line has come to."""
        rise = (end - start) / (number - before)
        y = start
        for between in range(max(before + 1, self._left), number):
            last, y = y, round(start + rise * (between - before))
            if between % self._period < self._on:
                self._canvas.run(between + self._shift, min(last, y), max(last, y), self._style)
        return y
