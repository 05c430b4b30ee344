"""Publishers of demands: which of them drives, and for how long its demand stands. Time is an argument.

The first that moves the vehicle drives until it stops, falls silent, leaves, or another one says stop. What others
demand is ignored meanwhile: an idle node that repeats its last command for ever, as the article's does, cannot disturb
the one that drives.
"""

from __future__ import annotations

from collections.abc import Hashable

import msgspec

from dialects.axes import NEUTRAL, Axes

TWIST_SILENCE = 0.5
"""s without a Twist after which its demand ends."""
WORD_SILENCE = 0.8
"""s without a String after which its demand ends: the article's command_node repeats its last one every 0.6 to 0.7 s,
which is too long for 0.5 s."""
MAX_SOURCES = 64
"""Publishers that are known at once."""


class _Source(msgspec.Struct):
    """One publisher."""

    axes: Axes = NEUTRAL
    until: float = 0.0
    """When its demand ends."""
    blocked: bool = False
    """It must show neutral, or fall silent, before it drives again."""


class DemandSources(msgspec.Struct):
    """All publishers of one program; a key is what tells them apart, e.g. topic and id.

    `push` what arrives, `remove` who leaves, and ask `axes` for the demand at a moment.
    """

    driving: Hashable | None = None
    """Key of the publisher that drives; None: nobody does."""
    _sources: dict[Hashable, _Source] = msgspec.field(default_factory=dict)

    def push(self, key: Hashable, axes: Axes, silence: float, now: float) -> bool:
        """Handle a demand that ends after `silence` s. Returns False if it moves, and is ignored."""
        self._expire(now)
        source = self._sources.get(key)
        known = source is not None
        if source is None:
            if len(self._sources) >= MAX_SOURCES:
                return axes.neutral
            source = self._sources[key] = _Source()
        moved = not source.axes.neutral
        source.axes, source.until = axes, now + silence
        if axes.neutral:
            source.blocked = False
            if key == self.driving:
                self.driving = None
            elif moved or not known:  # one that repeats its stop is idle
                self.stop()
            return True
        if source.blocked or (self.driving is not None and self.driving != key):
            source.blocked = True
            return False
        self.driving = key
        return True

    def stop(self) -> None:
        """End the demand: whoever drives must show neutral, or fall silent, before it drives again."""
        for source in self._sources.values():
            source.blocked |= not source.axes.neutral
        self.driving = None

    def remove(self, key: Hashable) -> bool:
        """Forget a publisher that has left; return whether it drove."""
        self._sources.pop(key, None)
        drove = key == self.driving and key is not None
        if drove:
            self.driving = None
        return drove

    def axes(self, now: float) -> Axes:
        """Return the demand now."""
        self._expire(now)
        return NEUTRAL if self.driving is None else self._sources[self.driving].axes

    def _expire(self, now: float) -> None:
        for key in [key for key, source in self._sources.items() if now >= source.until]:
            self.remove(key)
