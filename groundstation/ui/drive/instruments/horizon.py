"""Artificial horizon, in eighths of a cell."""

from __future__ import annotations

import math
from itertools import groupby

import msgspec
from textual.strip import Strip

from groundstation.snapshot import VehicleView
from groundstation.ui.look.colours import DIM, GROUND, SKY, WHITE, style
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, strip

HALF_VIEW = math.radians(25)
"""Pitch that moves the horizon from the middle to the edge."""

_BLOCKS = " ▁▂▃▄▅▆▇█"


class HorizonValue(msgspec.Struct, frozen=True):
    """Roll (right side down is positive) and pitch (nose up is positive), rad."""

    roll: float
    pitch: float

    @classmethod
    def from_vehicle(cls, vehicle: VehicleView | None) -> HorizonValue | None:
        """Return the attitude of a vehicle, rounded to a third of a degree."""
        if (
            vehicle is None
            or (roll := finite_or_none(vehicle.roll)) is None
            or (pitch := finite_or_none(vehicle.pitch)) is None
        ):
            return None
        return cls(round(roll * 180) / 180, round(pitch * 180) / 180)


def ground_fraction(attitude: HorizonValue, column: float, row: int, height: int) -> float:
    """Return the fraction of a cell that is ground, from its bottom. `column` counts from the middle."""
    # A cell is about twice as high as wide, hence half a row a column.
    slope = math.tan(max(-1.4, min(1.4, attitude.roll)))
    horizon = height / 2 + attitude.pitch / HALF_VIEW * height / 2 - slope * column / 2
    return max(0.0, min(1.0, row + 1 - horizon))


class Horizon(Instrument[HorizonValue | None]):
    """Sky over ground, and a mark for the vehicle's nose."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw rows of few segments: blocks of both colours share one style."""
        attitude = self.value
        if attitude is None:
            return [strip(("no attitude".center(width) if row == height // 2 else " " * width, style(DIM)))
                    for row in range(height)]  # fmt: skip
        return [self._row(attitude, row, width, height) for row in range(height)]

    def _row(self, attitude: HorizonValue, row: int, width: int, height: int) -> Strip:
        cells: list[Part] = []
        for column in range(width):
            eighths = round(8 * ground_fraction(attitude, column - (width - 1) / 2, row, height))
            cells.append((_BLOCKS[eighths], style(GROUND, SKY)))
        if row == height // 2:
            on = GROUND if ground_fraction(attitude, 0.0, row, height) > 0.5 else SKY
            cells[(width - 1) // 2] = ("●", style(WHITE, on, bold=True))
        runs = groupby(cells, key=lambda cell: cell[1])
        return strip(*(("".join(text for text, _ in run), look) for look, run in runs))
