"""Alert line: the most urgent alert, and the number of further ones with the key that lists them. Hint line."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import msgspec
from rich.style import Style
from textual.strip import Strip

from groundstation.ui.display.alerts import Alert, AlertLevel, active_alerts
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.look.colours import AMBER, DEEP_RED, PANEL, TEXT, WARNING, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, strip

LOOKS: dict[AlertLevel, Callable[[], Style]] = {
    AlertLevel.WARNING: partial(style, AMBER, WARNING, bold=True),
    AlertLevel.DANGER: partial(badge, DEEP_RED),
    AlertLevel.QUESTION: partial(badge, YELLOW),
}
SEPARATOR = " · "
"""Between the parts of a hint."""
BACK = "ESC goes back"
"""The part of a hint that every screen but Drive has; the first to be left out."""
MARKS = {AlertLevel.WARNING: "!", AlertLevel.DANGER: "■", AlertLevel.QUESTION: "?"}


class AlertValue(msgspec.Struct, frozen=True):
    """The alerts that hold now, most urgent first."""

    alerts: tuple[Alert, ...] = ()
    list_key: str = "?"
    """Key of the screen that lists them."""

    @classmethod
    def from_state(cls, now: DisplayState) -> AlertValue:
        """Return the alerts of a display state."""
        return cls(tuple(active_alerts(now)), now.key("app.log"))


class AlertLine(Instrument[AlertValue]):
    """One line over the full width; blank without an alert."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the first alert in its colour. The key stands there also where one alert alone does not fit."""
        if not self.value.alerts:
            return []
        first, *others = self.value.alerts
        look = LOOKS[first.level]()
        text = f" {MARKS[first.level]} {first.text}"
        more = f" +{len(others)}" if others else "" if len(text) <= width else " …"
        right = f"{more} {self.value.list_key} " if more else ""
        return [strip((text.ljust(width)[: max(0, width - len(right))] + right, look)).crop(0, width)]


class HintLine(Instrument[str]):
    """What to do next: one line over the full width."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the hint."""
        look = style(TEXT, PANEL)
        return [strip((f" › {fit_hint(self.value, width - 3)}".ljust(width), look)).crop(0, width)]


def fit_hint(text: str, width: int) -> str:
    """Return a hint that is at most so wide: what it says first stays, and what to press, which is its last part."""
    if len(text) <= width:
        return text
    first, *parts = text.split(SEPARATOR)
    if parts and parts[-1].startswith(BACK):
        parts.pop()
    last = f"{SEPARATOR}{parts.pop().partition(', ')[0]}" if parts else ""
    while parts and len(SEPARATOR.join([first, *parts])) + len(last) > width:
        parts.pop()
    kept = SEPARATOR.join([first, *parts])
    room = max(0, width - len(last))
    return f"{kept if len(kept) <= room else kept[: max(0, room - 1)] + '…'}{last}"[:width]
