"""Statistics: lowest, mean and highest value of each line in the window."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.charts.pane import COLOURS
from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import DIM, style
from groundstation.ui.widgets.columns import cut
from groundstation.ui.widgets.instrument import Instrument, strip

NUMBER, UNIT = 7, 6
"""Cells of a number, and of the unit behind them."""

WIDE = 44
"""Cells from which on there is room for the unit."""


class StatsRow(msgspec.Struct, frozen=True):
    """A line of a chart."""

    name: str
    texts: tuple[str, ...]
    """Lowest, mean and highest value."""
    unit: str
    slot: int


class StatsPanel(Instrument[tuple[StatsRow, ...]]):
    """One line per line of a chart."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit."""
        unit = UNIT if width >= WIDE else 0
        room = max(4, width - 3 * NUMBER - unit)
        return [self._line(row, room, unit) for row in self.value[:height]]

    def _line(self, row: StatsRow, room: int, unit: int) -> Strip:
        numbers = "".join(f"{text[: NUMBER - 1]:>{NUMBER}}" for text in row.texts)
        return strip(
            (f"{cut(clean(row.name), room - 1):<{room}}", style(DIM)),
            (numbers, style(COLOURS[row.slot])),
            (f" {row.unit:<{UNIT}}"[:unit], style(DIM)),
        )
