"""Chart of values over the last minute, in braille."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from textual.strip import Strip

from groundstation.ui.colours import DIM, LINE, style
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.instrument import Instrument, finite_or_none

SPAN = 60.0
"""Time range of a chart, s."""

AXIS = 6
"""Cells for the scale at the left."""

Samples = tuple[tuple[float, tuple[float | None, ...]], ...]


@dataclass(frozen=True, slots=True)
class Series:
    """One line of a chart."""

    name: str
    colour: str


class Chart(Instrument[Samples]):
    """Some series on one scale, the newest sample at the right edge."""

    def __init__(
        self,
        value: Samples,
        *,
        title: str,
        unit: str,
        series: Sequence[Series],
        step: float,
        id: str | None = None,  # noqa: A002
    ) -> None:
        super().__init__(value, id=id)
        self.border_title = title
        self._unit, self._series, self._step = unit, tuple(series), step
        self._kept: deque[tuple[float, tuple[float | None, ...]]] = deque(value)

    def add(self, now: float, *values: float | None) -> None:
        """Add one sample."""
        self.show(((now, values),))

    def show(self, value: Samples) -> None:
        """Add samples and show those of the last SPAN seconds."""
        self._kept.extend((at, tuple(map(finite_or_none, values))) for at, values in value)
        while self._kept and self._kept[0][0] < self._kept[-1][0] - SPAN:
            self._kept.popleft()
        super().show(tuple(self._kept))

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw grid and scale, then the lines, then their names with the newest values."""
        canvas = Canvas(width, height)
        low, high = _scale([value for _, values in self.value for value in values if value is not None], self._step)
        self._draw_grid(canvas, low, high)
        if self.value:
            for number, series in enumerate(self._series):
                self._draw_series(canvas, number, series, low, high)
        return canvas.strips()

    def _draw_grid(self, canvas: Canvas, low: float, high: float) -> None:
        for row, value in ((0, high), (canvas.height - 1, low)):
            canvas.write(0, row, f"{value:{AXIS - 1}.1f}", style(DIM))
            for x in range(AXIS * 2, canvas.across, 8):
                canvas.dot(x, row * 4 + (3 if row else 0), style(LINE))

    def _draw_series(self, canvas: Canvas, number: int, series: Series, low: float, high: float) -> None:
        newest = self.value[-1][0]
        across, down = canvas.across - AXIS * 2, canvas.down - 1
        points = [
            (AXIS * 2 + (1 - (newest - at) / SPAN) * (across - 1), (high - value) / (high - low) * down)
            for at, values in self.value
            if (value := values[number]) is not None
        ]
        canvas.path(points, style(series.colour))
        if (last := self.value[-1][1][number]) is not None:
            text = f"{series.name} {last:.2f} {self._unit}".strip()
            canvas.write(AXIS + 1 + number * (canvas.width - AXIS) // 2, 0, text, style(series.colour))


def _scale(values: Sequence[float], step: float) -> tuple[float, float]:
    """Return bounds on whole steps around all values, at least two steps apart."""
    if not values:
        return 0.0, 2 * step
    low, high = math.floor(min(values) / step) * step, math.ceil(max(values) / step) * step
    return (low, high) if high - low >= 2 * step else (low, low + 2 * step)
