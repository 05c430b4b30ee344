"""Parameters screen: the vehicle's parameters, changed here first and written together."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from textual import events
from textual.containers import Container
from textual.widget import Widget

from groundstation.intents.union import AnyIntent
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.params.edit.saving import ParamSaving
from groundstation.ui.params.kept import keep_params
from groundstation.ui.params.panel_widgets import MAX_PENDING, ParamWidgets
from groundstation.ui.params.panels import PARAM_KEYS, ParamPanels
from groundstation.ui.params.scope import ALL, CHANGED
from groundstation.ui.params.status import question_text
from groundstation.ui.params.transfers import ParamTransfers
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.views.base import View, ViewRequest
from groundstation.views.params import ParamDiff, ParamExport, ParamInfos, ParamPage
from link.services.param.float32 import value_text

WIDE, SIDE = 120, 180
"""Columns from which on the groups stand beside the table, and the pending changes, too."""

TALL = 36
"""Rows of the terminal from which on the pending changes have a fifth of them, and titles."""


class ParamsScreen(ConsoleScreen):
    """Groups, table, detail, comparison with a file, pending changes. Nothing is sent before W and y."""

    CSS_PATH = "screen.tcss"
    KEYS = PARAM_KEYS

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = keep_params(context)
        self._transfers = ParamTransfers(self, self._model, context.keep(ParamSaving, context.numbers))
        self._panels = ParamPanels(self._model)
        self._widgets = ParamWidgets()
        self._warned = False

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the panels."""
        widgets, panel = self._widgets, self.build_panel
        side = Container(panel(widgets.detail, "detail"), panel(widgets.compare, "compare with a file"), id="side")
        upper = Container(panel(widgets.groups, "groups"), panel(widgets.table, "parameters"), side, id="upper")
        pending = panel(widgets.pending, "pending · nothing is written before W")
        return (Container(upper, pending, id="all"),)

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the rows that fit, their texts, the comparison, and a file to save."""
        return (*self._model.requests, *self._transfers.requests)

    def show_view(self, view: View) -> None:
        """Show a view; parameters that are not known are fetched."""
        match view:
            case ParamPage():
                before = self._model.last_write
                self._send(self._model.show_page(view))
                self.say(self._model.last_write if self._model.last_write != before else None)
            case ParamInfos():
                self._model.show_infos(view)
            case ParamDiff():
                self.say(self._model.show_diff(view))
            case ParamExport():
                self._transfers.take(view)
        self._show()

    def on_resize(self, event: events.Resize) -> None:
        """Lay out the panels, and show the rows at the size that the table has then."""
        self.update_classes({"-wide": self.room.width >= WIDE, "-side": self.room.width >= SIDE})
        self.call_after_refresh(self._show)

    def show_body(self, now: DisplayState) -> None:
        """Show the model: a page may have arrived, or a question ended."""
        self._show()

    @property
    def advice(self) -> str:
        """Return how the last request stands, or what to do."""
        if editor := self._model.editor:
            return editor.advice
        waiting = len(self._model.pending)
        if status := self._model.status:
            return status
        if waiting:
            return f"{waiting} {'edit waits' if waiting == 1 else 'edits wait'}: W writes after one more look, x drops"
        return "ENTER edits · TAB groups · / finds any of the words · ESC goes back to Drive"

    # ---- keys ----

    def _copy(self) -> None:
        row = self._model.selected
        if row is not None:
            self.copy(f"{row.name} {value_text(row.value)}")

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the panel of a widget."""
        name = self._widgets.name_of(widget)
        if name:
            self._panels.chosen = name
            self._show()
        return LIST_ARROWS if name else None

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        height = self._widgets.height_of(self._panels.chosen)
        if rows := rows_to_move(event.key, height):
            self._panels.move(rows)
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        elif not (event.key == "escape" and self._panels.go_back()):
            return False
        self._show()
        return True

    @property
    def kept_filter(self) -> str:
        """The text of the filter."""
        return self._model.filter

    def filter_by(self, text: str) -> bool:
        """Show the rows that the text describes."""
        self._model.set_filter(text)
        return True

    def _open_filter(self) -> None:
        use = FieldUse(self._model.set_filter, self._model.set_filter, cancel=lambda: self._model.set_filter(""))
        placeholder = "words of names and texts, any of them; ENTER keeps them, ESC shows all"
        self.field.open(use, text=self._model.filter, placeholder=placeholder, selected=True)

    def _enter(self) -> None:
        if not self._panels.enter() and (editor := self._model.open_editor()) is not None:
            use = FieldUse(
                lambda text: self.say(self._model.close_editor(keep=True)),
                editor.type,
                cancel=lambda: self.say(self._model.close_editor(keep=False)),
                key=self._panels.edit_key,
            )
            placeholder = f"number, 0x…, or a name of the list for {editor.row.name}; ENTER keeps, ESC leaves"
            self.field.open(use, text=editor.text, placeholder=placeholder, selected=True)

    def _ask_to_write(self) -> None:
        if self._model.may_write:
            self.ask(self._question_text, lambda: self._send(self._model.write()))
        else:
            self.say("there are no changes to write")

    def _question_text(self) -> str:
        return question_text(self._model.pending, self._model.infos, armed=self._armed)

    @property
    def _armed(self) -> bool:
        vehicle = self._state.snapshot.vehicle
        return vehicle is not None and vehicle.armed

    def _toggle_changed(self) -> None:
        page = self._model.page
        if page is not None and page.known and not page.has_defaults:
            self.say("this vehicle does not report defaults")
        else:
            self._model.set_scope(ALL if self._model.changed_only else CHANGED)

    def _set_default(self) -> None:
        self.say(self._model.change_to_default())

    def _drop(self) -> None:
        if not self._model.drop():
            self.say("the selected parameter has no change")

    def _undo(self) -> None:
        if not self._model.changes.undo():
            self.say("nothing to undo")

    def _redo(self) -> None:
        if not self._model.changes.redo():
            self.say("nothing to redo")

    def _toggle_favourite(self) -> None:
        self.say(self._model.toggle_favourite())

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
        if not self._warned and self._model.favourites_warning:
            self._warned = True
            self.say(self._model.favourites_warning)
        self._model.set_height(self._widgets.height_of("table"))
        self._panels.has_file = bool(self._model.page and self._model.page.file)
        at = {f"-at-{name}": self._panels.chosen == name for name in ("groups", "compare")}
        self.update_classes({**at, "-file": self._panels.has_file})
        self._widgets.show(self._model, self._panels, armed=self._armed, room=self._pending_room)

    @property
    def _pending_room(self) -> int:
        """Rows for the pending changes below the table: half of the screen while it is asked whether to write them."""
        if self.has_class("-side"):
            return 0
        whole = self.room.height
        return whole // 2 if self.question is not None else MAX_PENDING if whole < TALL else whole // 5


_ACTIONS: dict[str, Callable[[ParamsScreen], None]] = {
    "slash": ParamsScreen._open_filter,
    "y": ParamsScreen._copy,
    "enter": ParamsScreen._enter,
    "tab": lambda screen: screen._panels.next(),
    "W": ParamsScreen._ask_to_write,
    "c": ParamsScreen._toggle_changed,
    "d": ParamsScreen._set_default,
    "x": ParamsScreen._drop,
    "u": ParamsScreen._undo,
    "ctrl+r": ParamsScreen._redo,
    "asterisk": ParamsScreen._toggle_favourite,
    "a": lambda screen: screen._transfers.take_all(),
    "O": lambda screen: screen._transfers.open_file(),
    "S": lambda screen: screen._transfers.open_save(),
    "E": lambda screen: screen._transfers.open_memory(),
    "R": ParamsScreen._read,
    "X": ParamsScreen._cancel,
}
"""Key -> what it does; PARAM_KEYS has their names."""
