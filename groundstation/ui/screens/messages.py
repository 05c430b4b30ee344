"""Messages screen: every message by its source with its rate, and the fields of one of them."""

from __future__ import annotations

from collections.abc import Iterable

from textual import events
from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Input

from groundstation.ui.display_state import ScreenKey
from groundstation.ui.messages_model import MessagesModel, key_of
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.message_detail import MessageDetail, MessageDetailValue, detail_lines
from groundstation.ui.widgets.message_table import MessageTable, MessageTableValue, format_age
from groundstation.views import MESSAGE_ORDERS, MessagesPage, MessageView, View, ViewRequest

TITLES = 1
"""Line of titles in the table."""

WIDE = 120
"""Columns from which on the table has more of its columns, and the fields have columns."""

STEPS = {"up": -1, "down": 1, "pageup": -1, "pagedown": 1, "home": -1, "end": 1}
"""Key -> direction in which it moves."""


class MessagesScreen(ConsoleScreen):
    """Table beside detail. TAB chooses which of them the arrows move in."""

    CSS_PATH = "messages.tcss"
    KEYS = (
        ScreenKey("slash", "Filter", "Show messages by words: a name, >5Hz, age>3, src:1/1, field:volt, sent"),
        ScreenKey("enter", "Open", "Open or close the source"),
        ScreenKey("o", "Order", "Next order: by source, name, rate, bytes, age"),
        ScreenKey("z", "Freeze", "Freeze the picture, or go on"),
        ScreenKey("tab", "Fields", "Scroll the fields, or the messages again"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = MessagesModel()
        self._table = MessageTable(MessageTableValue(), id="table")
        self._detail = MessageDetail(MessageDetailValue(), id="detail")
        self._field = Input(id="filter", placeholder="name, >5Hz, age>3, src:1/1, field:volt; ENTER keeps, ESC clears")
        self._in_detail = self._frozen = False

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the table, the detail and the text of the filter, which is hidden until it is asked for."""
        self._table.border_title = "messages"
        self._detail.border_title = "fields"
        return Horizontal(self._table, self._detail, id="panels"), self._field

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the rows around the window and for the selected message; none while frozen."""
        if self._frozen:
            return ()
        message = self._model.message_request
        return (self._model.page_request(self._height), *([message] if message else []))

    def show_view(self, view: View) -> None:
        """Show a page, or a message if it is still the selected one."""
        if self._frozen:
            return
        if isinstance(view, MessagesPage):
            self._model.add(view, self._height)
            self._show_table()
        elif isinstance(view, MessageView) and self._is_selected(view):
            self._show_message(view)

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the panels, and show the rows at the size that the table has then."""
        self.set_class(event.size.width >= WIDE, "-wide")
        self.call_after_refresh(self._show_table)

    @property
    def hint(self) -> str:
        """Return what the table shows."""
        parts = ["FROZEN, z goes on"] if self._frozen else []
        parts += [f"order: {self._model.order}"] if self._model.order != MESSAGE_ORDERS[0] else []
        parts += [f"filter “{self._model.text}”"] if self._model.text else []
        if self._model.page.not_shown:
            parts.append(f"{self._model.page.not_shown} messages of further sources not listed")
        return " · ".join([*parts, "ESC goes back to Drive"])

    @property
    def takes_text(self) -> bool:
        """Return whether the text of the filter is edited."""
        return self.focused is self._field

    # ---- keys ----

    def on_key(self, event: events.Key) -> None:
        """Handle the keys of this screen; those of other screens go on to the app."""
        if self.takes_text:
            self._handle_text_key(event)
            return
        if event.key in STEPS:
            event.stop()
            self._move(event.key)
        elif event.key in _ACTIONS:
            event.stop()
            _ACTIONS[event.key](self)
        self._show_table()
        self.show_state(self._state)

    def _handle_text_key(self, event: events.Key) -> None:
        """Handle what the field has not: Escape, and the keys behind "/" in one read, which come here."""
        if event.key == "escape":
            event.stop()
            self._end_text("")
        elif event.key == "enter":
            event.stop()
            self._end_text(self._field.value)
        elif event.is_printable and event.character:
            event.stop()
            self._field.insert_text_at_cursor(event.character)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Filter while the text is typed."""
        self._model.set_filter(event.value)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Keep the text."""
        self._end_text(event.value)

    def _begin_text(self) -> None:
        self._frozen = False
        self._field.display = True
        self.set_focus(self._field)  # at once: the next keys of the same read are text

    def _end_text(self, text: str) -> None:
        self._field.value = text
        self._field.display = bool(text)
        self.set_focus(None)
        self._model.set_filter(text)

    def _next_order(self) -> None:
        self._frozen = False
        self._model.next_order()

    def _toggle_source(self) -> None:
        self._model.toggle_source()

    def _freeze(self) -> None:
        self._frozen = not self._frozen

    def _swap_panel(self) -> None:
        self._in_detail = not self._in_detail
        self.set_class(self._in_detail, "-detail")

    def _move(self, key: str) -> None:
        page = (self._detail.size.height if self._in_detail else self._height) - 1
        rows = STEPS[key] * {"up": 1, "down": 1, "home": 10**6, "end": 10**6}.get(key, max(1, page))
        if self._in_detail:
            self._scroll_detail(rows)
            return
        self._model.move(rows, self._height)
        self._clear_other_message()

    def _scroll_detail(self, rows: int) -> None:
        value, size = self._detail.value, self._detail.size
        lines = len(detail_lines(value.view, size.width)) if value.view else 0
        top = max(0, min(lines - size.height, value.top + rows))
        self._detail.show(MessageDetailValue(value.view, top))

    # ---- what is shown ----

    @property
    def _height(self) -> int:
        """Rows of messages that the table shows."""
        return max(1, self._table.size.height - TITLES)

    def _is_selected(self, view: MessageView) -> bool:
        return (view.system, view.component, view.sent, view.name) == self._model.selected

    def _clear_other_message(self) -> None:
        """Show no fields of a message that is not selected any more."""
        view = self._detail.value.view
        if view is not None and not self._is_selected(view):
            self._detail.show(MessageDetailValue())
            self._detail.border_title, self._detail.border_subtitle = "fields", ""

    def _show_table(self) -> None:
        model, page = self._model, self._model.page
        rows = model.window(self._height)
        selected = next((at for at, row in enumerate(rows) if key_of(row) == model.selected), -1)
        self._table.show(MessageTableValue(rows, selected, model.order == MESSAGE_ORDERS[0], model.closed))
        self._table.border_subtitle = f"{page.kinds} kinds · {page.rate:.0f}/s · {page.bytes / 1000:.1f} kB/s"

    def _show_message(self, view: MessageView) -> None:
        self._detail.show(MessageDetailValue(view, self._detail.value.top if self._in_detail else 0))
        self._detail.border_title = f"{view.name} #{view.id}" if view.fields else view.name
        self._detail.border_subtitle = (
            f"{view.system}/{view.component} · {view.rate:.1f} Hz · {view.length} B · {format_age(view.age)} s ago"
        )


_ACTIONS = {
    "slash": MessagesScreen._begin_text,
    "enter": MessagesScreen._toggle_source,
    "o": MessagesScreen._next_order,
    "z": MessagesScreen._freeze,
    "tab": MessagesScreen._swap_panel,
}
"""Key -> what it does; MessagesScreen.KEYS has their names."""
