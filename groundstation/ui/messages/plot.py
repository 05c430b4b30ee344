"""Message plot: the last minute of the chosen field, with lowest, mean and highest value."""

from __future__ import annotations

from array import array

import msgspec
from textual.strip import Strip

from groundstation.ui.charts.columns import Columns
from groundstation.ui.charts.pane import ChartPaneValue, PaneLine, draw_chart, nice_scale, plot_dots
from groundstation.ui.charts.points import Points
from groundstation.ui.look.colours import DIM, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, strip
from groundstation.views.messages import FieldPlot

SPAN = 60.0
"""s."""

STATS_FROM = 6
"""Rows from which on the last one has numbers."""


class MessagePlotValue(msgspec.Struct, frozen=True):
    """The plot of a field; None: there is none, and why."""

    plot: FieldPlot | None = None
    reason: str = ""


class MessagePlot(Instrument[MessagePlotValue]):
    """A chart, and below it a line of numbers."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the chart."""
        plot = self.value.plot
        if plot is None:
            return [strip((f" {self.value.reason}"[:width], style(DIM)))]
        stats = height >= STATS_FROM
        lines = draw_chart(build_pane(plot, width), width, height - stats)
        return [*lines, strip((_stats(plot)[:width], style(TEXT)))] if stats else lines


def build_pane(plot: FieldPlot, width: int) -> ChartPaneValue:
    """Return the chart of a plot at this width."""
    times, values = array("d", plot.times), array("d", plot.values)
    points, columns = Points(), Columns(SPAN / plot_dots(width))
    for at, value in zip(times, values, strict=True):
        points.add(at, value)
    columns.update(points)
    left = int(plot.now // columns.step) - plot_dots(width) + 1
    least = 0.0 if plot.info.decimals else 1.0
    low, high, decimals = nice_scale(min(values, default=0.0), max(values, default=1.0), least)
    field = plot.info.field
    name = field.field + (f"[{field.index}]" if field.index >= 0 else "")
    text = _text(plot, points.value_at(plot.now))
    line = PaneLine(name, text, columns.between(left, left + plot_dots(width)), 0, chosen=True)
    return ChartPaneValue(0, "60 s", plot.info.unit, (line,), left, low, high, decimals)


def _stats(plot: FieldPlot) -> str:
    values = array("d", plot.values)
    if not values:
        return " no value in the last minute"
    mean = sum(values) / len(values)
    places = plot.info.decimals
    return f" min {min(values):.{places}f}  mean {mean:.{places}f}  max {max(values):.{places}f}  {len(values)} samples"


def _text(plot: FieldPlot, value: float | None) -> str:
    if value is None:
        return "--"
    return dict(plot.info.names).get(int(value)) or f"{value:.{plot.info.decimals}f}"
