"""Messages panel: which messages are received and sent, and how often."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.display.wrap import clean
from groundstation.ui.look.colours import AMBER, BLUE, DIM, GREEN, TEXT, style
from groundstation.ui.widgets.instrument import Instrument, strip
from groundstation.views.messages import MessageRow, MessagesPage


class RatesPanel(Instrument[MessagesPage | None]):
    """One line per message below its source, as on the Messages screen."""

    BORDER_TITLE = "messages"

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw names cut at the right; where rows do not fit, the last line has their number."""
        page = self.value
        if page is None or not page.rows:
            return [strip((" nothing yet", style(DIM))).crop(0, width)]
        room = max(1, width - 15)
        lines = [strip((f"{'':<{room}}{'Hz':>6} {'count':>7} ", style(DIM)))]
        shown = page.rows if page.total < height and len(page.rows) == page.total else page.rows[: max(0, height - 2)]
        lines += [_row(each, room) for each in shown]
        if len(shown) < page.total:
            lines.append(strip((f"and {page.total - len(shown)} more", style(DIM))))
        return [line.crop(0, width) for line in lines]


def _row(each: MessageRow, room: int) -> Strip:
    source = not each.name
    name = clean(each.label) if source else f" {each.name} >" if each.sent else f" {each.name}"
    return strip(
        (f"{name[:room]:<{room}}", style(BLUE if source else AMBER if each.sent else TEXT)),
        (f"{each.rate:6.1f}", style(GREEN if each.rate >= 0.05 else DIM)),
        (f" {each.count:>7} ", style(DIM)),
    )
