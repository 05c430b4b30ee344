"""Parameters screen: the vehicle's parameters, changed here first and written together."""

from __future__ import annotations

import time
from collections.abc import Iterable

from textual import events
from textual.widget import Widget
from textual.widgets import Input

from groundstation.intents.union import AnyIntent
from groundstation.ui.display_state import DisplayState, ScreenKey
from groundstation.ui.param_model import ParamModel
from groundstation.ui.screens.screen import ConsoleScreen, ScreenContext
from groundstation.ui.widgets.params import ParamTable, PendingList, value_text
from groundstation.views.base import View, ViewRequest
from groundstation.views.params import ParamPage

NOTE_TIME = 10.0
"""s for which a note is shown."""
STEPS = {"up": -1, "down": 1, "home": -(10**6), "end": 10**6}
"""Key -> rows by which it moves the selection."""
PAGES = {"pageup": -1, "pagedown": 1}
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
        self._model = context.keep(ParamModel)
        self._table = ParamTable(self._model.table, id="table")
        self._pending = PendingList((), id="pending")
        self._field = Input(id="field")
        self._edits: str | None = None
        """"filter" or "value" while the field is open."""
        self._note, self._note_until = "", 0.0

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the table, the changes, and the field, which is hidden until it is asked for."""
        self._table.border_title = "parameters"
        self._pending.border_title = "changes that are not sent"
        return self._table, self._pending, self._field

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
    def hint(self) -> str:
        """Return the question, a note for some seconds, how the last request stands, or what to do."""
        now = time.monotonic()
        if self._model.is_asking(now):
            count, vehicle = len(self._model.pending), self._state.snapshot.vehicle
            to = "the vehicle, which is ARMED" if vehicle is not None and vehicle.armed else "the vehicle"
            return f"write {count} {'change' if count == 1 else 'changes'} to {to} · y writes, any other key not"
        if now < self._note_until:
            return self._note
        return self._model.status or "ENTER edits · W writes · ESC goes back to Drive"

    @property
    def takes_text(self) -> bool:
        """Return whether the field has the keys."""
        return self._field.has_focus

    # ---- keys ----

    def on_key(self, event: events.Key) -> None:
        """Handle the keys of this screen; those of other screens go on to the app."""
        if self.takes_text:
            if event.key == "escape":
                event.stop()
                self._close_field(cancelled=True)
            return
        if self._model.is_asking(time.monotonic()):
            event.stop()
            self._answer(event.key)
        elif event.key in STEPS or event.key in PAGES:
            event.stop()
            self._model.move(STEPS.get(event.key, 0) + PAGES.get(event.key, 0) * max(1, self._table.size.height - 1))
        elif event.key in _ACTIONS:
            event.stop()
            _ACTIONS[event.key](self)
        self._show()
        self.show_state(self._state)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Filter while the words are typed."""
        if self._edits == "filter":
            self._model.set_filter(event.value)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Keep the words, or make the value a change."""
        if self._edits == "value":
            self._say(self._model.change(event.value.strip()))
        self._close_field(cancelled=False)
        self._show()

    def _answer(self, key: str) -> None:
        if key == "y":
            self._send(self._model.write(time.monotonic()))
        self._model.withdraw()

    def _open_filter(self) -> None:
        self._open_field("filter", self._model.filter, "words of names; ENTER keeps them, ESC shows all")

    def _open_value(self) -> None:
        row = self._model.selected
        if row is not None:
            pending = self._model.pending.get(row.name)
            text = value_text(pending.value if pending else row.value)
            self._open_field("value", text, f"value of {row.name}; ENTER keeps it, ESC leaves it")

    def _open_field(self, edits: str, text: str, placeholder: str) -> None:
        self._edits = edits
        self._field.placeholder = placeholder
        self._field.value = text
        self._field.cursor_position = len(text)
        self._field.display = True
        self._field.focus()

    def _close_field(self, *, cancelled: bool) -> None:
        if cancelled and self._edits == "filter":
            self._model.set_filter("")
        self._edits = None
        self._field.display = False
        self.set_focus(None)
        self.show_state(self._state)

    def _ask(self) -> None:
        if not self._model.ask(time.monotonic()):
            self._say("there are no changes to write")

    def _toggle_changed(self) -> None:
        page = self._model.page
        if page is not None and page.known and not page.has_defaults:
            self._say("this vehicle does not report defaults")
        else:
            self._model.set_filter(self._model.filter, changed_only=not self._model.changed_only)

    def _set_default(self) -> None:
        self._say(self._model.change_to_default())

    def _drop(self) -> None:
        self._model.drop()

    def _undo(self) -> None:
        if not self._model.undo():
            self._say("nothing to undo")

    def _read(self) -> None:
        self._send((self._model.fetch(),))

    def _cancel(self) -> None:
        self._send(self._model.cancel())

    # ---- parts ----

    def _send(self, intents: Iterable[AnyIntent]) -> None:
        for intent in intents:
            self.context.send(intent)

    def _say(self, text: str | None) -> None:
        """Show a note for some seconds; None: there is nothing to say."""
        if text is not None:
            self._note, self._note_until = text, time.monotonic() + NOTE_TIME

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
    "W": ParamsScreen._ask,
    "c": ParamsScreen._toggle_changed,
    "d": ParamsScreen._set_default,
    "x": ParamsScreen._drop,
    "u": ParamsScreen._undo,
    "R": ParamsScreen._read,
    "X": ParamsScreen._cancel,
}
"""Key -> what it does; ParamsScreen.KEYS has their names."""
