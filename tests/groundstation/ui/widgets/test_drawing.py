"""What each instrument draws, without an app."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from textual.strip import Strip

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.snapshot import LogLine, MessageRate
from groundstation.ui.colours import style
from groundstation.ui.keynames import format_key, main_key
from groundstation.ui.widgets.canvas import Canvas
from groundstation.ui.widgets.chart import Chart, Series
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from groundstation.ui.widgets.heading_tape import heading_marks
from groundstation.ui.widgets.horizon import Horizon, HorizonValue, ground_fraction
from groundstation.ui.widgets.keycaps import lit_actions
from groundstation.ui.widgets.log import LogPanel
from groundstation.ui.widgets.rates import RatesPanel
from groundstation.ui.widgets.speed import speed_text
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from groundstation.ui.widgets.sticks import Bar, bar_cells, build_bars
from groundstation.ui.widgets.track import TrackMap, TrackValue, fit_view
from tests.groundstation.ui.examples import RATES, helm, snapshot, vehicle

STANDARD = Keymap("standard", KEYMAPS["standard"])
metres = st.floats(-1e5, 1e5)


def text(strips: list[Strip]) -> list[str]:
    return [strip.text for strip in strips]


# ---- canvas ----


def test_each_dot_of_a_cell_has_its_bit() -> None:
    seen = set()
    for x in range(2):
        for y in range(4):
            canvas = Canvas(1, 1)
            canvas.dot(x, y, style())
            seen.add(canvas.strips()[0].text)
    assert seen == {chr(0x2800 + (1 << bit)) for bit in range(8)}


def test_dots_outside_are_dropped() -> None:
    canvas = Canvas(2, 1)
    for x, y in ((-1, 0), (4, 0), (0, -1), (0, 4)):
        canvas.dot(x, y, style())
    canvas.line((-50.0, 2.0), (1e9, 2.0), style())
    canvas.word(-1, 0, "ab", style())
    assert text(canvas.strips()) == ["b "]


def test_a_line_has_no_holes() -> None:
    canvas = Canvas(4, 1)
    canvas.line((0, 0), (7, 0), style())
    assert text(canvas.strips()) == ["⠉⠉⠉⠉"]


# ---- track ----


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


# ---- horizon, tape, speed ----


def test_level_is_half_ground() -> None:
    level = HorizonValue(0.0, 0.0)
    assert [ground_fraction(level, 0, row, 4) for row in range(4)] == [0.0, 0.0, 1.0, 1.0]


def test_nose_up_shows_sky_and_right_side_down_lifts_the_horizon_at_the_right() -> None:
    up, right = HorizonValue(0.0, 0.2), HorizonValue(0.3, 0.0)
    assert ground_fraction(up, 0, 2, 4) < 1.0
    assert ground_fraction(right, 8, 1, 4) > ground_fraction(right, -8, 1, 4)


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi))
def test_the_horizon_fills_its_place_at_any_attitude(roll: float, pitch: float) -> None:
    assert all(len(line) == 22 for line in text(Horizon(HorizonValue(roll, pitch)).draw(22, 5)))


@pytest.mark.parametrize(("heading", "middle"), [(0, "N"), (90, "E"), (359, "N"), (225, "SW"), (120, "120")])
def test_the_tape_has_the_heading_in_its_middle(heading: int, middle: str) -> None:
    marks = heading_marks(heading, 41)
    assert len(marks) == 41
    assert middle in marks[17:24]


@pytest.mark.parametrize(
    ("speed", "shown"),
    [
        (0.84, " 0.84"), (-0.84, "-0.84"), (-0.001, " 0.00"), (12.345, "12.35"), (-1e9, "-9.99"), (math.nan, " -.--"),
        (None, " -.--"),
    ],
)  # fmt: skip
def test_the_speed_keeps_its_width(speed: float | None, shown: str) -> None:
    assert speed_text(vehicle(speed=speed)) == shown


# ---- bars ----


@given(st.integers(-100, 100), st.none() | st.integers(-100, 100), st.integers(5, 60))
def test_a_bar_always_has_its_width(percent: int, obeyed: int | None, width: int) -> None:
    width |= 1
    assert len("".join(part for part, _ in bar_cells(Bar("x", "#ffffff", percent, obeyed), width))) == width


def test_a_bar_grows_from_the_middle() -> None:
    def filled(percent: int) -> list[int]:
        parts = [
            (len(part), look.bgcolor.name) for part, look in bar_cells(Bar("x", "#123456", percent), 21) if look.bgcolor
        ]
        return [length for length, ground in parts if ground == "#123456"]

    assert filled(0) == [0]
    assert sum(filled(50)) == 5
    assert sum(filled(-50)) == 5
    assert sum(filled(100)) == 10


def test_two_motors_are_left_and_right_and_others_are_counted() -> None:
    assert [bar.label for bar in build_bars(snapshot())] == ["throttle", "steering", "left", "right"]
    four = snapshot(vehicle=vehicle(outputs=(0.1, 0.2, 0.3, 0.4)))
    assert [bar.label for bar in build_bars(four)][2:] == ["motor 1", "motor 2", "motor 3", "motor 4"]


# ---- keys ----


@pytest.mark.parametrize(
    ("key", "shown"),
    [
        ("i", "i"),
        ("comma", ","),
        ("space", "SPACE"),
        ("ctrl+q", "^q"),
        ("f9", "F9"),
        ("question_mark", "?"),
        ("up", "↑"),
    ],
)
def test_keys_are_written_as_people_do(key: str, shown: str) -> None:
    assert format_key(key) == shown


def test_an_arrow_lights_the_cap_of_its_direction() -> None:
    assert lit_actions(frozenset({"up"}), STANDARD) == lit_actions(frozenset({"i"}), STANDARD) == {"drive.forward"}
    assert lit_actions(frozenset({"r", "question_mark"}), STANDARD) == frozenset()


def test_caps_show_the_block_around_k() -> None:
    assert [main_key(STANDARD, f"drive.{name}") for name in ("forward", "backward", "left", "right", "stop")] == [
        "i", "comma", "j", "l", "k",
    ]  # fmt: skip


@pytest.mark.parametrize("width", [80, 100, 140])
@pytest.mark.parametrize("keymap", list(KEYMAPS))
def test_the_footer_always_has_the_stops_and_the_way_out(width: int, keymap: str) -> None:
    line = KeyFooter(FooterValue(Keymap(keymap, KEYMAPS[keymap]))).draw(width, 1)[0].text
    assert len(line) == width
    for words in ("SPACE Stop", "! E-STOP", "? Help", "^q Quit"):
        assert words in line


# ---- lines and tables ----


def test_control_characters_from_the_wire_do_not_reach_the_terminal() -> None:
    nasty = LogLine(time=0.0, severity=6, label="vehicle", text="a\x1b[2Jb\x07\n", count=1)
    assert "\x1b" not in "".join(text(LogPanel((nasty,)).draw(80, 1)))


def test_the_log_shows_the_newest_and_how_often() -> None:
    lines = tuple(LogLine(time=0.0, severity=6, label="vehicle", text=str(n), count=n) for n in range(10))
    shown = text(LogPanel(lines).draw(80, 3))
    assert [line.split()[2] for line in shown] == ["7", "8", "9"]
    assert "×9" in shown[-1]


def test_a_table_that_is_too_long_says_so() -> None:
    rates = tuple(MessageRate(name=name, rate=rate, count=count, sent=sent) for name, rate, count, sent in RATES)
    assert text(RatesPanel(rates).draw(40, 6))[-1] == f"and {len(rates) - 4} more"
    assert len(RatesPanel(rates).draw(40, 30)) == len(rates) + 1


@pytest.mark.parametrize("width", [80, 100, 119])
def test_on_two_lines_nothing_important_is_left_out(width: int) -> None:
    value = StatusBarValue(snapshot(operator=helm()), 0.004)
    lines = " ".join(text(StatusBar(value).draw(width, 2)))
    for words in ("ARMED", "you drive", "link", "loss", "rtt", "cmd", "key→motor", "tty", "batt", "gps"):
        assert words in lines


def test_a_vehicle_in_emergency_stop_is_not_shown_as_armed() -> None:
    line = StatusBar(StatusBarValue(snapshot(vehicle=vehicle(emergency_stop=True, armed=True)))).draw(80, 2)[0].text
    assert "EMERGENCY STOP" in line
    assert "ARMED" not in line


def test_a_chart_takes_gaps_and_keeps_a_minute() -> None:
    chart = Chart((), title="speed", unit="m/s", series=(Series("", "#ffffff"),), step=0.5, id="x")
    for second in range(200):
        chart.add(float(second), None if second % 7 == 0 else second / 100)
    assert 59 <= len(chart.value) <= 61
    assert len(chart.draw(40, 6)) == 6
    assert "1.99 m/s" in text(chart.draw(40, 6))[0]
