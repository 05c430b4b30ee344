"""Alert line: the most urgent alert, and the number of further ones."""

from __future__ import annotations

from textual.strip import Strip

from groundstation.ui.alerts import Alert, AlertLevel
from groundstation.ui.colours import AMBER, DEEP_RED, PANEL, TEXT, WARNING, YELLOW, badge, style
from groundstation.ui.widgets.instrument import Instrument, Part, length, strip

_LOOKS = {
    AlertLevel.HINT: style(TEXT, PANEL),
    AlertLevel.WARNING: style(AMBER, WARNING, bold=True),
    AlertLevel.DANGER: badge(DEEP_RED),
    AlertLevel.QUESTION: badge(YELLOW),
}
_MARKS = {AlertLevel.HINT: "›", AlertLevel.WARNING: "!", AlertLevel.DANGER: "■", AlertLevel.QUESTION: "?"}


class AlertLine(Instrument[tuple[Alert, ...]]):
    """One line over the full width."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the first alert in its colour; further hints are not counted."""
        if not self.value:
            return []
        first = self.value[0]
        others = sum(alert.level is not AlertLevel.HINT for alert in self.value[1:])
        look = _LOOKS[first.level]
        left: list[Part] = [(f" {_MARKS[first.level]} {first.text}", look)]
        right: list[Part] = [(f" +{others} " if others else "", look)]
        gap = max(1, width - length(left) - length(right))
        return [strip(*left, (" " * gap, look), *right).crop(0, width)]
