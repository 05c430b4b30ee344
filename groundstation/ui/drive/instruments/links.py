"""Links panel: rate, loss and errors of each link."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot import LinkView
from groundstation.ui.look.colours import AMBER, DIM, GREEN, RED, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, finite_or_none, strip


class LinksPanel(Instrument[tuple[LinkView, ...]]):
    """Two lines per link: its name, red with a problem, then its figures."""

    BORDER_TITLE = "links"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many links as fit."""
        lines = [line for link in self.value for line in _lines(link, width)]
        return lines[:height]


def _lines(link: LinkView, width: int) -> list[Strip]:
    loss = finite_or_none(link.loss)
    lost = "--" if loss is None else f"{100 * loss:.1f}%"
    return [
        strip((link.name[:width], style(RED if link.problem else TEXT))),
        strip(
            (f"{link.rate:5.0f}", style(GREEN if link.rate else DIM)), ("/s ", style(DIM)),
            (f"{link.bytes_per_second / 1000:6.1f}", style(TEXT)), (" kB/s ", style(DIM)),
            (f"{lost:>6}", style(TEXT)), (" lost ", style(DIM)),
            (f"{link.crc_errors}", style(AMBER if link.crc_errors else TEXT)), (" bad", style(DIM)),
        ).crop(0, width),
    ]  # fmt: skip
