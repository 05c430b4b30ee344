"""Charts screen: fields of messages over time, with modes, events and own keys under them."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from textual import events
from textual.containers import Horizontal, Vertical
from textual.widget import Widget

from groundstation.intents.charts import PinSeries
from groundstation.ui.base.list_keys import ALL_ROWS
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.charts.chart_set import MAX_CHARTS
from groundstation.ui.charts.empty import EmptyCharts, EmptyValue
from groundstation.ui.charts.field_list import FieldList
from groundstation.ui.charts.field_search import Chosen
from groundstation.ui.charts.model import ChartsModel
from groundstation.ui.charts.pane import EMPTY, ChartPane, plot_dots
from groundstation.ui.charts.picture import Pictures
from groundstation.ui.charts.stats import StatsPanel
from groundstation.ui.charts.timeline import ChartTimeline, ChartTimelineValue
from groundstation.ui.display.display_state import DisplayState, ScreenKey
from groundstation.ui.widgets.line_field import FieldUse
from groundstation.views.base import View, ViewRequest
from groundstation.views.charts import FieldsPage, SeriesPage

WIDE, HUGE = 120, 180
"""Columns from which on the list stands beside the charts, and has more room."""

LEAST_ROWS = 7
"""Rows of a chart with its header; charts that get less are scrolled."""


class ChartsScreen(ConsoleScreen):
    """Charts below each other on one time axis, and a list of their lines."""

    CSS_PATH = "screen.tcss"
    KEYS = (
        ScreenKey("v", "View", "Next view: drive, power, link, and those that were saved"),
        ScreenKey("a", "Add", "Add a field by a part of its name; a number 1-6 behind it says in which chart"),
        ScreenKey("x", "Remove", "Remove the chosen field"),
        ScreenKey("z", "Pause", "Stop the picture, or go on live; data are recorded in both cases"),
        ScreenKey("left", "Cursor", "Move the cursor left (right: →; ten times as far: with Shift)"),
        ScreenKey("m", "Mark", "Set the second cursor: the hint line shows what is between the two"),
        ScreenKey("plus", "Zoom", "Show a shorter time; - a longer one, 10 s to 10 min"),
        ScreenKey("tab", "List", "Show the list of fields in place of the charts, where both do not fit"),
        ScreenKey("up", "Field", "Choose the field above; down, and 1 to 6 for a chart, choose others"),
        ScreenKey("pageup", "Earlier", "Show an earlier time (Page Down: later, Home: the oldest, End: live)"),
        ScreenKey("c", "No cursor", "Remove both cursors"),
        ScreenKey("p", "Pin", "Record the chosen field also when it is not drawn any more, or end that"),
        ScreenKey("s", "Rate", "Show how fast the chosen field changes, or its value again"),
        ScreenKey("f", "Factor", "Multiply the chosen field by a number"),
        ScreenKey("d", "Difference", "Subtract another field from the chosen one"),
        ScreenKey("S", "Save", "Save what is shown as a view with a name"),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = context.keep(ChartsModel, context.folder)
        self._pictures = Pictures(self._model)
        self._panes = [ChartPane(EMPTY, id=f"pane{number}", classes="pane") for number in range(MAX_CHARTS)]
        self._timeline = ChartTimeline(ChartTimelineValue(), id="timeline")
        self._list = FieldList((), id="list")
        self._stats = StatsPanel((), id="stats")
        self._empty = EmptyCharts(EmptyValue(), id="empty")
        self._column = Vertical(self._empty, *self._panes, self._timeline, id="panes")
        self._first = 0
        """Index of the first chart that is shown."""

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the list beside the charts."""
        self._list.add_class("-chosen")
        stats = self.build_panel(self._stats, "in the window: min, mean, max")
        side = Vertical(self.build_panel(self._list, "fields"), stats, id="side")
        return (Horizontal(side, self._column, id="charts"),)

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for new points, and for fields and views; also while the picture is paused."""
        return self._model.requests()

    def show_view(self, view: View) -> None:
        """Set the points, or fields."""
        if isinstance(view, SeriesPage):
            self._model.show_series(view)
            if self._model.axis.paused_at is None:
                self._show()
        elif isinstance(view, FieldsPage):
            self._model.show_fields(view)
            self._model.open_first()
            self.say(self._model.pop_note())
            self._show()

    def show_body(self, now: DisplayState) -> None:
        """Show the page without a chart; pictures come with new points."""
        if not self._model.charts.charts:
            self._show()

    def on_resize(self, event: events.Resize) -> None:
        """Lay out for the new size."""
        self.update_classes({"-wide": self.room.width >= WIDE, "-huge": self.room.width >= HUGE})
        self._show()
        self.call_after_refresh(self._show)

    @property
    def advice(self) -> str:
        """Return what the cursors measure, or what is shown."""
        model, axis = self._model, self._model.axis
        if measured := model.measure():
            return measured
        behind = f"paused, {axis.now - axis.end:.0f} s behind: z goes on live" if axis.paused_at is not None else ""
        hidden = len(model.charts.charts) - self._visible
        more = f"{hidden} more {'chart' if hidden == 1 else 'charts'}: ↑ ↓ scroll" if hidden > 0 else ""
        window = f"{axis.window:g} s" if model.charts.charts else ""
        return " · ".join(part for part in (behind, window, more, "ESC goes back to Drive") if part)

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Move in the list of fields; over a chart the wheel zooms."""
        if widget is self._list:
            return LIST_ARROWS
        return ("plus", "minus") if widget in (*self._panes, self._timeline) else None

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        if event.key in "123456":
            if not self._model.charts.choose_chart(int(event.key)):
                self.say(f"there is no chart {event.key}")
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        else:
            return False
        self._show()
        return True

    @property
    def marked_text(self) -> str:
        """The name of the chosen field, with what the cursors measure."""
        spec = self._model.charts.chosen_spec
        return "" if spec is None else " · ".join(part for part in (spec.label, self._model.measure()) if part)

    def _next_view(self) -> None:
        self.say(self._model.next_view())

    def _remove(self) -> None:
        self._send(self._model.remove())

    def _pin(self) -> None:
        self._send(self._model.toggle_pin())

    def _send(self, intent: PinSeries | None) -> None:
        if intent is not None:
            self.context.send(intent)

    def _search(self, chosen: Chosen, what: str) -> None:
        search = self._model.search
        search.begin(chosen)
        self.field.open(FieldUse(self._submit, self._type, self._cancel), placeholder=what)

    def _type(self, text: str) -> None:
        self._model.search.type(text)
        self._show()

    def _submit(self, text: str) -> None:
        self._model.search.submit(text)
        self._show()

    def _cancel(self) -> None:
        self._model.search.cancel()
        self._show()

    def _add(self) -> None:
        self._search(self._model.add_found, "part of a name, e.g. volt or vfr.speed 2; ENTER takes the first")

    def _subtract(self) -> None:
        if self._has_chosen():
            self._search(self._model.subtract_found, "field to subtract: part of its name; ENTER takes the first")

    def _rate(self) -> None:
        self._model.toggle_rate()

    def _scale(self) -> None:
        if self._has_chosen():
            use = FieldUse(lambda text: self.say(self._model.scale(text)))
            self.field.open(use, placeholder="factor, e.g. 0.9; 1 shows the field as it is")

    def _save(self) -> None:
        use = FieldUse(lambda text: self.say(self._model.save_view(text)))
        self.field.open(use, placeholder="name of this view; ENTER saves it")

    def _has_chosen(self) -> bool:
        if self._model.charts.chosen is None:
            self.say("no field is drawn: a adds one, v opens a view")
        return self._model.charts.chosen is not None

    def _zoom(self, step: int) -> None:
        if not self._model.axis.zoom(step):
            self.say("the charts show 10 s to 600 s: all that is kept")

    def _mark(self) -> None:
        if not self._model.axis.set_mark():
            self.say("← and → place the first cursor, then m sets the second one there")

    def _swap_list(self) -> None:
        self.toggle_class("-list")
        self.call_after_refresh(self._show)

    # ---- what is shown ----

    @property
    def _visible(self) -> int:
        """Charts that have room."""
        room = self.room.height - 4 - (4 if self.room.width >= WIDE else 3)
        return max(1, min(len(self._model.charts.charts) or 1, room // LEAST_ROWS))

    def _show(self) -> None:
        """Show the model at the size that the widgets have now."""
        if not self.is_mounted:
            return
        self._show_panes()
        if self.has_class("-wide") or self.has_class("-list"):
            self._list.show(self._pictures.list_rows())
            rows = self._pictures.stats_rows()
            self._stats.styles.height = len(rows) + 2
            self._stats.display = bool(rows)
            self._stats.show(rows)

    def _show_panes(self) -> None:
        model, visible = self._model, self._visible
        count = len(model.charts.charts)
        chosen = model.charts.chosen
        if chosen is not None:
            self._first = max(min(self._first, chosen[0], count - visible), chosen[0] - visible + 1, 0)
        for index, pane in enumerate(self._panes):
            pane.display = self._first <= index < min(count, self._first + visible)
        self._empty.display = not count
        self._timeline.display = bool(count)
        width = self._column.content_size.width
        if count and width:
            model.axis.dots = plot_dots(width)
            for index, pane in enumerate(self._panes):
                if pane.display:
                    pane.show(self._pictures.pane(index))
            self._timeline.show(self._pictures.timeline())
        elif not count:
            views = tuple((view.name, ", ".join(chart.title for chart in view.charts)) for view in model.views)
            self._empty.show(EmptyValue(views, self._state.snapshot.vehicle is not None))


_ACTIONS: dict[str, Callable[[ChartsScreen], None]] = {
    "v": ChartsScreen._next_view,
    "a": ChartsScreen._add,
    "slash": ChartsScreen._add,
    "x": ChartsScreen._remove,
    "p": ChartsScreen._pin,
    "s": ChartsScreen._rate,
    "f": ChartsScreen._scale,
    "d": ChartsScreen._subtract,
    "S": ChartsScreen._save,
    "m": ChartsScreen._mark,
    "tab": ChartsScreen._swap_list,
    "z": lambda screen: screen._model.axis.toggle_pause(),
    "c": lambda screen: screen._model.axis.clear_cursors(),
    "plus": lambda screen: screen._zoom(-1),
    "minus": lambda screen: screen._zoom(1),
    "up": lambda screen: screen._model.charts.move(-1),
    "down": lambda screen: screen._model.charts.move(1),
    "left": lambda screen: screen._model.axis.move_cursor(-1),
    "right": lambda screen: screen._model.axis.move_cursor(1),
    "shift+left": lambda screen: screen._model.axis.move_cursor(-10),
    "shift+right": lambda screen: screen._model.axis.move_cursor(10),
    "pageup": lambda screen: screen._model.axis.scroll(-0.5),
    "pagedown": lambda screen: screen._model.axis.scroll(0.5),
    "home": lambda screen: screen._model.axis.scroll(-ALL_ROWS),
    "end": lambda screen: screen._model.axis.scroll(ALL_ROWS),
}
"""Key -> what it does; ChartsScreen.KEYS has their names."""
