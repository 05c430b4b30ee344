"""Go-to menu: the screens and the digit of each, over the screen that is shown. Any other key closes it."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events
from textual.app import ComposeResult
from textual.content import Content
from textual.screen import ModalScreen
from textual.widgets import Static

from groundstation.actions import ACTIONS, OperatorAction
from groundstation.screens import SCREENS
from groundstation.ui.base.own_dismissal import OwnDismissal
from groundstation.ui.base.screen import ScreenContext
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.look.colours import DIM, YELLOW
from groundstation.ui.terminal.key_parser import KeyRepeat

NEXT_VEHICLE = "n"

BEFORE = "before"
"""Result: the screen that was shown before."""


class GoToMenu(OwnDismissal[str], ModalScreen[str]):
    """Gives the id of a row of SCREENS, BEFORE, or "" to stay. Keys do not drive meanwhile."""

    AUTO_FOCUS = ""
    DEFAULT_CSS = """
    GoToMenu { align: right bottom; background: transparent; }
    GoToMenu #menu {
        width: auto; height: auto; margin: 1 1 2 1; padding: 0 1;
        border: round $primary; border-title-color: $primary; background: $panel;
    }
    """

    def __init__(self, context: ScreenContext) -> None:
        super().__init__()
        self.context = context

    def compose(self) -> ComposeResult:
        """Lay out one box in the corner, so that the top line and the alerts stay visible."""
        menu = Static(Content.assemble(*self._lines()), id="menu")
        menu.border_title = "go to"
        yield menu

    def _lines(self) -> Iterator[tuple[str, str]]:
        key = f"bold {YELLOW}"
        for row in SCREENS:
            if row.in_tabs:
                yield f"{row.digit:<4}", key
                yield f"{row.title}\n", ""
        yield f"{NEXT_VEHICLE:<4}", key
        yield f"{ACTIONS['vehicle.next'].label}\n", ""
        for name in self.context.keymap.get_keys("app.goto")[:1]:
            yield f"{format_key(name):<4}", key
            yield "the screen before\n", ""
        yield f"{'ESC':<4}", key
        yield "stays here", DIM

    def on_key(self, event: events.Key) -> None:
        """Choose; a key that means nothing here closes the menu."""
        event.stop()
        if isinstance(event, KeyRepeat) or not self.is_current:  # the second key of one read comes here, too
            return
        if event.key == NEXT_VEHICLE:
            self._perform(ACTIONS["vehicle.next"])
        self.dismiss(self._choose(event.key))

    def _choose(self, key: str) -> str:
        action = self.context.keymap.get_action(key)
        if action is not None and action.id == "app.goto":
            return BEFORE
        rows = (row for row in SCREENS if row.digit == key or (action is not None and row.action == action.id))
        return next((row.id for row in rows), "")

    def _perform(self, action: OperatorAction) -> None:
        if action.intent is not None:
            self.context.send(action.intent)
