"""How keys drive, and how hard: what the command line and the sticks both know. The screen's process loads it, too, and
must stay free of the dialect (13 MB that only the station process needs)."""

from __future__ import annotations

from enum import StrEnum

LOWEST_LIMIT, HIGHEST_LIMIT = 0.1, 1.0
"""The speed keys stay in here: below 10 % a rover does not overcome its friction and looks broken."""


class Style(StrEnum):
    """How keys drive."""

    HOLD = "hold"
    """While a key is held."""
    LATCH = "latch"
    """Until the next key, as the article's teleop does."""
    STEP = "step"
    """Each press adds 10 %; until the stop key."""

    @property
    def next(self) -> Style:
        """The style after this one."""
        styles = list(Style)
        return styles[(styles.index(self) + 1) % len(styles)]
