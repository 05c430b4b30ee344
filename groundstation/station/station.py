"""Station: an OperatorCore with a ScreenFeed, for every process that shows what it does."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.input.style import Style
from groundstation.intents.vehicle import TAKE_OFF_ALTITUDE
from groundstation.snapshot import Snapshot
from groundstation.station.core_parts import CoreParts
from groundstation.station.operator_core import OperatorCore
from groundstation.station.screen_feed import ScreenFeed
from groundstation.station.views.param_texts import ParamTexts


class Station(OperatorCore):
    """A core (link/core.py). `system` is our system id, `session` a random number."""

    def __init__(
        self,
        endpoints: Sequence[str],
        *,
        system: int = 255,
        style: Style = Style.HOLD,
        speed: float = 0.6,
        take_off: float = TAKE_OFF_ALTITUDE,
        session: int = 0,
        texts: ParamTexts = ParamTexts(),  # noqa: B008 - frozen
        now: float = 0.0,
    ) -> None:
        parts = CoreParts(
            endpoints,
            system=system,
            style=style,
            speed=speed,
            take_off=take_off,
            session=session,
            docs_cache=texts.cache,
            now=now,
        )
        self.feed = ScreenFeed(parts, texts)
        super().__init__(parts, self.feed)
        self.intents.add(self.feed.handlers)
        self.views, self.notes = self.feed.views, self.feed.notes

    def snapshot(self, now: float, wall: float) -> Snapshot:
        """Build the snapshot for the screens, without any effect; see ScreenFeed."""
        return self.feed.snapshot(now, wall)
