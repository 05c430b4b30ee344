"""Permission: whether keys drive, judged once for each intent and each tick, and handed to all that depend on it."""

from __future__ import annotations

import msgspec


class Permission(msgspec.Struct, frozen=True):
    """What DrivingController.judge has found at one moment."""

    screen: str | None
    """Why the screen keeps keys from driving; None when it does not."""
    reason: str | None
    """Why keys do not drive the selected vehicle, as a text for the driver; None when they do."""
    controlled: frozenset[int] = frozenset()
    """System ids of the armed vehicles that we control."""
