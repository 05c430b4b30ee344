"""A screen beside those of the program: what the SCREENS table must be able to take."""

from __future__ import annotations

from groundstation.ui.base.screen import ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState


class ExtraScreen(ConsoleScreen):
    """Keeps the display states that it is shown."""

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self.shown: list[DisplayState] = []

    def show_body(self, now: DisplayState) -> None:
        self.shown.append(now)
