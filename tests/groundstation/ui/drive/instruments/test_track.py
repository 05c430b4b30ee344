"""The track map."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.drive.instruments.track import TrackMap, TrackValue, fit_view
from groundstation.ui.widgets.canvas import Canvas

metres = st.floats(-1e5, 1e5)
near = st.floats(-20, 20)


@given(st.lists(st.tuples(metres, metres), max_size=50), st.tuples(metres, metres), st.none() | st.floats(-10, 10))
def test_the_vehicle_is_always_on_the_map(
    track: list[tuple[float, float]], position: tuple[float, float], heading: float | None
) -> None:
    value = TrackValue(position, heading, (0.0, 0.0), tuple(track))
    canvas = Canvas(36, 14)
    x, y = fit_view(value, canvas.across, canvas.down).to_canvas(position, canvas)
    assert 0 <= x < canvas.across
    assert 0 <= y < canvas.down
    assert len(TrackMap(value).draw(36, 14)) == 14


def test_the_map_stands_still_while_the_vehicle_moves_a_little() -> None:
    a = TrackValue((3.0, 4.0), 0.0, (0.0, 0.0), ((0.0, 0.0), (3.0, 4.0)))
    b = TrackValue((3.1, 4.1), 0.0, (0.0, 0.0), ((0.0, 0.0), (3.1, 4.1)))
    assert fit_view(a, 72, 56) == fit_view(b, 72, 56)


def test_north_is_up_and_east_is_right() -> None:
    canvas = Canvas(36, 14)
    view = fit_view(TrackValue((0.0, 0.0)), canvas.across, canvas.down)
    x, y = view.to_canvas((0.0, 0.0), canvas)
    north, east = view.to_canvas((1.0, 0.0), canvas), view.to_canvas((0.0, 1.0), canvas)
    assert north[1] < y
    assert east[0] > x


def test_zooming_in_shows_less_around_vehicle_and_out_shows_more() -> None:
    track = tuple((float(step), 0.0) for step in range(100))
    canvas = Canvas(36, 14)

    def scale(zoom: int) -> float:
        return fit_view(TrackValue((99.0, 0.0), 0.0, (0.0, 0.0), track, zoom=zoom), canvas.across, canvas.down).scale

    assert scale(2) == scale(0) / 4
    assert scale(-2) == scale(0) * 4


@given(st.tuples(metres, metres), st.integers(0, 5))
def test_the_vehicle_is_on_the_map_at_each_zoom(position: tuple[float, float], zoom: int) -> None:
    canvas = Canvas(36, 14)
    value = TrackValue(position, 0.0, (0.0, 0.0), ((0.0, 0.0), position), zoom=zoom)
    x, y = fit_view(value, canvas.across, canvas.down).to_canvas(position, canvas)
    assert 0 <= x < canvas.across
    assert 0 <= y < canvas.down


@given(st.lists(st.tuples(near, near), min_size=1, max_size=30), st.integers(0, 30), st.integers(1, 3))
def test_a_track_that_grew_is_drawn_as_one_that_was_there(
    track: list[tuple[float, float]], known: int, stride: int
) -> None:
    grown = TrackMap(TrackValue(track[0], 0.5, (0.0, 0.0), tuple(track[:known])))
    grown.draw(36, 14)
    for points in (track, track[::stride], track):
        value = TrackValue(points[-1], 0.5, (0.0, 0.0), tuple(points))
        grown._value = value
        assert grown.draw(36, 14) == TrackMap(value).draw(36, 14)
