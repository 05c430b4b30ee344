"""Intents of the Replay screen. A station with links ignores them."""

from __future__ import annotations

from groundstation.intents.base import Intent


class ReplayPlay(Intent, frozen=True):
    """Play, or pause."""

    playing: bool = False


class ReplayReverse(Intent, frozen=True):
    """Play in the other direction."""


class ReplayMove(Intent, frozen=True):
    """Move by so many seconds, back where negative."""

    seconds: float


class ReplayStep(Intent, frozen=True):
    """Move by so many messages, back where negative."""

    messages: int


class ReplayNextEvent(Intent, frozen=True):
    """Move to the next event, or the one before where `step` is -1."""

    step: int = 1


class ReplayShowEvent(Intent, frozen=True):
    """Move to an event by its number."""

    number: int


class ReplayGoTo(Intent, frozen=True):
    """Move to a time: `12:04:10`, `+30`, `-30` or `1:23`."""

    text: str


class ReplaySpeed(Intent, frozen=True):
    """Play faster, or slower where `step` is -1."""

    step: int = 1


class ReplayMark(Intent, frozen=True):
    """Mark this moment as A, then as B."""


class ReplayLoop(Intent, frozen=True):
    """Play from A to B again and again, or no more."""


class ReplaySearch(Intent, frozen=True):
    """Search a text, a message or a condition; an empty text ends the search."""

    text: str
