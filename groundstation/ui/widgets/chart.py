"""Chart of values over the last minute or less, in braille."""

from __future__ import annotations

import math
from collections.abc import Sequence

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import plain
from groundstation.ui.look.colours import DIM, LINE, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, finite_or_none

SPAN = 60.0
"""Time range of a chart, s."""

AXIS = 6
"""Cells for the scale at the left."""

Samples = tuple[tuple[float, tuple[float | None, ...]], ...]


NAMES_APART = 8
"""Rows from which the names have a row of their own, above the scale."""
NOISE = 0.1
"""Share of a step by which measured values go beyond one: the scale then ends that much above it, not a step. Below its
lowest step they are drawn on it: the speed of a vehicle that stands is a little below 0, too."""
EQUAL = 1e-6
"""Share of a step that is no more than rounding."""


class Series(msgspec.Struct, frozen=True):
    """One line of a chart."""

    name: str
    colour: str
    dotted: bool = False
    """Drawn as dots, so that no colour is needed to tell it from a line."""


class ChartValue(msgspec.Struct, frozen=True):
    """Samples by time, oldest first, and how much of them is shown."""

    samples: Samples = ()
    span: float = SPAN
    """s."""

    @property
    def shown(self) -> Samples:
        """The samples of the last `span` seconds."""
        start = self.samples[-1][0] - self.span if self.samples else 0.0
        return tuple((at, tuple(map(finite_or_none, values))) for at, values in self.samples if at >= start)


class Chart(Instrument[ChartValue]):
    """Some series on one scale, the newest sample at the right edge."""

    def __init__(
        self,
        value: ChartValue,
        *,
        title: str,
        unit: str,
        series: Sequence[Series],
        step: float,
        id: str | None = None,  # noqa: A002
    ) -> None:
        super().__init__(value, id=id)
        self.border_title = plain(title)
        self._unit, self._series, self._step = unit, tuple(series), step

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw grid and scale, then the lines, then their names with the newest values."""
        canvas, shown = Canvas(width, height), self.value.shown
        low, high = _scale([value for _, values in shown for value in values if value is not None], self._step)
        top = 1 if height >= NAMES_APART else 0
        self._draw_grid(canvas, low, high, top)
        if not shown:
            canvas.write(AXIS + 1, 0, "nothing yet", style(DIM))
        else:
            for number, series in reversed(list(enumerate(self._series))):
                self._draw_series(canvas, number, series, shown, (low, high), top)
            self._draw_names(canvas, shown)
        return canvas.strips()

    def _draw_grid(self, canvas: Canvas, low: float, high: float, top: int) -> None:
        bottom = canvas.height - 1
        for row, dot, value in ((top, top * 4, high), (bottom, bottom * 4 + 3, low)):
            canvas.write(0, row, f"{_scale_text(value):>{AXIS - 1}}", style(DIM))
            for x in range(AXIS * 2, canvas.across, 8):
                canvas.dot(x, dot, style(LINE))

    def _draw_series(
        self, canvas: Canvas, number: int, series: Series, shown: Samples, scale: tuple[float, float], top: int
    ) -> None:
        newest, high, size = shown[-1][0], scale[1], scale[1] - scale[0]
        across, down = canvas.across - AXIS * 2, canvas.down - 1 - top * 4
        points = [
            (
                AXIS * 2 + (1 - (newest - at) / self.value.span) * (across - 1),
                top * 4 + _clamp((high - value) / size) * down,
            )
            for at, values in shown
            if (value := values[number]) is not None
        ]
        if not series.dotted:
            canvas.path(points, style(series.colour))
            return
        for x, y in points:
            canvas.dot(round(x), round(y), style(series.colour))

    def _draw_names(self, canvas: Canvas, shown: Samples) -> None:
        column = AXIS + 1
        for series, last in zip(self._series, shown[-1][1], strict=True):
            if last is not None:
                text = f"{series.name} {last:.2f} {self._unit}".strip()
                canvas.write(column, 0, text, style(series.colour))
                column += len(text) + 2
        span = f"{self.value.span:g} s"
        canvas.write(canvas.width - len(span), canvas.height - 1, span, style(DIM))


def _clamp(share: float) -> float:
    return max(0.0, min(1.0, share))


def _scale(values: Sequence[float], step: float) -> tuple[float, float]:
    """Return bounds around all values, at least two steps apart: on whole steps, or NOISE of a step above one."""
    if not values:
        return 0.0, 2 * step
    low = math.floor(min(values) / step + NOISE) * step
    below, over = divmod(max(values) / step, 1.0)
    high = (below + (0.0 if over < EQUAL else NOISE if over <= NOISE + EQUAL else 1.0)) * step
    return (low, max(high, low + 2 * step))


def _scale_text(value: float) -> str:
    """Return a bound with the digits that it needs: 1.0, 1.05."""
    return f"{value:.1f}" if math.isclose(value, round(value, 1)) else f"{value:.2f}"
