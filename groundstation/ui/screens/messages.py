"""Messages screen: every message by its source with its rate, and the fields of one of them."""

from __future__ import annotations

from collections.abc import Iterable

from textual import events
from textual.containers import Horizontal
from textual.widget import Widget

from groundstation.ui.display_state import ScreenKey
from groundstation.ui.list_keys import rows_to_move
from groundstation.ui.messages_model import MessagesModel, key_of
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.message_detail import MessageDetail, MessageDetailValue, detail_lines
from groundstation.ui.widgets.message_table import MessageTable, MessageTableValue, format_age
from groundstation.views.base import View, ViewRequest
from groundstation.views.messages import MESSAGE_ORDERS, MessagesPage, MessageView

TITLES = 1
"""Line of titles in the table."""

WIDE = 120
"""Columns from which on the table has more of its columns, and the fields have columns."""


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
        self._in_detail = self._frozen = False

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the table beside the detail."""
        panels = self.build_panel(self._table, "messages"), self.build_panel(self._detail, "fields")
        return (Horizontal(*panels, id="panels"),)

    def on_mount(self) -> None:
        """Mark the panel that the arrows scroll."""
        self._mark_chosen()

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
    def advice(self) -> str:
        """Return what the table shows."""
        parts = ["FROZEN, z goes on"] if self._frozen else []
        parts += [f"order: {self._model.order}"] if self._model.order != MESSAGE_ORDERS[0] else []
        parts += [f"filter “{self._model.text}”"] if self._model.text else []
        if self._model.page.not_shown:
            parts.append(f"{self._model.page.not_shown} messages of further sources not listed")
        return " · ".join([*parts, "ESC goes back to Drive"])

    # ---- keys ----

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if rows := rows_to_move(event.key, self._detail.size.height if self._in_detail else self._height):
            self._move(rows)
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        self._show_table()
        return True

    def _open_filter(self) -> None:
        self._frozen = False
        use = FieldUse(self._model.set_filter, self._model.set_filter, cancel=lambda: self._model.set_filter(""))
        placeholder = "name, >5Hz, age>3, src:1/1, field:volt; ENTER keeps, ESC clears"
        self.field.open(use, text=self._model.text, placeholder=placeholder)

    def _next_order(self) -> None:
        self._frozen = False
        self._model.next_order()

    def _toggle_source(self) -> None:
        self._model.toggle_source()

    def _freeze(self) -> None:
        self._frozen = not self._frozen

    def _swap_panel(self) -> None:
        self._in_detail = not self._in_detail
        self._mark_chosen()

    def _mark_chosen(self) -> None:
        self._detail.set_class(self._in_detail, "-chosen")
        self._table.set_class(not self._in_detail, "-chosen")

    def _move(self, rows: int) -> None:
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
    "slash": MessagesScreen._open_filter,
    "enter": MessagesScreen._toggle_source,
    "o": MessagesScreen._next_order,
    "z": MessagesScreen._freeze,
    "tab": MessagesScreen._swap_panel,
}
"""Key -> what it does; MessagesScreen.KEYS has their names."""
