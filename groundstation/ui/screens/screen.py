"""ConsoleScreen: what the app and a screen know of each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from textual.screen import Screen

from groundstation.input.keymap import Keymap
from groundstation.intents import AnyIntent, OperatorAction
from groundstation.ui.display_state import DisplayState


@dataclass(frozen=True, slots=True)
class ScreenContext:
    """What every screen gets from the app."""

    keymap: Keymap
    send: Callable[[AnyIntent], None]
    """Sends an intent to the station."""
    perform: Callable[[OperatorAction], None]
    """Performs an action of the app itself, such as opening another screen."""


class ConsoleScreen(Screen[None]):
    """A screen of the SCREENS table. Keys that it does not stop go to the app: screen keys, and Escape goes back."""

    AUTO_FOCUS = ""

    def __init__(self, context: ScreenContext) -> None:
        super().__init__()
        self.context = context

    def show_state(self, now: DisplayState) -> None:
        """Show a display state; called at up to 16 Hz while the screen is mounted. Draws nothing unless overridden."""
