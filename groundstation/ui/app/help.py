"""Help screen: every key and what it does, from the table of actions, and what the status line means."""

from __future__ import annotations

from collections.abc import Iterator

from textual import events
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widgets import Static

from groundstation.actions import ACTIONS
from groundstation.screens import SCREENS, ScreenRow
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.own_dismissal import OwnDismissal
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.display.wrap import plain
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.look.colours import BLUE, DIM, RED, YELLOW

TITLES = {
    "drive": "Drive", "stop": "Stop", "speed": "Speed limits", "view": "Pane of the Drive screen",
    "vehicle": "Vehicle", "app": "Ground station",
}  # fmt: skip
"""Group of actions -> its heading, in this order."""

STATUS_LINE = (
    ("link", "bars for loss: 4 up to 2 %, 3 up to 10 %, 2 up to 25 %, then 1"),
    ("loss", "frames of the vehicle lost over the last 5 s"),
    ("rtt", "round trip to the vehicle and back (TIMESYNC)"),
    ("sent", "MANUAL_CONTROL frames sent per second"),
    ("cmd", "age of the newest demand that the vehicle has taken; from 450 ms on our vehicle stops"),
    ("key→motor", "time from a changed demand to the vehicle that applies it"),
    ("tty", "round trip to this terminal; without answers keys do not drive"),
    ("pre-arm", "the vehicle's checks before arming; the log has the reasons"),
    ("gps, batt", "GPS fix and satellites; battery voltage and charge"),
)
"""Readings of the status line, in its order, and their meaning."""

_NOTES = (
    "Any key without a drive action stops the vehicle while it is driven, but for the speed keys, v, PgUp and PgDn.",
    "The emergency stop works on every screen.",
    "Keys drive only on the Drive screen and while this window has the focus; leaving either stops the vehicle.",
    "Back on Drive, without key releases: a drive key counts once none was pressed or repeated for 0.75 s.",
    "In a text field SPACE and k are text: ^k stops there, and ! is the emergency stop as everywhere.",
    "The limits are the largest demand that a key sends: speed and turn, in percent of the full range.",
    "Where the terminal reports key releases, keys of a Cyrillic or Greek layout count by their position.",
    "Mouse reports are captured, so that the wheel cannot drive as arrow keys: Shift and drag selects text.",
)

_MIN_WIDTH = 12
"""Cells of the column of keys; it is wider where a key map or a gamepad adds longer ones."""

_SCROLL_KEYS = ("up", "down", "pageup", "pagedown", "home", "end")


class HelpScreen(OwnDismissal[None], ConsoleScreen):
    """Two columns of text; any key that does not scroll goes back, the key of another screen opens it."""

    AUTO_FOCUS = "#page"
    ROWS = ()
    CSS_PATH = "help.tcss"

    def compose(self) -> ComposeResult:
        """Lay out one scrolling page."""
        with VerticalScroll(id="page") as page:
            page.border_title = plain(f"keys · map “{self.context.keymap.name}”")
            page.border_subtitle = "↑ ↓ scroll · any other key goes back"
            yield Static(Content.assemble(*self._lines()))

    def perform_key(self, event: events.Key) -> bool:
        """Go back to the Drive screen."""
        action = self.context.keymap.get_action(event.key)
        if event.key in _SCROLL_KEYS or (action is not None and action.id in _OTHER_SCREENS):
            return False
        self.dismiss()
        return True

    def _lines(self) -> Iterator[tuple[str, str]]:
        keymap = self.context.keymap
        keys = {
            action.id: _key_list(keymap.get_keys(action.id), confirm=action.confirm)
            for action in ACTIONS.values()
            if keymap.get_keys(action.id)
        }
        width = max(_MIN_WIDTH, *map(len, keys.values())) + 2
        for group, title in TITLES.items():
            yield f"{title}\n", f"bold {BLUE}"
            for action in ACTIONS.values():
                if action.group == group and action.id in keys:
                    yield f"  {keys[action.id]:<{width}}", RED if group == "stop" else YELLOW
                    yield f"{action.help}\n", ""
            yield "\n", ""
        for row in SCREENS:
            yield from _screen_keys(row, width)
        yield "Status line\n", f"bold {BLUE}"
        for name, meaning in STATUS_LINE:
            yield f"  {name:<{width}}", YELLOW
            yield f"{meaning}\n", ""
        yield "\n", ""
        for note in _NOTES:
            yield f"{note}\n", DIM


_OTHER_SCREENS = frozenset(row.action for row in SCREENS if not row.target.endswith(f":{HelpScreen.__name__}"))


def _screen_keys(row: ScreenRow, width: int) -> Iterator[tuple[str, str]]:
    """Yield the keys that a screen has beside the actions."""
    keys = load_screen(row).KEYS
    if not keys:
        return
    yield f"{row.title} screen\n", f"bold {BLUE}"
    for key in keys:
        yield f"  {format_key(key.key):<{width}}", YELLOW
        yield f"{key.help}\n", ""
    yield "\n", ""


def _key_list(keys: tuple[str, ...], *, confirm: bool) -> str:
    names = "  ".join(format_key(key) for key in keys)
    return f"hold {names}" if confirm else names
