"""A value on a line from the smallest to the largest: ● the default, ▲ the value."""

from __future__ import annotations

from groundstation.ui.look.colours import AMBER, BLUE, DIM, style
from groundstation.ui.widgets.instrument import Part
from link.services.param.float32 import value_text

LEAST_WIDTH = 12


def range_lines(low: float, high: float, default: float | None, value: float, width: int) -> list[list[Part]]:
    """Return the line and the numbers below it; nothing where there is no room or no range."""
    if width < LEAST_WIDTH or not low < high:
        return []
    marks: dict[int, Part] = {0: ("├", style(DIM)), width - 1: ("┤", style(DIM))}
    if default is not None:
        marks[_place(default, low, high, width)] = ("●", style(AMBER))
    beyond = "◀" if value < low else "▶" if value > high else "▲"
    marks[_place(value, low, high, width)] = (beyond, style(BLUE, bold=True))
    line: list[Part] = []
    for at in range(width):
        if at in marks or not line or line[-1][0][0] != "─":
            line.append(marks.get(at, ("─", style(DIM))))
        else:
            line[-1] = (line[-1][0] + "─", line[-1][1])
    first, last = value_text(low), value_text(high)
    numbers = f"{first}{last:>{max(1, width - len(first))}}"
    return [line, [(numbers, style(DIM))]]


def _place(value: float, low: float, high: float, width: int) -> int:
    share = (value - low) / (high - low)
    return round(max(0.0, min(1.0, share)) * (width - 1))
