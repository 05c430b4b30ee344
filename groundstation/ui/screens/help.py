"""The help screen: every key and what it does, from the table of actions."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.screen import Screen
from textual.widgets import Static

from groundstation.input.keymap import CONFIRM_KEY, Keymap
from groundstation.intents import ACTIONS
from groundstation.ui.colours import BLUE, DIM, RED, YELLOW
from groundstation.ui.keynames import format_key

TITLES = {
    "drive": "Drive", "stop": "Stop", "speed": "Speed limits", "vehicle": "Vehicle", "app": "Ground station",
}  # fmt: skip
"""Group of actions -> its heading, in this order."""

_NOTES = (
    "Any key that drives nothing is a stop key while the vehicle is driven. The emergency stop works on every screen.",
    "Keys drive only on the Drive screen and while this window has the focus; leaving either stops the vehicle.",
)


class HelpScreen(Screen[None]):
    """Two columns of text; any key that does not scroll goes back."""

    CSS_PATH = "help.tcss"

    def __init__(self, keymap: Keymap) -> None:
        super().__init__()
        self._keymap = keymap

    def compose(self) -> ComposeResult:
        """One scrolling page."""
        with VerticalScroll(id="page") as page:
            page.border_title = f"keys · map “{self._keymap.name}”"
            page.border_subtitle = "↑ ↓ scroll · any other key goes back"
            yield Static(Content.assemble(*self._lines()))

    def on_key(self, event: events.Key) -> None:
        """Back to the Drive screen."""
        if event.key not in ("up", "down", "pageup", "pagedown", "home", "end"):
            event.stop()
            if self.is_current:  # the second key of one read comes here too, and would take the Drive screen away
                self.dismiss()

    def _lines(self) -> Iterator[tuple[str, str]]:
        for group, title in TITLES.items():
            yield f"{title}\n", f"bold {BLUE}"
            for action in ACTIONS.values():
                keys = self._keymap.get_keys(action.id)
                if action.group == group and keys:
                    yield f"  {_written(keys, confirm=action.confirm):<14}", RED if group == "stop" else YELLOW
                    yield f"{action.help}\n", ""
            yield "\n", ""
        for note in _NOTES:
            yield f"{note}\n", DIM


def _written(keys: tuple[str, ...], *, confirm: bool) -> str:
    names = "  ".join(format_key(key) for key in keys)
    return f"{names}, then {CONFIRM_KEY}" if confirm else names
