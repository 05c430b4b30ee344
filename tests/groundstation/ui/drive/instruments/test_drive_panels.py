"""Panels of the Drive screen: stop bounds, key to motor, health, mission."""

from __future__ import annotations

import math

import pytest

from groundstation.snapshot import OutputView, Snapshot
from groundstation.snapshot.drive import HealthLine, KeyToMotor, MissionProgress, StopBound, Timing
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.instruments.health import HealthPanel
from groundstation.ui.drive.instruments.key_to_motor import WayPanel, WayValue
from groundstation.ui.drive.instruments.mission import MissionStrip, MissionValue
from groundstation.ui.drive.instruments.stops import StopsLine, StopsPanel, StopsValue, share_colour
from groundstation.ui.drive.instruments.stops_model import all_stops, is_near
from groundstation.ui.look.colours import AMBER, DIM, GREEN, RED
from tests.groundstation.ui.examples import FOREIGN_STOPS, FOREIGN_WAY, HEALTH, MISSION, STOPS, helm, snapshot, vehicle
from tests.groundstation.ui.frames import texts
from tests.groundstation.ui.ptys import STANDARD


def state(picture: Snapshot, silence: float | None = None) -> DisplayState:
    return DisplayState(picture, STANDARD, terminal_silence=silence)


def stops(*bounds: StopBound) -> StopsValue:
    return StopsValue(tuple(bounds))


# ---- stop bounds ----


def test_what_this_program_does_comes_first() -> None:
    names = [stop.name for stop in all_stops(state(snapshot(), 0.1))]
    assert names == ["key let go", "terminal", *(stop.name for stop in STOPS)]
    assert all_stops(state(snapshot()))[1] == STOPS[0], "a terminal that never answered stops nothing"
    assert all_stops(state(Snapshot())) == ()


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"stop_bound": 0.0}, "at once"), ({"stop_bound": 0.75, "reports_releases": False}, "0.75 s"),
        ({"stop_bound": math.inf, "style": "latch"}, "never"),
    ],
)  # fmt: skip
def test_a_released_key_stops_at_once_by_a_timer_or_never(changes: dict[str, object], text: str) -> None:
    now = state(snapshot(operator=helm(**changes)))
    assert text in texts(StopsPanel(StopsValue.from_state(now)).draw(40, 12))[0]
    (line,) = texts(StopsLine(StopsValue.from_state(now)).draw(80, 1))
    assert f"key {text}" in line.replace("░░░ ", "")


def test_each_bound_is_a_line_with_its_action_limit_and_value() -> None:
    lines = texts(StopsPanel(stops(*STOPS)).draw(44, 12))
    assert lines[0].split() == ["no", "command", "neutral", "0.45", "s", "▄░░░░░░░░", "0.04", "s"]
    assert lines[5].endswith("11.8 V")
    assert lines[6].endswith(" 3°")
    assert "off" in lines[4], "a fence that is off is not a failsafe of the link"
    assert lines[-1] == "a full bar stops it"


def test_what_never_stops_is_said_in_words() -> None:
    lines = texts(StopsPanel(stops(*FOREIGN_STOPS)).draw(40, 12))
    assert "never" in lines[0]
    assert "nothing" not in lines[0]
    assert lines[2].split()[3:5] == ["--", "--"]
    assert "~0.4 s" in lines[3]
    assert lines[-1] == "never: 2 of 4 are switched off"


def test_bounds_that_do_not_fit_are_counted() -> None:
    assert texts(StopsPanel(stops(*STOPS)).draw(40, 4))[-1] == "and 4 more"
    assert texts(StopsPanel(stops()).draw(40, 4)) == []


@pytest.mark.parametrize(("value", "colour"), [(0.1, GREEN), (0.3, AMBER), (0.4, RED), (9.0, RED), (None, DIM)])
def test_a_bar_changes_its_colour_as_silence_grows(value: float | None, colour: str) -> None:
    assert share_colour(StopBound("no command", "neutral", "MAN_TIMEOUT", 0.45, value)) == colour


def test_a_stop_that_is_near_is_shown_with_each_snapshot() -> None:
    def near(value: float) -> bool:
        return is_near(state(snapshot(vehicle=vehicle(stops=(StopBound("no command", "HOLD", "x", 1.0, value),)))))

    assert not near(0.4)
    assert near(0.6)
    assert is_near(state(snapshot(vehicle=vehicle(stops=())), 0.3))


def test_strange_numbers_are_not_known() -> None:
    strange = StopBound("no command", "neutral", "x", math.nan, math.inf)
    lines = texts(StopsPanel(StopsValue.from_state(state(snapshot(vehicle=vehicle(stops=(strange,)))))).draw(40, 5))
    assert "--" in lines[1]


# ---- key to motor ----


def way(**changes: object) -> WayPanel:
    return WayPanel(WayValue.from_snapshot(snapshot(vehicle=vehicle(**changes))))


def test_the_parts_of_the_way_and_the_age_against_its_limit() -> None:
    lines = texts(way().draw(40, 7))
    assert [line.split()[:4] for line in lines[:4]] == [
        ["key", "to", "sent", "0.3"], ["sent", "to", "heard", "5.8"], ["heard", "to", "motor", "≤2.1"],
        ["key", "to", "motor", "≤8.2"],
    ]  # fmt: skip
    assert lines[3].endswith("p99 21")
    assert "42 ━" in lines[5]
    assert lines[5].endswith("┤450")
    assert lines[6] == "the motors obey a demand 42 ms old"


