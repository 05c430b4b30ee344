"""The cursor and the part of the ground that is in view."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.map.draw.ground import NOT_FITTED, Ground, Looking
from groundstation.ui.map.draw.window import FITTED, SCALES, MapWindow, fit_window
from tests.groundstation.ui.map.plans import AROUND, HOME, at

ACROSS, DOWN = 180, 120


def ground() -> Ground:
    made = Ground()
    made.frame, made.cursor, made.vehicle = AROUND, HOME, (0.0, 0.0)
    made.set_size(ACROSS // 2, DOWN // 4)
    made.look(((0.0, 0.0),))
    return made


def looking(of: Ground) -> Looking:
    return of.looking


@given(st.lists(st.tuples(st.floats(-5e3, 5e3), st.floats(-5e3, 5e3)), min_size=1, max_size=20))
def test_a_fit_shows_everything(points: list[tuple[float, float]]) -> None:
    window = fit_window(points, ACROSS, DOWN)
    assert all(window.shows(point, ACROSS, DOWN) for point in points)


def test_a_fit_of_one_point_shows_some_metres_around_it() -> None:
    assert fit_window([(3.0, 4.0)], ACROSS, DOWN).zoom == FITTED
    assert fit_window([], ACROSS, DOWN) == MapWindow()


def test_arrows_move_the_cursor_by_cells_and_the_window_follows() -> None:
    made = ground()
    scale = made.window.scale
    made.move(2, -3)
    assert made.cursor_point == pytest.approx((2 * 4 * scale, -3 * 2 * scale), abs=1e-6)
    assert looking(made) is Looking.FIT
    made.move(100, 0)
    assert looking(made) is Looking.FREE
    made.look(())
    assert made.cursor_point is not None
    assert made.window.shows(made.cursor_point, ACROSS, DOWN)


def test_zooming_keeps_the_cursor_in_view_and_has_limits() -> None:
    made = ground()
    made.cursor = at(5, 5)
    for _ in range(100):
        made.zoom(-1)
    assert made.window.scale == 0.05
    assert (made.window.north, made.window.east) == pytest.approx((5, 5), abs=1e-3)
    for _ in range(100):
        made.zoom(1)
    assert made.window.scale == SCALES[-1]


def test_following_moves_in_steps() -> None:
    made = ground()
    made.follow()
    seen = set()
    for step in range(400):
        made.vehicle = (0.0, step * 0.25)
        made.look(())
        seen.add(made.window)
        assert made.window.shows(made.vehicle, ACROSS, DOWN)
    assert len(seen) < 20, "not at each metre"
    made.follow()
    assert made.looking is Looking.FREE


def test_a_fit_rarely_moves_the_map() -> None:
    made, seen = ground(), set()
    for step in range(400):
        made.look(((0.0, 0.0), (step * 0.25, 0.0)))
        seen.add(made.window)
    assert len(seen) < 20
    made.fit()
    assert made.window is NOT_FITTED
    made.look(((0.0, 0.0),))
    assert made.window.zoom == FITTED


def test_before_the_map_is_laid_out_nothing_moves() -> None:
    made = Ground()
    made.frame, made.cursor = AROUND, HOME
    made.look(((0.0, 0.0), (1e4, 0.0)))
    made.move(1, 1)
    made.zoom(1)
    assert (made.window, made.cursor) == (NOT_FITTED, HOME)


def test_without_a_place_nothing_moves() -> None:
    made = Ground()
    made.move(1, 1)
    made.zoom(-1)
    made.look(())
    assert made.cursor is None
    made.cursor, made.frame = HOME, AROUND
    made.measure()
    assert made.measured == HOME
    made.measure()
    assert made.measured is None
