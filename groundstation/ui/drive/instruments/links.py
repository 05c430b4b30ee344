"""Links panel: loss, round trip, age and rate of each link, and which one counts."""

from __future__ import annotations

from collections.abc import Iterable

from rich.style import Style
from textual.strip import Strip

from groundstation.snapshot import LinkView
from groundstation.ui.look.colours import AMBER, DIM, GREEN, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, finite_or_none, strip

MUCH_LOSS, SLOW_TRIP, OLD = 0.05, 0.2, 1.5
"""Loss, round trip and age in s from which on they are amber."""


class LinksPanel(Instrument[tuple[LinkView, ...]]):
    """Two lines per link: its name, red with a problem, then its figures. Of several the one that counts has a mark."""

    BORDER_TITLE = "links"

    @property
    def wanted(self) -> int:
        """Lines that everything needs."""
        return 2 * len(self.value)

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many links as fit."""
        several = len(vehicle_links(self.value)) > 1
        lines = [line for link in self.value for line in _lines(link, width, marked=several and link.counts)]
        return lines[:height]


def vehicle_links(links: Iterable[LinkView]) -> list[LinkView]:
    """Return the links on which the selected vehicle is heard, or was just now."""
    return [each for each in links if each.age is not None]


def _lines(link: LinkView, width: int, *, marked: bool) -> list[Strip]:
    loss, trip, age = map(finite_or_none, (link.loss, link.round_trip, link.age))
    lost = "--" if loss is None else f"{100 * loss:.1f}%"
    return [
        strip(
            ("★ " if marked else "  ", style(GREEN)), (link.name, style(RED if link.problem else TEXT))
        ).crop(0, width),
        strip(
            (f"{lost:>6}", _look(loss, MUCH_LOSS)), (" lost ", style(DIM)),
            ("    --" if trip is None else f"{1000 * trip:4.0f} ms", _look(trip, SLOW_TRIP)), (" rtt ", style(DIM)),
            ("   --" if age is None else f"{age:4.1f} s", _look(age, OLD)), (" old ", style(DIM)),
            (f"{link.rate:3.0f}", style(GREEN if link.rate else DIM)), ("/s", style(DIM)),
        ).crop(0, width),
    ]  # fmt: skip


def _look(value: float | None, limit: float) -> Style:
    return style(DIM if value is None else AMBER if value >= limit else TEXT)
