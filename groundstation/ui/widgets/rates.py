"""Messages panel: which messages are received and sent, and how often."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.snapshot import MessageRate
from groundstation.ui.colours import AMBER, DIM, GREEN, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, strip


class RatesPanel(Instrument[tuple[MessageRate, ...]]):
    """One line per message: received first, then sent."""

    BORDER_TITLE = "messages"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw names cut at the right; where rows do not fit, the last line has their number."""
        room = width - 15
        lines = [strip((f"{'':<{room}}{'Hz':>6} {'count':>7} ", style(DIM)))]
        rows = sorted(self.value, key=lambda each: (each.sent, each.name))
        shown = rows if len(rows) < height else rows[: max(0, height - 2)]
        lines += [_row(each, room) for each in shown]
        if len(shown) < len(rows):
            lines.append(strip((f"and {len(rows) - len(shown)} more", style(DIM))))
        return lines


def _row(each: MessageRate, room: int) -> Strip:
    name = f"{each.name} >" if each.sent else each.name
    return strip(
        (f"{name[:room]:<{room}}", style(AMBER if each.sent else TEXT)),
        (f"{each.rate:6.1f}", style(GREEN if each.rate >= 0.05 else DIM)),
        (f" {each.count:>7} ", style(DIM)),
    )
