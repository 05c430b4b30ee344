"""LinkCut: decides when the links of a vehicle are cut on purpose."""

from __future__ import annotations

from link.transport.faults.settings import CUT_AFTER


class LinkCut:
    """Decides when all links are cut: it follows the wheels, so that each cut comes while the rover drives."""

    def __init__(self, length: float) -> None:
        self._length = length
        self._turning_since: float | None = None
        self._until = -1.0

    def update(self, turning: bool, now: float) -> None:
        """Follow the wheels. Call it in each control cycle."""
        if not turning or self.active(now):
            self._turning_since = None
        elif self._turning_since is None:
            self._turning_since = now
        elif self._length and now - self._turning_since >= CUT_AFTER:
            self._until = now + self._length

    def active(self, now: float) -> bool:
        """Return whether nothing passes now."""
        return now < self._until
