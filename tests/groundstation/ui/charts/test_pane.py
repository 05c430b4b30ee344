"""The chart pane as text: gaps, patterns, scale, header, cursors. It needs a value and no keys."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from msgspec.structs import replace

from groundstation.ui.charts.columns import Columns
from groundstation.ui.charts.pane import (
    PATTERNS,
    ChartPaneValue,
    PaneLine,
    draw_chart,
    nice_scale,
    plot_dots,
    scale_text,
)
from groundstation.ui.charts.points import Points
from groundstation.ui.charts.timeline import ChartTimeline, ChartTimelineValue, TimelineMark, TimelineMode
from groundstation.ui.look.ascii import to_ascii
from tests.groundstation.ui.frames import texts

WIDTH = 38
DOTS = plot_dots(WIDTH)


def line(times: list[float], value: float = 0.5, slot: int = 0) -> PaneLine:
    """Return a level line of points, one second for each column of dots."""
    made, columns = Points(), Columns(1.0)
    for at in times:
        made.add(at, value)
    columns.update(made)
    return PaneLine("a", "0.50", columns.between(0, DOTS), slot)


def drawn(*lines: PaneLine, **changes: Any) -> list[str]:
    value = ChartPaneValue(1, "speed", "m/s", lines, left=0, low=0.0, high=1.0, decimals=1)
    return texts(draw_chart(replace(value, **changes), WIDTH, 5))


def row(*lines: PaneLine, **changes: Any) -> str:
    """The row of the picture with the value 0.5."""
    return drawn(*lines, **changes)[3][8:]


def test_a_line_goes_from_point_to_point_and_not_over_a_gap() -> None:
    whole = row(line([float(at) for at in range(DOTS)]))
    assert " " not in whole
    gap = row(line([float(at) for at in range(DOTS) if not 20 <= at < 40]))
    assert set(gap[11:19]) <= {" ", "⡀", "⠂"}
    assert " " not in gap[:9] + gap[21:]


def test_slow_points_are_joined_also_across_the_left_edge() -> None:
    assert " " not in row(line([float(at) for at in range(0, DOTS + 10, 10)]))
    columns = Columns(1.0)
    made = Points()
    for at in range(0, 60, 10):
        made.add(float(at), 0.5)
    columns.update(made)
    shown = row(PaneLine("a", "", columns.between(5, 5 + DOTS), 0), left=5)
    assert " " not in shown[:20]


def test_each_line_of_a_chart_has_a_pattern_of_its_own() -> None:
    rows = {row(line([float(at) for at in range(DOTS)], slot=slot)) for slot in range(len(PATTERNS))}
    assert len(rows) == len(PATTERNS) == 4


def test_the_header_has_what_fits_and_the_scale_its_bounds() -> None:
    found = drawn(line([0.0, 1.0]))
    assert found[0].startswith("─ 1 speed  ━━ a 0.50 ─")
    assert found[0].endswith("─ m/s ─")
    assert (found[1][:8].split(), found[4][:8].split()) == (["1.0"], ["0.0"])
    assert all(len(text) == WIDTH for text in found)
    many = [PaneLine("a_long_name_of_a_field", "1", (), slot) for slot in range(4)]
    assert len(drawn(*many)[0]) == WIDTH


def test_both_cursors_stand_on_all_rows() -> None:
    found = drawn(line([0.0, 1.0]), cursor=20, mark=40)
    assert all(text[8 + 10] == "│" and text[8 + 20] == "│" for text in found[1:])
    assert "│" not in "".join(drawn(line([0.0, 1.0]), cursor=DOTS + 5))


def test_a_pane_is_ascii_where_the_terminal_is() -> None:
    assert all(to_ascii(text).isascii() and "?" not in to_ascii(text) for text in drawn(line([0.0, 9.0]), cursor=3))


@given(st.floats(-1e12, 1e12), st.floats(0, 1e12), st.sampled_from([0.0, 1.0]))
@example(0.0, 5e-324, 0.0)
@example(-2e-308, 2e-308, 0.0)
def test_a_scale_has_all_values_in_it_whatever_they_are(low: float, span: float, least: float) -> None:
    bottom, top, decimals = nice_scale(low, low + span, least)
    slack = 1e-6 * (top - bottom)
    assert bottom <= low + slack
    assert top >= low + span - slack
    assert bottom < top
    assert top - bottom >= least - 1e-9
    assert 0 <= decimals < 10
    assert len(scale_text(low, decimals)) < 8


@pytest.mark.parametrize(
    ("low", "high", "wanted"),
    [(0.0, 0.83, (0.0, 1.0, 1)), (12.0, 12.0, (12.0, 12.3, 2)), (-3.0, 41.0, (-10.0, 50.0, 0)),
     (0.0, 0.0, (0.0, 1.0, 1)), (90.0, 100.0, (90.0, 100.0, 0))],
)  # fmt: skip
def test_scales_that_people_read(low: float, high: float, wanted: tuple[float, float, int]) -> None:
    assert nice_scale(low, high) == pytest.approx(wanted)


@pytest.mark.parametrize(("width", "shown"), [(90, 4), (40, 2)])
def test_times_stand_under_the_charts_where_there_is_room(width: int, shown: int) -> None:
    times = ("10:00:20", "10:00:40")
    value = ChartTimelineValue(60, begin="10:00:00", end="10:01:00", between=times)
    line = texts(ChartTimeline(value).draw(width, 3))[2]
    assert line.split() == ["time", "10:00:00", *(times if shown == 4 else ()), "10:01:00"]


def test_the_timeline_draws_modes_events_and_keys_by_room() -> None:
    value = ChartTimelineValue(
        60, (TimelineMode(0, 30, "HOLD"), TimelineMode(30, 60, "MANUAL")),
        (TimelineMark(30, "armed", "armed"), TimelineMark(33, "key", "i"), TimelineMark(50, "link", "link lost")),
        "10:00:00", "10:01:00", 59, "10:01:00",
    )  # fmt: skip
    modes, marks, times = texts(ChartTimeline(value).draw(WIDTH, 3))
    assert "━━ HOLD ━" in modes
    assert "━━ MANUAL ━" in modes
    assert marks[8 + 15] == "▲"
    assert marks[8 + 16] == "i"
    assert marks[8 + 25] == "!"
    assert "armed" not in marks  # the key stands there
    assert times.count("10:01:00") == 1
