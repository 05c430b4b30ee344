"""Parameters screen: the vehicle's parameters, changed here first and written together."""

from __future__ import annotations

from collections.abc import Iterable

from textual import events
from textual.widget import Widget

from groundstation.intents.union import AnyIntent
from groundstation.ui.display_state import DisplayState, ScreenKey
from groundstation.ui.list_keys import rows_to_move
from groundstation.ui.param_model import ParamModel
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.ui.widgets.params import ParamTable, PendingList, value_text
from groundstation.views.base import View, ViewRequest
from groundstation.views.params import ParamPage

MAX_PENDING = 6
"""Rows of the list of changes."""


class ParamsScreen(ConsoleScreen):
    """The table over the pending changes. Nothing is sent before W and y."""

    CSS_PATH = "params.tcss"
    KEYS = (
        ScreenKey("slash", "Filter", "Show the parameters with one of these words in the name"),
        ScreenKey("enter", "Edit", "Change the value of the selected parameter, here first"),
        ScreenKey("W", "Write", "Write the changes to the vehicle, after a question"),
        ScreenKey("c", "Changed", "Show only what is not at its default, or all again"),
        ScreenKey("d", "Default", "Change the selected parameter to its default"),
        ScreenKey("x", "Drop", "Drop the change of the selected parameter"),
        ScreenKey("u", "Undo", "Undo the last change; after a write the old values are changes again"),
        ScreenKey("R", "Read", "Read all parameters again"),
        ScreenKey("X", "Cancel", "Cancel the reading or writing that runs"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(ParamModel, context.numbers)
        self._table = ParamTable(self._model.table, id="table")
        self._pending = PendingList((), id="pending")

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the table over the changes."""
        self._table.add_class("-chosen")
        return self.build_panel(self._table, "parameters"), self.build_panel(self._pending, "changes that are not sent")

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the request for the rows that fit."""
        return (self._model.request,)

    def show_view(self, view: View) -> None:
        """Show a page, and fetch the parameters if none are known."""
        if isinstance(view, ParamPage):
            self._send(self._model.show_page(view))
            self._show()

    def show_body(self, now: DisplayState) -> None:
        """Show the model: a page may have arrived, or a question ended."""
        self._show()

    @property
    def advice(self) -> str:
        """Return how the last request stands, or what to do."""
        return self._model.status or "ENTER edits · W writes · ESC goes back to Drive"

    # ---- keys ----

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if rows := rows_to_move(event.key, self._table.size.height):
            self._model.move(rows)
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        self._show()
        return True

    def _open_filter(self) -> None:
        use = FieldUse(self._model.set_filter, self._model.set_filter, cancel=lambda: self._model.set_filter(""))
        self.field.open(use, text=self._model.filter, placeholder="words of names; ENTER keeps them, ESC shows all")

    def _open_value(self) -> None:
        row = self._model.selected
        if row is not None:
            pending = self._model.pending.get(row.name)
            text = value_text(pending.value if pending else row.value)
            placeholder = f"value of {row.name}; ENTER keeps it, ESC leaves it"
            self.field.open(FieldUse(self._change), text=text, placeholder=placeholder)

    def _change(self, text: str) -> None:
        self.say(self._model.change(text.strip()))
        self._show()

    def _ask_to_write(self) -> None:
        if self._model.may_write:
            self.ask(self._question_text, lambda: self._send(self._model.write()))
        else:
            self.say("there are no changes to write")

    def _question_text(self) -> str:
        count, vehicle = len(self._model.pending), self._state.snapshot.vehicle
        to = "the vehicle, which is ARMED" if vehicle is not None and vehicle.armed else "the vehicle"
        return f"write {count} {'change' if count == 1 else 'changes'} to {to}"

    def _toggle_changed(self) -> None:
        page = self._model.page
        if page is not None and page.known and not page.has_defaults:
            self.say("this vehicle does not report defaults")
        else:
            self._model.set_filter(self._model.filter, changed_only=not self._model.changed_only)

    def _set_default(self) -> None:
        self.say(self._model.change_to_default())

    def _drop(self) -> None:
        self._model.drop()

    def _undo(self) -> None:
        if not self._model.undo():
            self.say("nothing to undo")

    def _read(self) -> None:
        self._send((self._model.fetch(),))

    def _cancel(self) -> None:
        self._send(self._model.cancel())

    # ---- parts ----

    def _send(self, intents: Iterable[AnyIntent]) -> None:
        for intent in intents:
            self.context.send(intent)

    def _show(self) -> None:
        """Show the model at the size that the widgets have now."""
        self._model.set_height(max(1, self._table.size.height))
        pending = tuple(self._model.pending.values())
        self._pending.styles.display = "block" if pending else "none"
        self._pending.styles.height = 2 + min(MAX_PENDING, max(1, len(pending)))
        self._pending.show(pending)
        self._table.show(self._model.table)
        page = self._model.page
        if page is not None:
            shown = f"{page.matching} of " if page.matching != page.known else ""
            missing = f" of {page.total}" if page.total is not None and page.total != page.known else ""
            self._table.border_subtitle = f"{shown}{page.known}{missing} · system {page.system}"


_ACTIONS = {
    "slash": ParamsScreen._open_filter,
    "enter": ParamsScreen._open_value,
    "W": ParamsScreen._ask_to_write,
    "c": ParamsScreen._toggle_changed,
    "d": ParamsScreen._set_default,
    "x": ParamsScreen._drop,
    "u": ParamsScreen._undo,
    "R": ParamsScreen._read,
    "X": ParamsScreen._cancel,
}
"""Key -> what it does; ParamsScreen.KEYS has their names."""
