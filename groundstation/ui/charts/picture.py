"""What the widgets of the Charts screen draw, from the model: panes, list, statistics, timeline."""

from __future__ import annotations

import time
from collections.abc import Iterator

from groundstation.ui.charts.field_list import CandidateRow, ChartRow, ListRow, SeriesRow, TextRow, ViewRow
from groundstation.ui.charts.model import ChartsModel
from groundstation.ui.charts.pane import ChartPaneValue, PaneLine, nice_scale
from groundstation.ui.charts.series import SeriesSpec
from groundstation.ui.charts.stats import StatsRow
from groundstation.ui.charts.timeline import ChartTimelineValue, TimelineMark, TimelineMode

TIMES = 4
"""Times under the charts."""

CANDIDATES = 12
"""Fields that are listed while a name is typed."""


class Pictures:
    """Builds the values; a pane whose picture has not changed keeps its value, so that it is not drawn again."""

    def __init__(self, model: ChartsModel) -> None:
        self._model = model
        self._panes: dict[int, tuple[object, ChartPaneValue]] = {}
        self._stats: tuple[object, tuple[StatsRow, ...]] = (None, ())

    def pane(self, index: int) -> ChartPaneValue:
        """Return the chart with this index."""
        model, axis = self._model, self._model.axis
        chart = model.charts.charts[index]
        chosen = model.charts.chosen
        counts = tuple(model.points(spec).count for spec in chart.lines)
        at = axis.column(axis.cursor), axis.column(axis.mark)
        texts = tuple(self._now_text(spec) for spec in chart.lines)
        key = (
            axis.left,
            axis.step,
            counts,
            at,
            texts,
            tuple(chart.lines),
            chosen if chosen and chosen[0] == index else None,
        )
        if index not in self._panes or self._panes[index][0] != key:
            self._panes[index] = key, self._build(index, texts)
        return self._panes[index][1]

    def _build(self, index: int, texts: tuple[str, ...]) -> ChartPaneValue:
        model, axis = self._model, self._model.axis
        chart, chosen = model.charts.charts[index], model.charts.chosen
        columns = [model.columns(spec).between(axis.left, axis.right) for spec in chart.lines]
        left = axis.left
        shown = [each for line in columns for each in line if each.number >= left]
        least = min((10.0 ** -spec.decimals(model.infos.get(spec.field)) for spec in chart.lines), default=0.0)
        low, high, decimals = nice_scale(
            min((each.low for each in shown), default=0.0), max((each.high for each in shown), default=1.0), least
        )
        lines = tuple(
            PaneLine(short_name(spec), texts[slot], columns[slot], slot, chosen == (index, slot))
            for slot, spec in enumerate(chart.lines)
        )
        units = dict.fromkeys(unit for spec in chart.lines if (unit := model.unit(spec)))
        at = axis.column(axis.cursor), axis.column(axis.mark)
        is_chosen = chosen is not None and chosen[0] == index
        return ChartPaneValue(
            index + 1, chart.title, " ".join(units), lines, axis.left, low, high, decimals, *at, is_chosen
        )

    def _now_text(self, spec: SeriesSpec) -> str:
        """Return the value at the cursor, or the newest one."""
        model, axis = self._model, self._model.axis
        at = axis.cursor if axis.cursor is not None and axis.column(axis.cursor) is not None else axis.end
        return model.text(spec, model.value(spec, at))

    # ---- the list ----

    def list_rows(self) -> tuple[ListRow, ...]:
        """Return the rows of the list: charts with their lines, or the fields that match what is typed."""
        model = self._model
        rows: list[ListRow] = list(self._series_rows())
        if model.search.open:
            rows += [TextRow(""), TextRow(f"add a field: {model.search.matching} match")]
            rows += [
                CandidateRow(row.field.name, row.value, first=at == 0)
                for at, row in enumerate(model.search.rows[:CANDIDATES])
            ]
            rows += [TextRow("ENTER takes the first · a number 1-6"), TextRow("behind the name: that chart")]
            return tuple(rows)
        rows += [TextRow(""), TextRow("views")]
        for view in model.views:
            rows.append(ViewRow(view.name, shown=view.name == model.charts.name, empty=not view.charts, own=view.own))
        return tuple(rows)

    def _series_rows(self) -> Iterator[ListRow]:
        model, axis = self._model, self._model.axis
        chosen = model.charts.chosen
        for index, chart in enumerate(model.charts.charts):
            yield ChartRow(index + 1, chart.title, model.unit(chart.lines[0]) if chart.lines else "")
            for slot, spec in enumerate(chart.lines):
                at = None if axis.column(axis.cursor) is None else axis.cursor
                yield SeriesRow(
                    slot,
                    spec.label,
                    short_name(spec),
                    "" if at is None else model.text(spec, model.value(spec, at)),
                    model.text(spec, model.value(spec, axis.end)),
                    chosen=chosen == (index, slot),
                    pinned=all(field in model.pinned for field in spec.fields),
                    heard=model.is_heard(spec),
                )

    def stats_rows(self) -> tuple[StatsRow, ...]:
        """Return lowest, mean and highest value of each line in the window, at most once a second."""
        axis = self._model.axis
        key = (int(axis.end), axis.step, tuple(self._model.charts.specs()), self._model.store.state > 0)
        if self._stats[0] != key:
            self._stats = key, tuple(self._build_stats())
        return self._stats[1]

    def _build_stats(self) -> Iterator[StatsRow]:
        model = self._model
        for chart in model.charts.charts:
            for slot, spec in enumerate(chart.lines):
                stats = model.stats(spec)
                info = model.infos.get(spec.field)
                texts = (
                    ("--", "--", "--")
                    if stats is None
                    else tuple(
                        f"{each:.{min(2, spec.decimals(info))}f}" for each in (stats.low, stats.mean, stats.high)
                    )
                )
                yield StatsRow(short_name(spec), texts, model.unit(spec), slot)

    # ---- the time axis ----

    def timeline(self) -> ChartTimelineValue:
        """Return modes, marks and times."""
        model, axis = self._model, self._model.axis
        modes = [mark for mark in model.marks if mark.kind == "mode"]
        ends = [axis.column_of(mark.at) for mark in modes[1:]] + [axis.dots]
        bars = tuple(
            TimelineMode(max(0, axis.column_of(mark.at)), min(end, axis.dots), mark.text)
            for mark, end in zip(modes, ends, strict=False)  # without a mode there is no bar
            if end > 0 and axis.column_of(mark.at) < axis.dots
        )
        marks = tuple(
            TimelineMark(column, mark.kind, mark.text)
            for mark in model.marks
            if mark.kind != "mode" and (column := axis.column(mark.at)) is not None
        )
        cursor = axis.column(axis.cursor)
        return ChartTimelineValue(
            axis.dots, bars, marks, self.clock(axis.begin), self.clock(axis.end), cursor,
            "" if cursor is None or axis.cursor is None else self.clock(axis.cursor),
            self._between,
        )  # fmt: skip

    @property
    def _between(self) -> tuple[str, ...]:
        axis = self._model.axis
        thirds = (axis.begin + (axis.end - axis.begin) * number / (TIMES - 1) for number in range(1, TIMES - 1))
        return tuple(map(self.clock, thirds))

    def clock(self, at: float) -> str:
        """Return the time of day of a time of the station's clock."""
        if not self._model.axis.now:
            return ""
        return time.strftime("%H:%M:%S", time.localtime(at + self._model.store.wall_offset))


def short_name(spec: SeriesSpec) -> str:
    """Return a name without that of the message, for legends."""
    label = spec.label.replace(f"{spec.field.message}.", "")
    return label if spec.minus is None else label.replace(f"{spec.minus.message}.", "")
