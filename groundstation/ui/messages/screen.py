"""Messages screen: every message by its source with its rate; the fields of one of them, a plot, requests for it."""

from __future__ import annotations

from collections.abc import Iterable

import msgspec
from textual import events
from textual.containers import Horizontal, Vertical
from textual.widget import Widget

from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.charts.model import ChartsModel
from groundstation.ui.display.display_state import ScreenKey
from groundstation.ui.display.wrap import plain
from groundstation.ui.messages.byte_graph import ByteGraph, most_text
from groundstation.ui.messages.calls import MessageCalls, parse_rate
from groundstation.ui.messages.csv_file import MessageCsv
from groundstation.ui.messages.detail import MessageDetail, MessageDetailValue, detail_lines
from groundstation.ui.messages.field_cursor import FieldCursor
from groundstation.ui.messages.model import MessagesModel, key_of
from groundstation.ui.messages.plot import MessagePlot, MessagePlotValue
from groundstation.ui.messages.state import describe_silence, describe_traffic
from groundstation.ui.messages.table import MessageTable, MessageTableValue, format_age
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.views.base import View, ViewRequest
from groundstation.views.messages import MESSAGE_ORDERS, CapturePage, MessagesPage, MessageView
from groundstation.views.requests import RequestsView

TITLES = 1
"""Line of titles in the table."""

WIDE = 120
"""Columns from which on the table has more of its columns, and the fields have columns."""


TALL = 36
"""Rows from which on the bytes a second stand below the table; in smaller terminals in place of a plot."""


