"""The detail panel of the Log screen: everything of the marked line."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.display.wrap import wrap
from groundstation.ui.log.detail import DetailRow, LogDetail
from groundstation.ui.look.colours import AMBER, DIM, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, strip

NAME = 10
"""Cells of the names of the rows."""


class LogDetailPanel(Instrument[LogDetail]):
    """Names and wrapped texts; the last line says how many did not fit."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows from the first one on."""
        lines = [line for row in self.value.rows for line in _draw_row(row, width)]
        if len(lines) > height > 0:
            hidden = len(lines) - height + 1
            lines[height - 1 :] = [strip((f" … {hidden} more lines: enlarge the terminal", style(DIM)))]
        return [line.crop(0, width) for line in lines]


def _draw_row(row: DetailRow, width: int) -> list[Strip]:
    colour = RED if row.severity <= 3 else AMBER if row.severity == 4 else TEXT
    texts = wrap(row.text, max(1, width - NAME - 1))
    names = [row.name, *[""] * (len(texts) - 1)]
    return [
        strip((f" {name:<{NAME - 1}}", style(DIM)), (text, style(colour)))
        for name, text in zip(names, texts, strict=True)
    ]
