"""Which of several screens drives."""

from __future__ import annotations

import msgspec

NO_SCREEN = "no screen"
"""In the place of a name: no screen has the keys, so that a program may drive."""


class LeaseView(msgspec.Struct, frozen=True, kw_only=True):
    """Which of several screens drives."""

    driver: str = ""
    """Name of the screen that drives, e.g. "screen on pts/4", or NO_SCREEN; empty: this one."""
    waits: float | None = None
    """Seconds for which that screen may still answer our request; None without one."""
    asks: str = ""
    """Name of the screen that asks this one for the keys; empty: none."""
    left: float = 0.0
    """Seconds to answer it."""
