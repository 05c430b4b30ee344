"""ChartsModel: everything that the Charts screen shows, and what it requests. Knows no widget."""

from __future__ import annotations

from collections import deque
from pathlib import Path

import msgspec
from msgspec.structs import replace

from groundstation.intents.charts import PinSeries
from groundstation.ui.charts.chart_set import ChartSet, NamedView, next_view, ready_view
from groundstation.ui.charts.columns import Columns
from groundstation.ui.charts.field_search import FieldSearch
from groundstation.ui.charts.points import Points, PointStore
from groundstation.ui.charts.saved_views import load_views, save_views
from groundstation.ui.charts.series import Line, SeriesSpec
from groundstation.ui.charts.time_axis import TimeAxis
from groundstation.views.base import ViewRequest
from groundstation.views.charts import (
    MAX_FIELDS,
    FieldId,
    FieldInfo,
    FieldRow,
    FieldsPage,
    FieldsRequest,
    Mark,
    SeriesPage,
    SeriesRequest,
)

MAX_MARKS = 500


class Stats(msgspec.Struct, frozen=True):
    """Lowest, mean and highest value of a line in the window."""

    low: float
    mean: float
    high: float


class ChartsModel:
    """The charts, their data, the time axis. `folder` has the views of the user."""

    def __init__(self, folder: Path) -> None:
        self.charts = ChartSet()
        self.axis = TimeAxis()
        self.store = PointStore()
        self.search = FieldSearch()
        self.marks: deque[Mark] = deque(maxlen=MAX_MARKS)
        self.pinned: dict[FieldId, None] = {}
        self.infos: dict[FieldId, FieldInfo] = {}
        self._ready: list[NamedView] = []
        self._opened = False
        self._folder = folder
        self._own, self._problem = load_views(folder)
        self._lines: dict[SeriesSpec, Line] = {}
        self._columns: dict[SeriesSpec, Columns] = {}

    def restart(self) -> None:
        """Forget all points and marks: a replay has moved in its log."""
        self.store = PointStore()
        self.marks.clear()
        self._lines.clear()
        self._columns.clear()

    # ---- requests and answers ----

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for new points, and for fields and views."""
        fields = tuple(dict.fromkeys((*self.charts.fields, *self.pinned)))[:MAX_FIELDS]
        if fields != tuple(self.store.fields):
            self.store.keep(fields)
        search = self.search
        text = search.text if search.count else ""
        return SeriesRequest(fields, self.store.state), FieldsRequest(text, search.count, fields)

    def show_series(self, page: SeriesPage) -> None:
        """Set the points and marks."""
        if self.store.add(page):
            self.marks.extend(page.marks)
            self.axis.now = page.now
            starts = [points.times[0] for points in self.store.fields.values() if points.times]
            self.axis.oldest = min(starts, default=page.now)

    def show_fields(self, page: FieldsPage) -> None:
        """Store the details of the fields."""
        self.infos = {info.field: info for info in page.known}
        self._ready = [ready_view(each) for each in page.ready]
        self.search.show_page(page)

    def open_first(self) -> None:
        """Show the first view that has a field, once and only where nothing was drawn before."""
        view = next((each for each in self._ready if each.charts), None)
        if view is not None and not self._opened:
            self._opened = True
            if not self.charts.charts:
                self.show_view(view)

    def pop_note(self) -> str | None:
        """Return what the user should know, once."""
        problem, self._problem = self._problem, None
        return problem or self.search.pop_refusal()

    # ---- lines ----

    def points(self, spec: SeriesSpec) -> Points:
        """Return the points of a line, with all that have arrived."""
        return self._lines.setdefault(spec, Line(spec)).update(self.store)

    def columns(self, spec: SeriesSpec) -> Columns:
        """Return the points of a line by columns of dots."""
        columns = self._columns.get(spec)
        if columns is None or columns.step != self.axis.step:
            columns = self._columns[spec] = Columns(self.axis.step)
        columns.update(self.points(spec), self.axis.begin)
        return columns

    def value(self, spec: SeriesSpec, at: float) -> float | None:
        """Return the value of a line at a time; None in a gap."""
        return self.points(spec).value_at(at)

    def text(self, spec: SeriesSpec, value: float | None) -> str:
        """Return a value of a line: the name of an enum value, or a number."""
        info = self.infos.get(spec.field)
        if value is None:
            return "--"
        name = dict(info.names).get(int(value)) if info is not None and info.names and spec.is_plain else None
        return name or f"{value:.{spec.decimals(info)}f}"

    def unit(self, spec: SeriesSpec) -> str:
        """Return the unit of a line."""
        return spec.unit(self.infos.get(spec.field))

    def is_heard(self, spec: SeriesSpec) -> bool:
        """Return whether the messages of a line have arrived in this session."""
        return all(field not in self.infos or self.infos[field].heard for field in spec.fields)

    def stats(self, spec: SeriesSpec) -> Stats | None:
        """Return the lowest, mean and highest value of a line in the window; None without any."""
        axis = self.axis
        left = axis.left
        shown = [each for each in self.columns(spec).between(left, axis.right) if each.number >= left]
        if not shown:
            return None
        mean = sum(each.low + each.high for each in shown) / 2 / len(shown)
        return Stats(min(each.low for each in shown), mean, max(each.high for each in shown))

    def measure(self) -> str:
        """Return time, difference and slope of the chosen line between the cursors; empty without both."""
        axis, spec = self.axis, self.charts.chosen_spec
        if axis.cursor is None or axis.mark is None or spec is None:
            return ""
        seconds = axis.cursor - axis.mark
        first, last = self.value(spec, axis.mark), self.value(spec, axis.cursor)
        if first is None or last is None:
            return f"Δt {seconds:.2f} s · no value at both cursors"
        unit, places = self.unit(spec), max(2, spec.decimals(self.infos.get(spec.field)))
        slope = f" · slope {(last - first) / seconds:+.{places}f} {unit}/s" if seconds else ""
        return f"Δt {seconds:.2f} s · Δ {last - first:+.{places}f} {unit}{slope}"

    # ---- what keys do ----

    @property
    def views(self) -> list[NamedView]:
        """The ready views, then those of the user."""
        return [*self._ready, *self._own]

    def next_view(self) -> str | None:
        """Show the next view; return why there is none."""
        view = next_view(self.views, self.charts.name)
        if view is None:
            return "no view has a field yet: no vehicle has sent one"
        self.show_view(view)
        return None

    def show_view(self, view: NamedView) -> None:
        """Show a view."""
        self.charts.show(view)
        self._forget_lines()

    def save_view(self, name: str) -> str:
        """Keep what is shown as a view of the user, also in a file; return how that went."""
        name = " ".join(name.split())[:40]
        if not name or not self.charts.charts:
            return "a view needs a name and a chart"
        if name in (view.name for view in self._ready):
            return f"“{name}” is a ready view: choose another name"
        self._own = [*(view for view in self._own if view.name != name), self.charts.copy(name)]
        self.charts.name = name
        try:
            return f"view “{name}” saved in {save_views(self._folder, self._own)}"
        except OSError as error:
            return f"view “{name}” is kept until the program ends; not saved: {error.strerror}"

    def add_found(self, row: FieldRow, chart: int | None) -> None:
        """Add the field that was searched: to the chart with this number, or to where its unit fits."""
        self.search.refusal = self.add(row.field, row.unit, None if chart is None else chart - 1)

    def subtract_found(self, row: FieldRow, chart: int | None) -> None:
        """Show the chosen line less the field that was searched."""
        self._replace(minus=row.field)

    def add(self, field: FieldId, unit: str, chart: int | None = None) -> str | None:
        """Add a field; return why it cannot be."""
        if chart is None:
            chosen = self.charts.chosen
            order = ([chosen[0]] if chosen else []) + list(range(len(self.charts.charts)))
            chart = next((at for at in order if self._fits(at, unit)), None)
        return self.charts.add(SeriesSpec(field), chart)

    def _fits(self, chart: int, unit: str) -> bool:
        """Return whether a chart has lines of this unit and room for one more."""
        lines = self.charts.charts[chart].lines
        return len(lines) < 4 and bool(unit) and self.unit(lines[0]) == unit

    def remove(self) -> PinSeries | None:
        """Remove the chosen line; return the intent that ends its recording, if it was pinned."""
        removed = self.charts.remove_chosen()
        pinned = [field for field in removed.fields if field in self.pinned] if removed else []
        if not pinned or any(field in self.charts.fields for field in pinned):
            return None
        for field in pinned:
            del self.pinned[field]
        return PinSeries(tuple(self.pinned))

    def toggle_pin(self) -> PinSeries | None:
        """Record the fields of the chosen line also when they are not drawn any more, or end that."""
        spec = self.charts.chosen_spec
        if spec is None:
            return None
        pin = any(field not in self.pinned for field in spec.fields)
        for field in spec.fields:
            self.pinned.pop(field, None)
            if pin and len(self.pinned) < MAX_FIELDS:
                self.pinned[field] = None
        return PinSeries(tuple(self.pinned))

    def pin_field(self, field: FieldId, unit: str) -> tuple[str, PinSeries]:
        """Add a field of another screen and record it from now on; return how that went, and the intent."""
        refusal = self.add(field, unit)
        if refusal is None or "already" in refusal:
            self.pinned[field] = None
        return refusal or f"{field.name} is recorded for Charts (F5)", PinSeries(tuple(self.pinned))

    def toggle_rate(self) -> None:
        """Show how fast the chosen line changes, or its value again."""
        spec = self.charts.chosen_spec
        if spec is not None:
            self._replace(rate=not spec.rate)

    def scale(self, text: str) -> str | None:
        """Multiply the chosen line by a number; return what is wrong with the text."""
        try:
            factor = float(text)
        except ValueError:
            return f"“{text}” is not a number"
        if not -1e9 < factor < 1e9 or factor == 0:
            return "a factor is a number between -1e9 and 1e9, and not 0"
        self._replace(factor=factor)
        return None

    def _replace(self, **changes: object) -> None:
        spec = self.charts.chosen_spec
        if spec is not None:
            self.charts.replace_chosen(replace(spec, **changes))
            self._forget_lines()

    def _forget_lines(self) -> None:
        """Free what belongs to lines that are not shown any more."""
        shown = set(self.charts.specs())
        self._lines = {spec: line for spec, line in self._lines.items() if spec in shown}
        self._columns = {spec: columns for spec, columns in self._columns.items() if spec in shown}
