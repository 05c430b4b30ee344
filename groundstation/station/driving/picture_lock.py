"""The picture lock: a driver who drives by the picture of a camera drives only while that picture is fresh.

The screen says when the newest picture was taken, on the clock that both processes have. So a screen, a decoder, a
network or a camera that stands still ends in the same way: nothing newer is said.
"""

from __future__ import annotations

from groundstation.intents.driving import CLOCK_ERROR, OLDEST_PICTURE, DriveByPicture

REASON = "the picture is old"


class PictureLock:
    """Whether the picture keeps keys from driving."""

    def __init__(self) -> None:
        self._drives = False
        self._until = 0.0

    def handle(self, intent: DriveByPicture, now: float) -> None:
        """Note what the screen says of its newest picture."""
        self._drives, self._until = intent.drives, _end_of(intent, now)

    def prolong(self, intent: DriveByPicture, now: float) -> bool:
        """Note a newer picture of a driver whose keys drive by pictures, which changes nothing but until when they do.

        Returns False if it is something else.
        """
        until = _end_of(intent, now)
        if not (self._drives and intent.drives and now < self._until <= until):
            return False
        self._until = until
        return True

    def refusal(self, now: float) -> str | None:
        """Return why keys do not drive, or None."""
        return REASON if self._drives and not now < self._until else None

    @property
    def ends_at(self) -> float | None:
        """When keys stop driving unless a newer picture follows; None: they do not."""
        return self._until if self._drives else None


def _end_of(intent: DriveByPicture, now: float) -> float:
    """Return until when keys drive by a picture."""
    plausible = intent.taken_at <= now + CLOCK_ERROR
    return min(intent.taken_at, now) + OLDEST_PICTURE if plausible else 0.0
