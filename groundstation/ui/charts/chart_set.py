"""ChartSet: the charts of a view and the series in them; which of them is chosen; the views by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec

from groundstation.ui.charts.series import SeriesSpec
from groundstation.views.charts import FieldId, ReadyView

MAX_CHARTS, MAX_LINES = 6, 4
"""Charts of a view, and lines of a chart."""


class ChartSpec(msgspec.Struct):
    """Lines on one scale."""

    title: str
    lines: list[SeriesSpec] = msgspec.field(default_factory=list)


class NamedView(msgspec.Struct):
    """Charts under a name."""

    name: str
    charts: list[ChartSpec]
    own: bool = False
    """Of the user, not a ready one."""


def ready_view(ready: ReadyView) -> NamedView:
    """Return the charts of a ready view."""
    charts = [ChartSpec(each.title, [SeriesSpec(item) for item in each.fields[:MAX_LINES]]) for each in ready.charts]
    return NamedView(ready.name, charts[:MAX_CHARTS])


class ChartSet:
    """The charts that are shown, and the cursor in the list of their lines."""

    def __init__(self) -> None:
        self.charts: list[ChartSpec] = []
        self.name = ""
        """Of the view that was chosen last."""
        self.cursor = 0
        """Index of the chosen line, counted over all charts."""

    def show(self, view: NamedView) -> None:
        """Show the charts of a view; changes do not change the view."""
        self.charts = [ChartSpec(chart.title, list(chart.lines)) for chart in view.charts]
        self.name, self.cursor = view.name, 0

    @property
    def rows(self) -> list[tuple[int, int]]:
        """Chart and line of each row of the list."""
        return [(at, line) for at, chart in enumerate(self.charts) for line in range(len(chart.lines))]

    @property
    def chosen(self) -> tuple[int, int] | None:
        """Chart and line at the cursor."""
        rows = self.rows
        self.cursor = max(0, min(self.cursor, len(rows) - 1))
        return rows[self.cursor] if rows else None

    @property
    def chosen_spec(self) -> SeriesSpec | None:
        """The line at the cursor."""
        chosen = self.chosen
        return None if chosen is None else self.charts[chosen[0]].lines[chosen[1]]

    @property
    def fields(self) -> tuple[FieldId, ...]:
        """All fields that are drawn."""
        return tuple(dict.fromkeys(each for spec in self.specs() for each in spec.fields))

    def specs(self) -> Iterator[SeriesSpec]:
        """Yield all lines."""
        for chart in self.charts:
            yield from chart.lines

    def move(self, rows: int) -> None:
        """Move the cursor in the list."""
        self.cursor = max(0, min(self.cursor + rows, len(self.rows) - 1))

    def choose_chart(self, number: int) -> bool:
        """Move the cursor to the first line of a chart, 1 to 6."""
        rows = self.rows
        found = [at for at, (chart, _) in enumerate(rows) if chart == number - 1]
        self.cursor = found[0] if found else self.cursor
        return bool(found)

    def add(self, spec: SeriesSpec, chart: int | None) -> str | None:
        """Add a line to a chart (from 0), None: to a new one. Return why it cannot be added."""
        if chart is None or chart >= len(self.charts):
            if len(self.charts) >= MAX_CHARTS:
                return f"{MAX_CHARTS} charts are the most: x removes a field, a number 1-6 behind the name says where"
            self.charts.append(ChartSpec(spec.field.field))
            chart = len(self.charts) - 1
        lines = self.charts[chart].lines
        if spec in lines:
            return f"{spec.label} is in chart {chart + 1} already"
        if len(lines) >= MAX_LINES:
            return f"chart {chart + 1} has {MAX_LINES} fields already: x removes one"
        lines.append(spec)
        self.cursor = self.rows.index((chart, len(lines) - 1))
        return None

    def replace_chosen(self, spec: SeriesSpec) -> None:
        """Show another series in place of the chosen one."""
        chosen = self.chosen
        if chosen is not None:
            self.charts[chosen[0]].lines[chosen[1]] = spec

    def remove_chosen(self) -> SeriesSpec | None:
        """Remove the line at the cursor, and its chart with the last one."""
        chosen = self.chosen
        if chosen is None:
            return None
        removed = self.charts[chosen[0]].lines.pop(chosen[1])
        self.charts = [chart for chart in self.charts if chart.lines]
        return removed

    def copy(self, name: str) -> NamedView:
        """Return what is shown as a view of the user."""
        return NamedView(name, [ChartSpec(chart.title, list(chart.lines)) for chart in self.charts], own=True)


def next_view(views: Sequence[NamedView], name: str) -> NamedView | None:
    """Return the view after the one with this name that has any chart; None if there is none."""
    names = [view.name for view in views]
    start = names.index(name) + 1 if name in names else 0
    turned = [*views[start:], *views[:start]]
    return next((view for view in turned if view.charts), None)
