"""ReplayFollower: what the app does when a log moves, on whatever screen."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol, runtime_checkable

from groundstation.snapshot import ReplayStatus
from groundstation.ui.base.screen import ConsoleScreen

REFUSED = "replay: nothing is sent to a vehicle"


@runtime_checkable
class Restartable(Protocol):
    """Something that screens keep and that holds data of the past, which a move in a log makes void."""

    def restart(self) -> None:
        """Forget the data."""


class ReplayFollower:
    """Compares the status of a replay with the one before. `kept`: what screens keep; `shown`: the visible screen."""

    def __init__(self, kept: Mapping[type, Any], shown: Callable[[], ConsoleScreen | None]) -> None:
        self._kept = kept
        self._shown = shown
        self._before: ReplayStatus | None = None

    def follow(self, replay: ReplayStatus | None) -> None:
        """Forget what was received before a move, and say when a request went nowhere."""
        before, self._before = self._before, replay
        if replay is None or before is None:
            return
        if replay.seeks != before.seeks:
            for model in self._kept.values():
                if isinstance(model, Restartable):
                    model.restart()
        if replay.refused != before.refused and (shown := self._shown()) is not None:
            shown.say(REFUSED)
