"""Heading tape: a section of the compass that slides over a marker."""

from __future__ import annotations

import math

from textual.strip import Strip

from groundstation.snapshot import VehicleView
from groundstation.ui.look.colours import BLUE, DIM, TEXT, WHITE, YELLOW, style
from groundstation.ui.widgets.instrument import Instrument, finite_or_none, strip

DEGREES_PER_CELL = 3

_NAMES = {0: "N", 45: "NE", 90: "E", 135: "SE", 180: "S", 225: "SW", 270: "W", 315: "NW"}


def heading_degrees(vehicle: VehicleView | None) -> int | None:
    """Return the heading in degrees, 0..359, None where it is not known."""
    if vehicle is None or (heading := finite_or_none(vehicle.heading)) is None:
        return None
    return round(math.degrees(heading)) % 360


def heading_marks(heading: int, width: int) -> str:
    """Return the marks around a heading: the eight compass points, numbers every 30 degrees, dots every 15."""
    middle = width // 2
    cells = [" "] * width
    first = (heading - (middle + 3) * DEGREES_PER_CELL) // 15 * 15
    for mark in range(first, first + (width + 6) * DEGREES_PER_CELL + 15, 15):
        text = _NAMES.get(mark % 360) or (f"{mark % 360:03d}" if mark % 30 == 0 else "·")
        start = middle + round((mark - heading) / DEGREES_PER_CELL) - len(text) // 2
        for offset, character in enumerate(text):
            if 0 <= start + offset < width:
                cells[start + offset] = character
    return "".join(cells)


class HeadingTape(Instrument[int | None]):
    """The tape, and the heading in digits under its middle."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw two lines."""
        if self.value is None:
            return [strip((" " * width, style())), strip(("no heading".center(width), style(DIM)))]
        marks = heading_marks(self.value, width)
        middle = width // 2
        figures = f" {self.value:03d}° {_NAMES.get(round(self.value / 45) * 45 % 360, '')}"
        return [
            strip(
                (marks[:middle], style(BLUE)),
                (marks[middle], style(WHITE, bold=True)),
                (marks[middle + 1 :], style(BLUE)),
            ),
            strip((" " * middle, style()), ("▲", style(YELLOW)), (figures, style(TEXT, bold=True))),
        ]
