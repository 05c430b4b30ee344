"""Views that the user has saved: a JSON file in the folder where screens save files."""

from __future__ import annotations

from pathlib import Path

import msgspec

from groundstation.ui.charts.chart_set import MAX_CHARTS, MAX_LINES, ChartSpec, NamedView
from groundstation.ui.charts.series import SeriesSpec
from groundstation.views.charts import FieldId
from link.runtime.whole_file import replace_file

FILE = "chart-views.json"
MAX_VIEWS = 50
MAX_SIZE = 1 << 20
"""Bytes of a file that is read."""


class _SavedLine(msgspec.Struct):
    field: FieldId
    factor: float = 1.0
    minus: FieldId | None = None
    rate: bool = False


class _SavedChart(msgspec.Struct):
    title: str
    lines: list[_SavedLine]


class _SavedView(msgspec.Struct):
    name: str
    charts: list[_SavedChart]


def load_views(folder: Path) -> tuple[list[NamedView], str | None]:
    """Return the saved views, and one line about a file that cannot be read."""
    path = folder / FILE
    try:
        if path.stat().st_size > MAX_SIZE:
            return [], f"{path}: too long, chart views were not read"
        saved = msgspec.json.decode(path.read_bytes(), type=list[_SavedView])
    except FileNotFoundError:
        return [], None
    except OSError as error:
        return [], f"{path}: {error.strerror}: chart views were not read"
    except msgspec.MsgspecError as error:
        return [], f"{path}: {error}: chart views were not read"
    return [_view(each) for each in saved[:MAX_VIEWS]], None


def save_views(folder: Path, views: list[NamedView]) -> Path:
    """Write the views of the user. Raises OSError."""
    path = folder / FILE
    saved = [_SavedView(view.name, [_saved_chart(chart) for chart in view.charts]) for view in views if view.own]
    replace_file(path, msgspec.json.format(msgspec.json.encode(saved), indent=1))
    return path


def _saved_chart(chart: ChartSpec) -> _SavedChart:
    return _SavedChart(
        chart.title, [_SavedLine(line.field, line.factor, line.minus, line.rate) for line in chart.lines]
    )


def _view(saved: _SavedView) -> NamedView:
    charts = [
        ChartSpec(
            chart.title,
            [SeriesSpec(line.field, line.factor, line.minus, line.rate) for line in chart.lines[:MAX_LINES]],
        )
        for chart in saved.charts[:MAX_CHARTS]
    ]
    return NamedView(saved.name, charts, own=True)