class MessagesScreen(ConsoleScreen):
    """Table beside detail. TAB chooses which of them the arrows move in."""

    CSS_PATH = "screen.tcss"
    KEYS = (
        ScreenKey("slash", "Filter", "Show messages by words: a name, >5Hz, age>3, src:1/1, field:volt, sent, lost"),
        ScreenKey("enter", "Open", "Open or close the source"),
        ScreenKey("o", "Order", "Next order: by source, name, rate, bytes, age"),
        ScreenKey("tab", "Fields", "Choose a field with ↑ ↓ (an item of an array: ← →), or a message again"),
        ScreenKey("p", "To Charts", "Record the chosen field for the Charts screen, also while that is closed"),
        ScreenKey("R", "Rate", "Request the chosen message at a rate (SET_MESSAGE_INTERVAL)", commands=True),
        ScreenKey("Q", "Once", "Request the chosen message once (REQUEST_MESSAGE)", commands=True),
        ScreenKey("S", "Save", "Write each of the chosen messages to a CSV file while this screen is open; S ends it"),
        ScreenKey("e", "Raw", "Show values as they are sent, or with units and names of enum values"),
        ScreenKey("z", "Freeze", "Freeze the picture, or go on"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = MessagesModel()
        self._table = MessageTable(MessageTableValue(), id="table")
        self._detail = MessageDetail(MessageDetailValue(), id="detail")
        self._plot = MessagePlot(MessagePlotValue(), id="plot")
        self._graphs = ByteGraph((), id="bytes"), ByteGraph((), id="bytes-beside")
        self._in_detail = self._frozen = self._raw = False
        self._field = FieldCursor()
        self._calls = MessageCalls(context.numbers)
        self._csv = MessageCsv(context.folder)

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the table over the bytes a second, beside the fields over their plot."""
        below, beside = (self.build_panel(graph, "bytes a second") for graph in self._graphs)
        left = Vertical(self.build_panel(self._table, "messages"), below, id="left")
        right = Vertical(self.build_panel(self._detail, "fields"), self._plot, beside, id="right")
        return (Horizontal(left, right, id="panels"),)

    def on_mount(self) -> None:
        """Mark the panel that the arrows scroll."""
        self._mark_chosen()

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for rows and the selected message, neither while frozen; for a file; for answers."""
        others: list[ViewRequest] = [each for each in (self._csv.request, self._calls.request) if each is not None]
        if self._frozen:
            return tuple(others)
        message = self._model.message_request
        if message is not None:
            others.insert(0, msgspec.structs.replace(message, field=self._chosen_field, index=self._field.index))
        return (self._model.page_request(self._height), *others)

    def show_view(self, view: View) -> None:
        """Show a page, or a message if it is still the selected one."""
        if isinstance(view, CapturePage):
            self.say(self._csv.add(view))
        elif isinstance(view, RequestsView):
            self.say(self._calls.show(view))
        elif self._frozen:
            return
        elif isinstance(view, MessagesPage):
            self._model.add(view, self._height)
            self._show_table()
        elif isinstance(view, MessageView) and self._is_selected(view):
            self._show_message(view)

    def on_unmount(self) -> None:
        """End the file that is written."""
        self._csv.close()

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the panels, and show the rows at the size that the table has then."""
        self.set_class(self.room.width >= WIDE, "-wide")
        self.set_class(self.room.width >= WIDE and self.room.height >= TALL, "-tall")
        self.call_after_refresh(self._show_table)

    @property
    def advice(self) -> str:
        """Return what the table shows."""
        traffic = describe_traffic(self._model.page, self._state.snapshot.links)
        parts = [*(["FROZEN, z goes on"] if self._frozen else []), *([traffic] if traffic else [])]
        parts += [self._csv.status] if self._csv.status else []
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
        elif self._in_detail and event.key in ("left", "right"):
            self._field.turn(-1 if event.key == "left" else 1)
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        self._show_table()
        return True

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the table or the fields."""
        if widget not in (self._detail, self._table):
            return None
        self._in_detail = widget is self._detail
        self._mark_chosen()
        self._show_table()
        return LIST_ARROWS

    @property
    def kept_filter(self) -> str:
        """The text of the filter."""
        return self._model.text

    def filter_by(self, text: str) -> bool:
        """Show the rows that the text describes."""
        self._model.set_filter(text)
        return True

    @property
    def marked_text(self) -> str:
        """The value of the field under the cursor; in the table the name of the message."""
        view = self._view
        if view is None:
            return ""
        field = next((each for each in view.fields if each.name == self._field.field), None)
        if not self._in_detail or field is None:
            return view.name
        return " ".join(part for part in (f"{view.name}.{field.name}", field.value, field.unit, field.meaning) if part)

    def _open_filter(self) -> None:
        self._frozen = False
        use = FieldUse(self._model.set_filter, self._model.set_filter, cancel=lambda: self._model.set_filter(""))
        placeholder = "name, >5Hz, age>3, src:1/1, field:volt; ENTER keeps, ESC clears"
        self.field.open(use, text=self._model.text, placeholder=placeholder, selected=True)

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
            if (view := self._view) is not None:
                self._field.move(view, rows)
                self._show_message(view)
            return
        self._model.move(rows, self._height)
        self._clear_other_message()

    def _toggle_raw(self) -> None:
        self._raw = not self._raw
        if (view := self._view) is not None:
            self._show_message(view)

    # ---- requests, charts, files ----

    def _pin(self) -> None:
        plot = self._plot.value.plot
        if plot is None:
            self.say("choose a message with ↑ ↓, then a number in it: TAB, ↑ ↓")
            return
        note, intent = self.context.keep(ChartsModel, self.context.folder).pin_field(plot.info.field, plot.info.unit)
        self.context.send(intent)
        self.say(note)

    def _ask_rate(self) -> None:
        view = self._requestable()
        if view is not None:
            use = FieldUse(lambda text: self._set_rate(view, text))
            self.field.open(use, placeholder=f"Hz for {view.name}; 0: the default of the vehicle, off: not at all")

    def _set_rate(self, view: MessageView, text: str) -> None:
        rate = parse_rate(text)
        if rate is None:
            self.say(f"“{text}” is not a rate: a number from 0 to 1000, or off")
        else:
            self.context.send(self._calls.set_rate(view, rate))

    def _request_once(self) -> None:
        view = self._requestable()
        if view is not None:
            self.context.send(self._calls.request_once(view))

    def _requestable(self) -> MessageView | None:
        """Return the chosen message if a vehicle can be asked for it; say why not."""
        view = self._view
        if view is None or view.sent:
            self.say("this station sends it" if view is not None else "choose a message with ↑ ↓")
            return None
        return view

    def _save(self) -> None:
        self.say(self._csv.toggle(self._model.message_request))

    # ---- what is shown ----

    @property
    def _height(self) -> int:
        """Rows of messages that the table shows."""
        return max(1, self._table.size.height - TITLES)

    @property
    def _view(self) -> MessageView | None:
        """The chosen message, if it is here."""
        view = self._detail.value.view
        return view if view is not None and self._is_selected(view) else None

    @property
    def _chosen_field(self) -> str:
        return "" if self._view is None else self._field.field

    def _is_selected(self, view: MessageView) -> bool:
        return (view.system, view.component, view.sent, view.name) == self._model.selected

    def _clear_other_message(self) -> None:
        """Show no fields of a message that is not selected any more."""
        view = self._detail.value.view
        if view is not None and not self._is_selected(view):
            self._detail.show(MessageDetailValue())
            self._plot.show(MessagePlotValue())
            self._detail.border_title, self._detail.border_subtitle = "fields", ""

    def _show_table(self) -> None:
        model, page = self._model, self._model.page
        rows = model.window(self._height)
        selected = next((at for at, row in enumerate(rows) if key_of(row) == model.selected), -1)
        note = "" if model.text else describe_silence(model.page, self._state.snapshot.links)
        self._table.show(MessageTableValue(rows, selected, model.order == MESSAGE_ORDERS[0], model.closed, note))
        for graph in self._graphs:
            graph.show(page.history)
            graph.border_subtitle = plain(most_text(page.history))
        self.set_class(self._view is None, "-no-message")
        self._table.border_subtitle = plain(f"{page.kinds} kinds · {page.rate:.0f}/s · {page.bytes / 1000:.1f} kB/s")

    def _show_message(self, view: MessageView) -> None:
        self._field.follow(view)
        self.remove_class("-no-message")
        self._detail.show(MessageDetailValue(view, self._top(view), self._field.field, self._raw))
        self._show_plot(view)
        self._detail.border_title = plain(f"{view.name} #{view.id}" if view.fields else view.name)
        self._detail.border_subtitle = plain(
            f"{view.system}/{view.component} · {view.rate:.1f} Hz · {view.length} B · {format_age(view.age)} s ago"
        )

    def _top(self, view: MessageView) -> int:
        """Return the first line to show, so that the chosen field is in the picture."""
        size = self._detail.size
        fields = [line.field for line in detail_lines(view, size.width, raw=self._raw)]
        at = fields.index(self._field.field) if self._field.field in fields else 0
        lines = len(fields)
        top = min(self._detail.value.top if self._in_detail else 0, at, max(0, lines - size.height))
        return max(top, at - size.height + 1, 0) if at < lines - 1 else max(0, lines - size.height)

    def _show_plot(self, view: MessageView) -> None:
        plot = view.plot
        if plot is not None and plot.info.field.field != self._field.field:
            return
        reason = f"{self._field.field} is not a number" if self._field.field else ""
        self._plot.show(MessagePlotValue(plot, reason if plot is None and self._plot.value.plot is None else ""))


_ACTIONS = {
    "slash": MessagesScreen._open_filter,
    "enter": MessagesScreen._toggle_source,
    "o": MessagesScreen._next_order,
    "z": MessagesScreen._freeze,
    "tab": MessagesScreen._swap_panel,
    "e": MessagesScreen._toggle_raw,
    "p": MessagesScreen._pin,
    "R": MessagesScreen._ask_rate,
    "Q": MessagesScreen._request_once,
    "S": MessagesScreen._save,
}
"""Key -> what it does; MessagesScreen.KEYS has their names."""
