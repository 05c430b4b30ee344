"""How old the picture is that is shown: the time since the last one that differs from the one before."""

from __future__ import annotations

from enum import StrEnum

import msgspec

from groundstation.pictures.picture import Picture

OLD_AFTER = 0.5
"""s without a new picture after which nobody should drive by it, as long as MAN_TIMEOUT of the vehicle."""


class Freshness(StrEnum):
    """What a picture is worth."""

    NONE = "no picture yet"
    FRESH = "fresh"
    LATE = "no new picture"
    """None has come."""
    FROZEN = "frozen"
    """Some came, with the same pixels."""


class PictureState(msgspec.Struct, frozen=True):
    """What the viewer shows beside the picture."""

    freshness: Freshness
    age: float = 0.0
    """s since the last new picture; of a frozen one since its first copy."""

    @property
    def fresh(self) -> bool:
        """Return whether one may trust it."""
        return self.freshness is Freshness.FRESH


class PictureAge:
    """The age of the newest picture. Times are of one clock that never goes back."""

    def __init__(self) -> None:
        self._newest: Picture | None = None
        self._stamp: float | None = None
        self._new_at = self._came_at = 0.0

    @property
    def new_at(self) -> float:
        """When the newest picture came."""
        return self._new_at

    def note(self, picture: Picture, now: float, stamp: float | None = None) -> bool:
        """Note a picture that has come. Returns whether it differs from the one before, by its stamp if it has one."""
        new = picture != self._newest if stamp is None else stamp != self._stamp
        self._stamp = stamp
        if new:
            self._newest, self._new_at = picture, now
        self._came_at = now
        return new

    def judge(self, now: float) -> PictureState:
        """Return what the newest picture is worth now."""
        if self._newest is None:
            return PictureState(Freshness.NONE)
        age = max(0.0, now - self._new_at)
        if age <= OLD_AFTER:
            return PictureState(Freshness.FRESH, age)
        came = now - self._came_at <= OLD_AFTER
        return PictureState(Freshness.FROZEN if came else Freshness.LATE, age)