STILL = (OutputView(name="left wheel", value=0.0), OutputView(name="right wheel", value=0.0))
UNKNOWN = (OutputView(name="servo 1", value=None),)


@pytest.mark.parametrize(
    ("changes", "note"),
    [
        ({}, "the motors obey a demand 42 ms old"),
        ({"command_age": 0.449}, "the motors obey a demand 449 ms old"),
        ({"command_age": 0.45}, "the demand is 450 ms old: not obeyed"),
        ({"command_age": 2.24, "outputs": STILL, "demand": (0.0, 0.0)}, "the demand is 2240 ms old: not obeyed"),
        ({"outputs": STILL}, "the newest demand is 42 ms old"),  # neutral first, for example
        ({"outputs": UNKNOWN}, "the newest demand is 42 ms old"),
        ({"outputs": ()}, "the newest demand is 42 ms old"),
        ({"demand": (0.0, 0.0)}, "the newest demand is 42 ms old"),  # a ramp to neutral
        ({"demand": (0.0, 0.2)}, "the motors obey a demand 42 ms old"),
        ({"demand": None}, "the newest demand is 42 ms old"),
        ({"armed": False}, "the newest demand is 42 ms old"),
        ({"mode": "AUTO", "drivable": False}, "the newest demand is 42 ms old"),
        ({"command_age": 2.24, "stops": ()}, "the motors obey a demand 2240 ms old"),  # no limit is known
        ({"command_age": None}, "no demand is in use"),
    ],
)
def test_motors_obey_only_while_they_turn_by_a_valid_demand(changes: dict[str, object], note: str) -> None:
    assert texts(way(**changes).draw(40, 7))[6] == note


def test_estimates_are_marked() -> None:
    lines = texts(way(key_to_motor=FOREIGN_WAY, command_age=0.03, command_age_estimated=True).draw(40, 7))
    assert "≤110" in lines[2]
    assert "≤120" in lines[3]
    assert "~30" in lines[5]


def test_what_is_not_known_is_not_zero() -> None:
    lines = texts(way(key_to_motor=KeyToMotor(), command_age=None, stops=()).draw(40, 7))
    assert all("--" in line for line in (*lines[:4], lines[5]))
    assert "0" not in "".join(lines[:4])


def test_in_three_rows_the_sum_and_the_age_stay() -> None:
    assert [line.split()[0] for line in texts(way().draw(40, 3))] == ["key", "command", "the"]


def test_times_are_rounded_so_that_equal_ones_draw_nothing() -> None:
    other = KeyToMotor(Timing(0.00031, 0.0009), Timing(0.0058, 0.009), Timing(0.0021, 0.011), Timing(0.0082, 0.021))
    assert way(key_to_motor=other).value == way().value


# ---- health ----


def test_marks_tell_without_colour() -> None:
    lines = texts(HealthPanel(HEALTH).draw(40, 10))
    assert [line[0] for line in lines] == ["!", "✓", "✓", "✓", "✓", "✓", "✓", "·"]


def test_hidden_lines_say_whether_one_is_to_be_looked_at() -> None:
    assert texts(HealthPanel(HEALTH).draw(40, 3))[-1] == "and 6 more, none to look at"
    bad = tuple(HealthLine(f"sensor {number}", "not healthy", False) for number in range(5))
    assert texts(HealthPanel(bad).draw(40, 3))[-1] == "and 3 more, 3 to look at"
    assert texts(HealthPanel(()).draw(40, 3)) == ["the vehicle tells nothing yet"]
    assert texts(HealthPanel((HealthLine("a\x1b[2J", "b\x1b[2J", True),)).draw(40, 3))[0].isprintable()


# ---- mission ----


def test_the_legs_are_to_scale_and_end_at_their_numbers() -> None:
    legs, figures = texts(MissionStrip(MissionValue(MISSION, 20.4)).draw(100, 2))
    ends = [legs.index(str(number)) for number in MISSION.places]
    shares = [(after - before) / (ends[-1] - 1) for before, after in zip([1, *ends], ends, strict=False)]
    whole = sum(MISSION.legs)
    assert shares == pytest.approx([leg / whole for leg in MISSION.legs], abs=0.02)
    assert figures == " item 4 of 7 LOITER_TIME 10 s in 14.9 m  left 82.9 m, 1:38  home 20.4 m"


def test_done_now_and_to_go_differ_without_colour() -> None:
    half = MissionProgress(current=3, last=3, distance=20.0, legs=(40.0, 40.0), places=(2, 3))
    (legs, _) = texts(MissionStrip(MissionValue(half)).draw(82, 2))
    assert legs.index("▶") == 61, "half of the second of two equal legs"
    later = MissionProgress(current=2, last=4, distance=20.0, legs=(40.0, 40.0, 40.0), places=(2, 3, 4))
    assert "─" in texts(MissionStrip(MissionValue(later)).draw(82, 2))[0]


def test_figures_that_do_not_fit_are_left_out_from_the_end() -> None:
    (line,) = texts(MissionStrip(MissionValue(MISSION, 20.4)).draw(36, 1))
    assert line == " item 4 LOITER_TIME 10 s in 14.9 m"
    assert texts(MissionStrip(MissionValue(None, 20.4)).draw(36, 1)) == [" no mission  home 20.4 m"]
    assert texts(MissionStrip(MissionValue()).draw(36, 2)) == [" no mission"]
