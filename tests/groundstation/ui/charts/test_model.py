"""The model of the Charts screen: views, cursors, search, pins, saved views."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundstation.intents.charts import PinSeries
from groundstation.ui.charts.chart_set import MAX_CHARTS, MAX_LINES
from groundstation.ui.charts.model import ChartsModel
from groundstation.ui.charts.saved_views import FILE, load_views
from groundstation.ui.charts.series import SeriesSpec
from groundstation.ui.charts.time_axis import WINDOWS
from groundstation.views.charts import FieldId, FieldsRequest, SeriesPage, SeriesRequest
from tests.groundstation.ui.example_charts import DEMAND, NOW, SPEED, STATE, TURN, VOLTS, drive, fields_page


def model(folder: Path, *, shown: bool = True) -> ChartsModel:
    """Return a model that has the fields and, if `shown`, the points of the view "drive"."""
    made = ChartsModel(folder)
    made.show_fields(fields_page())
    if shown:
        made.next_view()
        made.requests()
        made.show_series(drive())
    return made


def requests(made: ChartsModel) -> tuple[SeriesRequest, FieldsRequest]:
    series, fields = made.requests()
    assert isinstance(series, SeriesRequest)
    assert isinstance(fields, FieldsRequest)
    return series, fields


def labels(made: ChartsModel) -> list[list[str]]:
    return [[spec.label for spec in chart.lines] for chart in made.charts.charts]


def test_views_that_have_a_field_come_one_after_the_other(tmp_path: Path) -> None:
    made = model(tmp_path, shown=False)
    assert requests(made)[0] == SeriesRequest((), 0)
    names = []
    for _ in range(3):
        assert made.next_view() is None
        names.append(made.charts.name)
    assert names == ["drive", "power", "drive"]
    assert requests(made)[0].fields == (SPEED, DEMAND, TURN)
    silent = ChartsModel(tmp_path)
    silent.show_fields(fields_page(empty=True))
    assert "no view has a field yet" in (silent.next_view() or "")


def test_the_next_request_begins_where_the_page_ended(tmp_path: Path) -> None:
    made = model(tmp_path)
    assert requests(made)[0].after == 2000
    made.show_series(drive(after=0))
    assert requests(made)[0].after == 2000
    assert len(made.marks) == 7


def test_the_window_has_steps_and_ends(tmp_path: Path) -> None:
    axis = model(tmp_path).axis
    assert [axis.zoom(-1), axis.zoom(-1), axis.zoom(-1)] == [True, True, False]
    assert axis.window == WINDOWS[0]
    assert [axis.zoom(1) for _ in WINDOWS] == [True] * 5 + [False]


def test_a_pause_stops_the_picture_and_not_the_data(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.axis.toggle_pause()
    made.show_series(SeriesPage(2100, 2000, NOW + 20, 0.0))
    assert (made.axis.end, made.axis.now) == (NOW, NOW + 20)
    assert requests(made)[0].after == 2100
    made.axis.toggle_pause()
    assert made.axis.end == NOW + 20


def test_scrolling_goes_to_the_oldest_point_and_back_to_live(tmp_path: Path) -> None:
    axis = model(tmp_path).axis
    axis.zoom(-1)
    axis.scroll(-0.5)
    assert (axis.paused_at, axis.end) == (NOW - 15, NOW - 15)
    axis.scroll(-1e6)
    assert axis.end == pytest.approx(NOW - 60 + 30)
    axis.scroll(1e6)
    assert axis.paused_at is None


def test_two_cursors_measure_the_chosen_line(tmp_path: Path) -> None:
    made = model(tmp_path)
    assert made.axis.set_mark() is False
    made.axis.dots = 120
    made.charts.choose_chart(2)
    made.axis.cursor = 950.0
    assert made.axis.set_mark()
    made.axis.cursor = 960.0
    assert made.measure() == "Δt 10.00 s · Δ +60.00 % · slope +6.00 %/s"
    made.charts.choose_chart(1)
    made.axis.cursor = 984.0
    assert made.measure().endswith("no value at both cursors")
    made.axis.clear_cursors()
    assert made.measure() == ""


def test_the_cursor_stays_in_the_picture(tmp_path: Path) -> None:
    axis = model(tmp_path).axis
    axis.dots = 120
    for cells, least, most in ((-1, NOW - 2, NOW), (-1000, NOW - 61, NOW - 59), (1000, NOW - 1, NOW)):
        axis.move_cursor(cells)
        assert axis.cursor is not None
        assert least <= axis.cursor <= most
        assert axis.column(axis.cursor) is not None


def test_a_field_goes_where_its_unit_fits_or_the_number_says(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.add(VOLTS, "V")
    assert labels(made)[3] == ["SYS_STATUS.voltage_battery"]
    made.add(FieldId(1, 1, False, "GPS_RAW_INT", "vel"), "m/s")
    assert labels(made)[0][1] == "GPS_RAW_INT.vel"
    made.search.begin(made.add_found)
    made.search.type("stat 2")
    assert requests(made)[1].text == "stat"
    made.search.submit("volt 2")
    made.show_fields(fields_page("volt"))
    assert labels(made)[1] == ["ROVER_DRIVE_STATUS.demand_throttle", "SYS_STATUS.voltage_battery"]
    assert requests(made)[1].count == 0


def test_a_name_that_matches_nothing_is_said_once(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.search.begin(made.add_found)
    made.search.submit("zzz")
    made.show_fields(fields_page("volt"))
    assert made.pop_note() is None
    page = fields_page("zzz")
    made.show_fields(type(page)("zzz", (), 0, 412, page.known, page.ready))
    assert made.pop_note() == "no field matches “zzz”"
    assert made.pop_note() is None


def test_charts_and_lines_are_bounded_and_a_line_is_there_once(tmp_path: Path) -> None:
    made = ChartsModel(tmp_path)
    for number in range(MAX_CHARTS):
        assert made.charts.add(SeriesSpec(FieldId(1, 1, False, "M", f"f{number}")), None) is None
    assert "charts are the most" in (made.charts.add(SeriesSpec(VOLTS), None) or "")
    for number in range(MAX_LINES - 1):
        assert made.charts.add(SeriesSpec(FieldId(1, 1, False, "N", f"f{number}")), 0) is None
    assert "has 4 fields already" in (made.charts.add(SeriesSpec(VOLTS), 0) or "")
    assert "in chart 1 already" in (made.charts.add(SeriesSpec(FieldId(1, 1, False, "M", "f0")), 0) or "")


def test_the_last_line_takes_its_chart_along(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.charts.move(1)
    made.remove()
    assert labels(made) == [["VFR_HUD.groundspeed"], ["ATTITUDE.yawspeed"]]
    made.remove()
    made.remove()
    assert (made.remove(), made.charts.charts, requests(made)[0].fields) == (None, [], ())


def test_pins_are_always_requested_and_end_with_their_line(tmp_path: Path) -> None:
    made = model(tmp_path)
    assert made.toggle_pin() == PinSeries((SPEED,))
    made.next_view()
    assert requests(made)[0].fields == (VOLTS, SPEED)
    made.next_view()
    assert made.remove() == PinSeries(())
    note, intent = made.pin_field(VOLTS, "V")
    assert (intent, "recorded" in note) == (PinSeries((VOLTS,)), True)
    assert made.toggle_pin() == PinSeries(())


def test_derived_lines_have_names_and_units(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.toggle_rate()
    assert next(made.unit(spec) for spec in made.charts.specs()) == "m/s/s"
    assert made.scale("x") == "“x” is not a number"
    assert made.scale("0") is not None
    assert made.scale("nan") is not None
    assert made.scale("3.6") is None
    made.subtract_found(fields_page("volt").rows[0], None)
    assert labels(made)[0] == ["rate of VFR_HUD.groundspeed - SYS_STATUS.voltage_battery ×3.6"]
    assert requests(made)[0].fields == (SPEED, VOLTS, DEMAND, TURN)


def test_an_enum_value_is_shown_by_its_name(tmp_path: Path) -> None:
    made = model(tmp_path)
    assert made.text(SeriesSpec(STATE), 4.0) == "ACTIVE"
    assert made.text(SeriesSpec(STATE), 77.0) == "77"
    assert made.text(SeriesSpec(VOLTS), 12.1) == "12.100"
    assert made.text(SeriesSpec(VOLTS), None) == "--"


def test_a_saved_view_is_there_in_the_next_session(tmp_path: Path) -> None:
    made = model(tmp_path)
    made.scale("2")
    assert "choose another name" in made.save_view("power")
    assert "a view needs a name" in made.save_view("  ")
    assert made.save_view("my drive") == f"view “my drive” saved in {tmp_path / FILE}"
    later = model(tmp_path, shown=False)
    assert [view.name for view in later.views] == ["drive", "power", "link", "my drive"]
    later.show_view(later.views[-1])
    assert labels(later) == labels(made)


@pytest.mark.parametrize("text", ["", "{", "[1]", '[{"name": 3}]', '[{"name": "a", "charts": [{"title": "b"}]}]'])
def test_a_broken_file_of_views_is_named_and_nothing_is_lost(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text)
    views, problem = load_views(tmp_path)
    assert views == []
    assert problem is not None
    assert FILE in problem
    assert "\n" not in problem


def test_an_unwritable_folder_keeps_the_view_in_memory(tmp_path: Path) -> None:
    made = model(tmp_path / "missing")
    assert "kept until the program ends" in made.save_view("mine")
    assert made.views[-1].name == "mine"
