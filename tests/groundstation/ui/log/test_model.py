"""The lines of the Log screen: kept, filtered, wrapped and scrolled."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace
from msgspec.structs import replace as replaced

from groundstation.snapshot import LogLine
from groundstation.ui.display.wrap import wrap
from groundstation.ui.log.filter import LogFilter
from groundstation.ui.log.model import KEPT, LogModel, format_lines
from groundstation.vehicles.state.message_log import MAX_LINES
from groundstation.views.log import LogPage, LogRequest

HEIGHT = 5


def line(number: int, text: str = "", *, severity: int = 6, label: str = "vehicle", count: int = 1) -> LogLine:
    text = text or f"line {number}"
    return LogLine(time=0.0, severity=severity, label=label, text=text, count=count, number=number)


def model(lines: int, width: int = 40) -> LogModel:
    made = LogModel()
    made.set_width(width)
    made.add(LogPage(tuple(map(line, range(1, lines + 1))), lines))
    return made


def texts(made: LogModel) -> list[str]:
    return [row.text for row in made.window(HEIGHT).rows]


def test_it_keeps_as_many_lines_as_the_station() -> None:
    assert KEPT == MAX_LINES
    made = model(KEPT + 100)
    assert made.count == KEPT
    made.move(-(10**6))
    assert texts(made)[0] == "line 101"


def marked(made: LogModel) -> int:
    assert made.marked is not None
    assert made.window(HEIGHT).marked == made.marked.number
    return made.marked.number


def test_the_cursor_follows_the_newest_line_until_it_is_moved() -> None:
    made = model(20)
    assert texts(made) == [f"line {number}" for number in range(16, 21)]
    assert marked(made) == 20
    made.move(-3)
    assert not made.following
    made.add(LogPage((line(21), line(22)), 22, after=20))
    assert (marked(made), texts(made)[0]) == (17, "line 16")
    made.move(-3)
    assert (marked(made), texts(made)[0]) == (14, "line 14"), "the window moves as little as possible"
    made.move(10**6)
    assert made.following
    made.add(LogPage((line(23),), 23, after=22))
    assert (marked(made), texts(made)[-1]) == (23, "line 23")


def test_the_marked_line_stays_whole_after_a_change_of_width() -> None:
    made = model(20)
    made.add(LogPage((line(21, "a b c d e f g h i j k l"), line(22)), 22, after=20))
    made.move(-(10**6))
    made.move(20)
    made.set_width(8)
    assert texts(made)[-3:] == ["a b c d", "e f g h", "i j k l"]
    assert marked(made) == 21


def test_lines_around_a_moment_are_shown_and_then_those_before() -> None:
    made = LogModel()
    made.set_width(40)
    times = (1.0, 6.0, 10.0, 14.9, 15.1)
    made.add(LogPage(tuple(replace(line(n, severity=4 + n % 2), time=at) for n, at in enumerate(times, 1)), 5))
    made.set_filter(LogFilter(warnings=True))
    made.move(-1)
    assert [each.number for each in made.shown] == [2, 4]
    made.move(-(10**6))
    made.toggle_around()
    assert [each.number for each in made.shown] == [1, 2, 3]
    assert marked(made) == 2
    made.toggle_around()
    assert [each.number for each in made.shown] == [2, 4]
    assert marked(made) == 2
    made.toggle_around()
    made.set_filter(replaced(made.filter, text="line"))
    assert len(made.shown) == 5, "another filter ends it"


def test_a_scrolled_window_stays_on_its_lines_when_old_ones_drop() -> None:
    made = model(KEPT)
    made.move(-(10**6))
    made.move(500)
    assert texts(made)[-1] == "line 501"
    made.add(LogPage(tuple(map(line, range(KEPT + 1, KEPT + 101))), KEPT + 100, after=KEPT))
    assert texts(made)[-1] == "line 501"
    made.move(-100)
    made.add(LogPage(tuple(map(line, range(KEPT + 101, KEPT + 501))), KEPT + 500, after=KEPT + 100))
    assert marked(made) == 501, "a marked line that is dropped leaves the mark to the oldest one"


def test_a_repeated_line_takes_the_place_of_the_last_one() -> None:
    made = model(3)
    made.add(LogPage((line(3, "line 3", count=2), line(4)), 5, after=3))
    assert texts(made) == ["line 1", "line 2", "line 3  ×2", "line 4"]
    assert made.request == LogRequest(5)


def test_a_repeated_or_foreign_page_changes_nothing() -> None:
    made = model(3)
    made.add(LogPage(tuple(map(line, range(1, 4))), 3))
    made.add(LogPage((line(9),), 9, after=8))
    assert made.count == 3
    assert made.request == LogRequest(3)


@pytest.mark.parametrize(
    ("chosen", "numbers"),
    [
        (LogFilter(), [1, 2, 3, 4]),
        (LogFilter(warnings=True), [2, 3]),
        (LogFilter("COMPASS"), [2, 4]),
        (LogFilter("compass", warnings=True), [2]),
        (LogFilter("ack"), [4]),
        (LogFilter("nothing of this"), []),
        (LogFilter("healthy compass"), []),
        (LogFilter("compass prearm"), [2]),
        (LogFilter(">=warning"), [2, 3]),
        (LogFilter(">=CRIT motors"), [3]),
        (LogFilter(">="), [1, 2, 3, 4]),
        (LogFilter(">=loud"), []),
    ],
)
def test_filters(chosen: LogFilter, numbers: list[int]) -> None:
    made = LogModel()
    made.set_width(40)
    lines = (
        line(1, "rover found", label="station"), line(2, "PreArm: Compass", severity=4),
        line(3, "motors stopped", severity=2), line(4, "compass calibration accepted", label="ack"),
    )  # fmt: skip
    made.add(LogPage(lines, 4))
    made.set_filter(chosen)
    assert [each.number for each in made.shown] == numbers
    assert [row.line.number for row in made.window(HEIGHT).rows] == numbers


def test_an_unknown_severity_is_named_with_the_known_ones() -> None:
    assert LogFilter("compass >=warn").problem == ""
    assert LogFilter("compass >=loud").problem.startswith("no severity “loud”: emergency, alert, critical, error,")


@given(st.text(max_size=200), st.integers(1, 60))
def test_wrapped_lines_fit_and_lose_no_word(text: str, width: int) -> None:
    rows = wrap(text, width)
    assert rows
    assert all(len(row) <= width for row in rows)
    assert "".join("".join(rows).split()) == "".join(text.split()) or not text.isprintable()


def test_control_characters_do_not_get_through() -> None:
    assert wrap("a\x1b[2Jb\x07\n", 40) == ["a�[2Jb��"]


def test_long_lines_are_wrapped_whole_for_each_width() -> None:
    made = LogModel()
    made.set_width(20)
    made.add(LogPage((line(1, "PreArm: Compass 1 is not healthy at all"),), 1))
    assert texts(made) == ["PreArm: Compass 1 is", "not healthy at all"]
    made.set_width(80)
    assert texts(made) == ["PreArm: Compass 1 is not healthy at all"]


def test_saved_lines_have_date_and_offset() -> None:
    saved = format_lines([line(1, "PreArm: Compass", severity=4, count=3)])
    assert saved == "1970-01-01T00:00:00.0+0000 WARN  PreArm: Compass  ×3\n"
