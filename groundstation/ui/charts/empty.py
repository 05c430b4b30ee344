"""Page without a chart: the ready views and how to begin."""

from __future__ import annotations

import msgspec
from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import DIM, GREEN, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip


class EmptyValue(msgspec.Struct, frozen=True):
    """Names of the views, each with the titles of its charts."""

    views: tuple[tuple[str, str], ...] = ()
    vehicle: bool = False
    """There is a vehicle."""


class EmptyCharts(Instrument[EmptyValue]):
    """A page in the middle."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the lines from one left edge."""
        lines = list(self._lines())
        left = " " * max(0, (width - max(map(length, lines))) // 2)
        blank = [strip()] * max(0, (height - len(lines)) // 2)
        return blank + [strip((left, style()), *line).crop(0, width) for line in lines]

    def _lines(self) -> list[list[Part]]:
        if not self.value.views:
            return [[("waiting for the station", style(DIM))]]
        head = "nothing is drawn yet" if self.value.vehicle else "no vehicle: the charts begin with its first message"
        lines: list[list[Part]] = [[(head, style(WHITE, bold=True))], []]
        lines.append([("v", style(YELLOW, bold=True)), (" opens a ready view", style(TEXT))])
        for name, titles in self.value.views:
            colour = GREEN if titles else DIM
            lines.append([(f"    {clean(name):<8}", style(colour)), (clean(titles) or "no field yet", style(DIM))])
        lines += [[], [("a", style(YELLOW, bold=True)), (" adds a field by a part of its name", style(TEXT))]]
        return lines
