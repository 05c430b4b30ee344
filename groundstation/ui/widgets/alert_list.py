"""Alert list: every alert that holds now, whole, most urgent first."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec
from textual.strip import Strip

from groundstation.ui.display.alerts import Alert
from groundstation.ui.display.wrap import wrap
from groundstation.ui.look.colours import DIM, style
from groundstation.ui.widgets.alert import LOOKS, MARKS
from groundstation.ui.widgets.instrument import Instrument, strip

MARGIN = 3
"""Cells of the mark, and of the space at both sides of it."""


class AlertListValue(msgspec.Struct, frozen=True):
    """The alerts, and the first of their rows that is shown."""

    alerts: tuple[Alert, ...] = ()
    top: int = 0


def alert_rows(alerts: Sequence[Alert], width: int) -> list[tuple[Alert, int, str]]:
    """Return the alerts wrapped: each row with its alert and its number within it."""
    return [(alert, part, line) for alert in alerts for part, line in enumerate(wrap(alert.text, width - MARGIN))]


class AlertList(Instrument[AlertListValue]):
    """One or more rows for each alert."""

    def draw(self, width: int, height: int) -> list[Strip]:
        """Draw the rows from `top` on."""
        rows = alert_rows(self.value.alerts, width)[self.value.top :][:height]
        if not rows:
            return [strip((" no alerts", style(DIM)))]
        return [
            strip((f" {MARKS[alert.level] if part == 0 else ' '} {text}".ljust(width), LOOKS[alert.level]()))
            for alert, part, text in rows
        ]
