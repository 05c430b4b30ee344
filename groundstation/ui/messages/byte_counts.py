"""Bytes by message: which messages the links carry most of."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.look.colours import AMBER, DIM, GREEN, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, strip
from groundstation.views.messages import MessagesPage

NAME, NUMBER = 26, 9
"""Widths of a name and of its bytes/s."""
LEAST_BAR = 4
LEAST = 0.5
"""Bytes/s below which a message is not listed."""


class MessageBytes(Instrument[MessagesPage | None]):
    """One line per message of all sources, the largest first; the bar compares its bytes with those of the largest."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw as many messages as fit."""
        page = self.value
        if page is None or not page.rows:
            return [strip((" nothing yet", style(DIM))).crop(0, width)]
        found: dict[tuple[str, bool], float] = {}
        for row in page.rows:
            found[row.name, row.sent] = found.get((row.name, row.sent), 0.0) + row.bytes
        rows = sorted((each for each in found.items() if each[1] >= LEAST), key=lambda each: -each[1])[:height]
        return [_row(name, sent, size, size / rows[0][1], width) for (name, sent), size in rows]


def _row(name: str, sent: bool, size: float, share: float, width: int) -> Strip:
    bar = max(LEAST_BAR, width - NAME - NUMBER - 3)
    full = max(1, round(share * bar))
    text, look = f"{name} >" if sent else name, AMBER if sent else TEXT
    return strip(
        (f" {text[:NAME]:<{NAME}} ", style(look)),
        ("━" * full, style(AMBER if sent else GREEN)),
        (" " * (bar - full), style()),
        (f"{size:5.0f}", style(look)),
        (" B/s", style(DIM)),
    ).crop(0, width)
