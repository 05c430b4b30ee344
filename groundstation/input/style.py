"""Drive styles and the range of the stick limits, shared by the command line, the screen and the sticks.

The screen's process imports this module, so it must not import the dialect (13 MB that only the station process needs).
"""

from __future__ import annotations

from enum import StrEnum

LOWEST_LIMIT, HIGHEST_LIMIT = 0.1, 1.0
"""Range of the stick limits: below 10 % a rover does not overcome its friction and looks broken."""


class Style(StrEnum):
    """How keys drive."""

    HOLD = "hold"
    """While a key is held."""
    LATCH = "latch"
    """Until the next key, as teleop_twist_keyboard does."""
    STEP = "step"
    """Each press adds 10 %; until the stop key."""

    @property
    def next(self) -> Style:
        """The style after this one."""
        styles = list(Style)
        return styles[(styles.index(self) + 1) % len(styles)]
