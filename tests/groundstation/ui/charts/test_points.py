"""Points, derived lines and columns: gaps, nothing twice, pictures that cost their width."""

from __future__ import annotations

import math

from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.charts.columns import Columns
from groundstation.ui.charts.points import SPAN, SPARE, Points, PointStore
from groundstation.ui.charts.series import Line, SeriesSpec
from groundstation.views.charts import FieldId, SeriesPage
from tests.groundstation.ui.example_charts import points

A, B = FieldId(1, 1, False, "M", "a"), FieldId(1, 1, False, "M", "b")


def store(*fields: FieldId) -> PointStore:
    made = PointStore()
    made.keep(fields)
    return made


def filled(times: list[float]) -> Points:
    made = Points()
    for at in times:
        made.add(at, at * 2)
    return made


def test_a_pause_longer_than_usual_is_a_gap() -> None:
    fast = filled([0.0, 0.1, 0.2, 0.3, 5.0, 5.1])
    slow = filled([0.0, 10.0, 20.0, 30.0, 45.0, 100.0])
    assert [index for index, gap in enumerate(fast.breaks) if gap] == [4]
    assert [index for index, gap in enumerate(slow.breaks) if gap] == [5]


def test_in_a_gap_and_after_the_end_there_is_no_value() -> None:
    made = filled([0.0, 0.1, 0.2, 5.0, 5.1])
    assert made.value_at(-1.0) is None
    assert made.value_at(0.15) == 0.2
    assert made.value_at(0.2) == 0.4
    assert made.value_at(3.0) is None
    assert made.value_at(5.5) == 10.2
    assert made.value_at(60.0) is None


def test_a_page_that_does_not_follow_is_ignored() -> None:
    made = store(A)
    page = SeriesPage(10, 0, 5.0, 1e9, (points(A, [1.0, 2.0], float),))
    assert made.add(page)
    assert not made.add(page)
    assert list(made.fields[A].times) == [1.0, 2.0]
    assert made.add(SeriesPage(12, 10, 6.0, 1e9, (points(A, [3.0], float), points(B, [3.0], float))))
    assert list(made.fields[A].times) == [1.0, 2.0, 3.0]
    assert (made.state, made.now, made.wall_offset) == (12, 6.0, 1e9 - 6.0)


def test_points_are_kept_for_ten_minutes() -> None:
    made = store(A)
    for number in range(200):
        times = [number * 10 + tenth / 10 for tenth in range(100)]
        made.add(SeriesPage(number + 1, number, times[-1], 0.0, (points(A, times, float),)))
    kept = made.fields[A]
    assert 10 * SPAN <= len(kept.times) <= 10 * SPAN + SPARE + 100
    assert kept.count == 20_000


def test_a_factor_scales_and_a_rate_is_the_change_a_second() -> None:
    made = store(A)
    made.add(SeriesPage(1, 0, 1.0, 0.0, (points(A, [at / 5 for at in range(20)], lambda at: 3 * at),)))
    scaled, rate = Line(SeriesSpec(A, factor=0.5)).update(made), Line(SeriesSpec(A, rate=True)).update(made)
    assert math.isclose(scaled.values[-1], 1.5 * 3.8)
    assert len(rate.values) == 19
    assert all(math.isclose(value, 3.0) for value in rate.values)


def test_a_rate_is_not_taken_over_a_gap() -> None:
    made = store(A)
    times = [0.0, 0.2, 0.4, 0.6, 9.0, 9.2]
    made.add(SeriesPage(1, 0, 10.0, 0.0, (points(A, times, float),)))
    rate = Line(SeriesSpec(A, rate=True)).update(made)
    assert list(rate.times) == [0.2, 0.4, 0.6, 9.2]


def test_a_difference_waits_for_the_other_field() -> None:
    made, line = store(A, B), Line(SeriesSpec(A, minus=B))
    made.add(SeriesPage(1, 0, 1.0, 0.0, (points(A, [0.0, 0.2, 0.4], lambda at: 5.0),)))
    assert len(line.update(made).times) == 0
    made.add(SeriesPage(2, 1, 1.0, 0.0, (points(B, [0.1, 0.3], lambda at: 2.0),)))
    assert list(line.update(made).times) == [0.2]
    made.add(SeriesPage(3, 2, 1.0, 0.0, (points(B, [0.5], lambda at: 1.0),)))
    found = line.update(made)
    assert (list(found.times), list(found.values)) == ([0.2, 0.4], [3.0, 3.0])


@given(st.lists(st.tuples(st.floats(0.001, 3.0), st.floats(-1e6, 1e6)), max_size=120), st.floats(0.05, 2.0))
def test_columns_have_the_extremes_however_the_points_arrive(steps: list[tuple[float, float]], width: float) -> None:
    """Columns that grew with the points are those of all points at once."""
    made, growing, at = Points(), Columns(width), 0.0
    for number, (step, value) in enumerate(steps):
        at += step
        made.add(at, value)
        if number % 7 == 0:
            growing.update(made)
    growing.update(made)
    whole = Columns(width)
    whole.update(made)
    assert growing.between(-1, 10**9) == whole.between(-1, 10**9)
    found = whole.between(-1, 10**9)
    values = [value for _, value in steps]
    assert [column.number for column in found] == sorted(column.number for column in found)
    if values:
        assert min(column.low for column in found) == min(values)
        assert max(column.high for column in found) == max(values)
    assert sum(column.broken for column in found) == sum(made.breaks)


@given(st.lists(st.floats(0.0, 99.0), min_size=1, max_size=8))
def test_the_picture_does_not_depend_on_where_it_was_before(begins: list[float]) -> None:
    points_of_a_line, moving = filled([at * 0.7 for at in range(150)]), Columns(0.5)
    for begin in begins:
        left = int(begin // 0.5)
        moving.update(points_of_a_line, left * 0.5)
        whole = Columns(0.5)
        whole.update(points_of_a_line)
        assert moving.between(left, left + 40) == whole.between(left, left + 40)


def test_columns_outside_the_window_cost_only_the_one_before_it() -> None:
    made = Columns(1.0)
    made.update(filled([float(at) for at in range(100)]))
    assert [column.number for column in made.between(50, 52)] == [49, 50, 51, 52]
