"""Keys whose caps are lit: those that went down just now, sooner than a snapshot can report them."""

from __future__ import annotations

LIT = 0.15
"""s for which a cap stays lit after a press; by then a snapshot (within 0.1 s) has reported which keys are held."""


class PressedKeys:
    """The keys by name. Time is an argument."""

    def __init__(self) -> None:
        self._until: dict[str, float] = {}

    @property
    def names(self) -> frozenset[str]:
        """The keys whose caps are lit."""
        return frozenset(self._until)

    def press(self, key: str, now: float) -> None:
        """Light the cap of a key."""
        self._until[key] = now + LIT

    def release(self, key: str) -> None:
        """Switch it off."""
        self._until.pop(key, None)

    def expire(self, now: float) -> None:
        """Switch off those that are lit for long enough."""
        self._until = {key: until for key, until in self._until.items() if now < until}
