"""Centre-zero bars: the demand sent, with a mark at the demand that the vehicle obeys, and each motor output."""

from __future__ import annotations

from collections.abc import Iterator

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.snapshot import Snapshot
from groundstation.ui.look.colours import AMBER, BLUE, DIM, FAINT, GREEN, PANEL, TEXT, WHITE, style
from groundstation.ui.widgets.instrument import Instrument, Part, finite_or_none, strip

LABEL, FIGURES = 9, 6
"""Cells left (at least) and right of a bar."""

MARK = "┃"
_PARTIAL = " ▏▎▍▌▋▊▉"


class Bar(msgspec.Struct, frozen=True):
    """One bar, in percent; `obeyed` is what the vehicle reports (ROVER_DRIVE_STATUS)."""

    label: str
    colour: str
    percent: int | None
    obeyed: int | None = None


def build_bars(snapshot: Snapshot) -> tuple[Bar, ...]:
    """Return the axes as sent, then the outputs that are known."""
    operator, vehicle = snapshot.operator, snapshot.vehicle
    obeyed = vehicle.demand if vehicle is not None and vehicle.demand is not None else (None, None)
    outputs = vehicle.outputs if vehicle is not None else ()
    if vehicle is not None and vehicle.flies:
        return (
            Bar("forward", AMBER, _percent(operator.throttle)),
            Bar("turn", BLUE, _percent(operator.steering)),
            Bar("side", AMBER, _percent(operator.side)),
            Bar("climb", AMBER, _percent(operator.climb)),
            *(Bar(output.name, GREEN, _percent(output.value)) for output in outputs),
        )
    return (
        Bar("throttle", AMBER, _percent(operator.throttle), _percent(obeyed[0])),
        Bar("steering", BLUE, _percent(operator.steering), _percent(obeyed[1])),
        *(Bar(output.name, GREEN, _percent(output.value)) for output in outputs),
    )


def _percent(value: float | None) -> int | None:
    value = finite_or_none(value)
    return None if value is None else round(100 * max(-1.0, min(1.0, value)))


Cell = tuple[str, str, str]
"""Text, its colour, and the colour of its ground."""


def bar_cells(bar: Bar, width: int) -> Iterator[Part]:
    """Return the cells of a bar that grows from its middle, in eighths of a cell."""
    half = (width - 1) // 2
    filled = abs(bar.percent or 0) / 100 * half
    whole, eighths = int(filled), int(filled % 1 * 8)
    rest = half - whole - (1 if eighths else 0)
    full, trough = ("█" * whole, bar.colour, PANEL), ("░" * rest, FAINT, PANEL)
    empty: Cell = ("░" * half, FAINT, PANEL)
    middle: Cell = ("│", DIM, PANEL)
    if (bar.percent or 0) < 0:
        # No block characters grow from the right: the complementary block with swapped colours looks the same.
        part = _PARTIAL[8 - eighths] if eighths else ""
        cells: list[Cell] = [trough, (part, PANEL, bar.colour), full, middle, empty]
    else:
        part = _PARTIAL[eighths] if eighths else ""
        cells = [empty, middle, full, (part, bar.colour, PANEL), trough]
    marked = cells if bar.obeyed is None else _marked(cells, half + round(bar.obeyed / 100 * half))
    return ((text, style(colour, ground, bold=text == MARK)) for text, colour, ground in marked)


def _marked(cells: list[Cell], at: int) -> Iterator[Cell]:
    """Yield the cells with the mark of the obeyed demand over one of them, on the ground of that cell."""
    start = 0
    for text, colour, ground in cells:
        if start <= at < start + len(text):
            yield text[: at - start], colour, ground
            yield MARK, WHITE, colour if text[at - start] == "█" else ground
            yield text[at - start + 1 :], colour, ground
        else:
            yield text, colour, ground
        start += len(text)


class StickBars(Instrument[tuple[Bar, ...]]):
    """The bars, one per line."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many as fit, the demand first."""
        shown = self.value[:height]
        label = max(LABEL, *(len(bar.label) + 1 for bar in shown)) if shown else LABEL
        return [self._line(bar, label, width) for bar in shown]

    def _line(self, bar: Bar, label: int, width: int) -> Strip:
        figures = "--" if bar.percent is None else f"{bar.percent:+d}%"
        look: Style = style(TEXT if bar.percent else DIM)
        return strip(
            (f"{bar.label:<{label}}", style(DIM)),
            *bar_cells(bar, width - label - FIGURES),
            (f"{figures:>{FIGURES}}", look),
        )
