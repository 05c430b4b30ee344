"""Map screen: mission, fence and rally points on a map beside a table; edited here, uploaded, driven."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Sequence

from textual import events
from textual.containers import Horizontal, Vertical
from textual.geometry import Size
from textual.widget import Widget

from groundstation.intents.union import AnyIntent
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.wrap import plain
from groundstation.ui.keys.mode_keys import MODE_KEYS
from groundstation.ui.map.draw.plan_map import PlanMap
from groundstation.ui.map.draw.plan_map_value import PlanMapValue
from groundstation.ui.map.drive_keys import DriveKeys
from groundstation.ui.map.file_keys import FileKeys
from groundstation.ui.map.item_edit import change_item, choices
from groundstation.ui.map.keys import MAP_KEYS, STEPS
from groundstation.ui.map.look_keys import LookKeys
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.panels import LinesPanel, PanelValue, ProgressStrip, ProgressValue, TextLine
from groundstation.ui.map.picture import build_map, cursor_lines, layer_title
from groundstation.ui.map.plan.fields import ItemField, fields_of, value_of
from groundstation.ui.map.plan_table import PlanTable, PlanTableValue
from groundstation.ui.map.tables import build_item, build_plans, build_progress, build_table
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.views.base import View, ViewRequest

MAP_PERIOD, TABLE_PERIOD = 0.2, 0.5
"""s between two drawings without a key."""
NARROW = 120
"""Columns below which the item and the table share one place."""


FENCE = "fence"
"""Name of what stops a vehicle at its fence, in the snapshot."""


class MapScreen(ConsoleScreen):
    """Map, table, item and plans. TAB chooses which of the first three has the arrows."""

    CSS_PATH = "screen.tcss"
    HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (NARROW, "-wide"), (180, "-wider")]  # noqa: RUF012 - Textual's form
    KEYS = MAP_KEYS

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(MapModel, context.numbers)
        self._map = PlanMap(PlanMapValue(), id="plan-map")
        self._table = PlanTable(PlanTableValue(), id="plan-table")
        self._item = LinesPanel(PanelValue(), id="plan-item")
        self._plans = LinesPanel(PanelValue(), id="plan-plans")
        self._progress = ProgressStrip(ProgressValue(), id="progress")
        self._line = TextLine("", id="cursor-line")
        self._panels: tuple[Widget, ...] = (self._map, self._table, self._item)
        self._chosen = self._field = 0
        self._map_due = self._table_due = 0.0
        self._drawn_for = Size(0, 0)
        self._drive = DriveKeys(self, self._model, lambda: self._state.snapshot.vehicle)
        self._files = FileKeys(self, self._model, context.folder)
        self._look = LookKeys(self, self._model)

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the map beside the panels, over the progress."""
        self.build_panel(self._item, "item")
        side = [self.build_panel(self._table, "mission"), self._item, self.build_panel(self._plans, "plan and vehicle")]
        yield Horizontal(self.build_panel(self._map, "map"), Vertical(*side, id="side"), id="map-body")
        self._progress.border_title = "progress"
        yield self._progress
        yield self._line

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the plans, the page that is missing, and the track."""
        return self._model.requests

    def show_view(self, view: View) -> None:
        """Show a view; plans that are not known are downloaded."""
        self.send(self._model.show_view(view))
        self.say(self._model.pop_news())
        if self._model.pop_fence_upload() and self._model.fence_off:
            self._drive.ask_for_fence()

    def show_body(self, now: DisplayState) -> None:
        """Draw what is due."""
        stops = now.snapshot.vehicle.stops if now.snapshot.vehicle is not None else ()
        self._model.fence_off = any(stop.name == FENCE and stop.never for stop in stops)
        self._show(forced=False)

    @property
    def advice(self) -> str:
        """Return how the last request stands, or what to do."""
        edited = self._model.editor.diff(self._model.editor.layer)
        if status := self._model.status:
            return status
        if edited.count:
            return f"{edited.text}, not on the vehicle: U uploads · u undoes"
        return self._drive.advice or "arrows, with Shift by ten, move the cursor · a adds an item · TAB: the table"

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to a panel; over the map the wheel zooms."""
        if widget not in self._panels:
            return None
        self._chosen = self._panels.index(widget)
        self._show(forced=True)
        return ("plus", "minus") if self._chosen == 0 else LIST_ARROWS

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        key, repeated = event.key, isinstance(event, KeyRepeat)
        if key == "escape" and self._chosen and not self._model.filter.text:
            self._chosen = 1 if self._item is self._panels[self._chosen] and not self._narrow else 0
        elif not (self._move(key) or (not repeated and self._perform(key))):
            return False
        self._model.settle()
        self._show(forced=True)
        return True

    def _perform(self, key: str) -> bool:
        """Perform a key that acts once, however long it is held."""
        if key in _ITEM_EDITS and self._model.hides_selected:
            self.say("the filter hides the selected item: Escape shows all")
        elif key in _ACTIONS:
            _ACTIONS[key](self)
        elif key in MODE_KEYS:
            self._drive.choose_mode(key)
        elif not (self._look.perform(key) or self._drive.perform(key) or self._files.perform(key)):
            return False
        return True

    def _move(self, key: str) -> bool:
        """Move the cursor, the selection or the field, by the panel that has the arrows."""
        if self._chosen == 0:
            up, right = STEPS.get(key, (0, 0))
            self._model.ground.move(up, right)
            return bool(up or right)
        rows = rows_to_move(key, self._panels[self._chosen].size.height, letters=False)
        if rows and self._chosen == 1:
            self._model.select(rows)
        elif rows:
            self._field = max(0, min(len(self._fields) - 1, self._field + rows))
        return bool(rows)

    def _next_panel(self) -> None:
        self._chosen = (self._chosen + 1) % len(self._panels)

    def _enter(self) -> None:
        """Open the item under the cursor, or the selected field of it."""
        if self._chosen < 2:
            if self._chosen == 0:
                self._model.take_under_cursor()
            self._chosen, self._field = 2, 0
        elif self._fields:
            self._open_field(self._fields[min(self._field, len(self._fields) - 1)])

    @property
    def _fields(self) -> Sequence[ItemField]:
        row = self._model.editor.row
        return fields_of(row.item) if row is not None else ()

    def _open_field(self, field: ItemField) -> None:
        row = self._model.editor.row
        if row is not None:
            text = value_of(row.item, field, self._model.first) if field.key != "command" else ""
            use = FieldUse(lambda typed: self._change(field, typed))
            self.field.open(use, text=text, placeholder=choices(self._model, field))

    def _change(self, field: ItemField, text: str) -> None:
        self.say(change_item(self._model, field, text))
        self._model.settle()
        self._show(forced=True)

    def _add(self) -> None:
        self.say(self._model.add())

    def _polygon(self) -> None:
        self.say(self._model.new_polygon())

    def _move_here(self) -> None:
        self.say(self._model.move_here())

    def _remove(self) -> None:
        self.say(None if self._model.editor.remove() else "there is no item to remove")

    def _undo(self) -> None:
        self.say(None if self._model.editor.undo() else "nothing to undo")

    def _redo(self) -> None:
        self.say(None if self._model.editor.redo() else "nothing to redo")

    # ---- what the keys use ----

    def send(self, intents: Iterable[AnyIntent]) -> None:
        """Send intents to the station."""
        for intent in intents:
            self.context.send(intent)

    def redraw(self) -> None:
        """Draw at once what has changed."""
        self._show(forced=True)

    # ---- drawing ----

    @property
    def _narrow(self) -> bool:
        return self.room.width < NARROW

    def _show(self, *, forced: bool) -> None:
        self._model.replay = self._state.snapshot.replay is not None
        now, size = time.monotonic(), self._map.size
        forced = forced or size != self._drawn_for
        self._drawn_for = size
        if forced or now >= self._map_due:
            self._map_due = now + MAP_PERIOD
            self._show_map()
        if forced or now >= self._table_due:
            self._table_due = now + TABLE_PERIOD
            self._show_tables()

    def _show_map(self) -> None:
        model, vehicle = self._model, self._state.snapshot.vehicle
        model.ground.set_size(self._map.size.width, self._map.size.height)
        value = build_map(model, vehicle, ascii=self._state.ascii)
        lines = cursor_lines(model, narrow=self._narrow)
        self._line.show(lines[0] if lines else value.note)
        self._map.show(value if self._narrow else value.with_lines(lines))
        self.set_class(bool(value.note), "-table-only")
        self._map.border_subtitle = plain(layer_title(model))

    def _show_tables(self) -> None:
        model, vehicle = self._model, self._state.snapshot.vehicle
        for number, panel in enumerate(self._panels):
            panel.set_class(number == self._chosen, "-chosen")
        self.set_class(self._chosen == 2, "-editing")
        table = build_table(model, max(1, self._table.size.height - 2), narrow=self._narrow)
        self._table.show(table.with_reason(self._map.value.note))
        self._table.border_title = plain(model.plan_name)
        diff = model.editor.diff(model.editor.layer)
        count, found = len(model.editor.rows()), f"/{model.filter.text} {len(model.shown_rows)} of "
        items = f"{found if model.filter.text else ''}{count} items"
        self._table.border_subtitle = plain(items + (f" · {diff.text}" if diff.count else ""))
        self._item.show(build_item(model, self._field if self._chosen == 2 else None))
        self._item.border_title = plain(f"item {model.editor.selected + model.first}" if model.editor.row else "item")
        self._plans.show(build_plans(model))
        self._progress.show(build_progress(model, vehicle))


_ACTIONS: dict[str, Callable[[MapScreen], None]] = {
    "tab": MapScreen._next_panel,
    "enter": MapScreen._enter,
    "a": MapScreen._add,
    "p": MapScreen._polygon,
    "m": MapScreen._move_here,
    "x": MapScreen._remove,
    "u": MapScreen._undo,
    "ctrl+r": MapScreen._redo,
    "less_than_sign": lambda screen: screen.say(None if screen._model.editor.move(-1) else "it cannot move up"),
    "greater_than_sign": lambda screen: screen.say(None if screen._model.editor.move(1) else "it cannot move down"),
}
"""Key -> what it does here. Others are in map/drive_keys.py (to the vehicle), file_keys.py and look_keys.py."""
_ITEM_EDITS = ("m", "x", "less_than_sign", "greater_than_sign")
"""Keys that edit the selected item."""
