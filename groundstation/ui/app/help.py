"""Help screen: the keys of the screen it was opened on, then all others, in columns; `/` filters them."""

from __future__ import annotations

from textual import events
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.widget import Widget
from textual.widgets import Static

from groundstation.actions import ACTIONS
from groundstation.screens import SCREENS
from groundstation.ui.app.help_text import HelpSection, build_sections, lay_out
from groundstation.ui.app.navigation import load_screen
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.own_dismissal import OwnDismissal
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.wrap import plain
from groundstation.ui.widgets.line_field import FieldUse


class HelpScreen(OwnDismissal[None], ConsoleScreen):
    """Sections of keys; any key that does not scroll or filter goes back, the key of another screen opens it."""

    ROWS = ()
    CSS_PATH = "help.tcss"

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._own = context.came_from()
        keys = {row.id: load_screen(row).KEYS for row in SCREENS}
        self._sections = build_sections(context.keymap, self._own, keys)
        self._filter = ""
        self._text = Static(markup=False)
        self._page = VerticalScroll(self._text, id="page", can_focus=False)

    def compose(self) -> ComposeResult:
        """Lay out one scrolling page, and the field of the filter below it."""
        self._page.border_title = plain(f"keys · {self._own.title} first · map “{self.context.keymap.name}”")
        yield self._page
        yield self.field
        yield from self.build_pane()

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the columns for the new size."""
        self._show()

    def perform_key(self, event: events.Key) -> bool:
        """Scroll, filter, or go back to the screen before."""
        action = self.context.keymap.get_action(event.key)
        if rows := rows_to_move(event.key, self._page.size.height):
            self._page.scroll_relative(y=rows, animate=False)
        elif event.key == "slash":
            self._open_filter()
        elif action is not None and action.id in _OTHER_SCREENS:
            return False
        else:
            self._go_back()
        return True

    def choose_panel_of(self, widget: Widget) -> tuple[str, str]:
        """Scroll the page wherever the wheel turns."""
        return LIST_ARROWS

    @property
    def kept_filter(self) -> str:
        """The text of the filter."""
        return self._filter

    def filter_by(self, text: str) -> bool:
        """Show the keys that contain each word of a text."""
        self._filter_text(text)
        return True

    def _filter_text(self, text: str) -> None:
        self._filter = text
        self._page.scroll_home(animate=False)
        self._show()

    def _open_filter(self) -> None:
        use = FieldUse(self._filter_text, self._filter_text, cancel=lambda: self._filter_text(""))
        placeholder = "words of a key's text; ENTER keeps them, ESC shows all"
        self.field.open(use, text=self._filter, placeholder=placeholder, selected=True)

    def _go_back(self) -> None:
        """Open the screen on which the help was asked for; on Drive only close this one."""
        if self._own is SCREENS[0]:
            self.dismiss()
        elif self.is_active:
            self.context.perform(ACTIONS[self._own.action])

    def _show(self) -> None:
        found = self._found()
        width = self.room[0] - _FRAME
        lines = lay_out(found, max(1, width))
        self._text.update(Content("\n").join(Content.assemble(*line) for line in lines))
        kept = f"with “{self._filter}” · " if self._filter else ""
        self._page.border_subtitle = plain(f"{kept}↑ ↓ scroll · / search · any other key goes back")

    def _found(self) -> list[HelpSection]:
        if not self._filter:
            return self._sections
        found = [each for each in (each.matching(self._filter) for each in self._sections) if each.rows]
        return found or [HelpSection(f"no key with “{self._filter}”", ())]


_FRAME = 7
"""Cells of the frame, the padding and the scroll bar."""

_OTHER_SCREENS = frozenset(row.action for row in SCREENS if not row.target.endswith(f":{HelpScreen.__name__}"))
