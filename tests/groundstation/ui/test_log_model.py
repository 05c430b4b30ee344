"""The lines of the Log screen: kept, filtered, wrapped and scrolled."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.snapshot import LogLine
from groundstation.ui.log_model import KEPT, LogFilter, LogModel, format_lines
from groundstation.ui.wrap import wrap
from groundstation.vehicles.message_log import MAX_LINES
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
    return [row.text for row in made.window(HEIGHT)]


def test_it_keeps_as_many_lines_as_the_station() -> None:
    assert KEPT == MAX_LINES
    made = model(KEPT + 100)
    assert made.count == KEPT
    made.scroll(-(10**6), HEIGHT)
    assert texts(made)[0] == "line 101"


def test_the_newest_lines_are_followed_until_it_is_scrolled() -> None:
    made = model(20)
    assert texts(made) == [f"line {number}" for number in range(16, 21)]
    made.scroll(-3, HEIGHT)
    assert not made.following
    made.add(LogPage((line(21), line(22)), 22, after=20))
    assert texts(made)[0] == "line 13"
    made.scroll(10**6, HEIGHT)
    assert made.following
    made.add(LogPage((line(23),), 23, after=22))
    assert texts(made)[-1] == "line 23"


def test_a_scrolled_window_stays_on_its_lines_when_old_ones_are_dropped() -> None:
    made = model(KEPT)
    made.scroll(-(10**6), HEIGHT)
    made.scroll(500, HEIGHT)
    assert texts(made)[0] == "line 501"
    made.add(LogPage(tuple(map(line, range(KEPT + 1, KEPT + 101))), KEPT + 100, after=KEPT))
    assert texts(made)[0] == "line 501"


def test_a_repeated_line_takes_the_place_of_the_last_one() -> None:
    made = model(3)
    made.add(LogPage((line(3, "line 3", count=2), line(4)), 5, after=3))
    assert texts(made) == ["line 1", "line 2", "line 3  ×2", "line 4"]
    assert made.request == LogRequest(5)


def test_a_page_that_comes_twice_or_answers_another_request_changes_nothing() -> None:
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
    assert [row.line.number for row in made.window(HEIGHT)] == numbers


@given(st.text(max_size=200), st.integers(1, 60))
def test_wrapped_lines_fit_and_lose_no_word(text: str, width: int) -> None:
    rows = wrap(text, width)
    assert rows
    assert all(len(row) <= width for row in rows)
    assert "".join("".join(rows).split()) == "".join(text.split()) or not text.isprintable()


def test_control_characters_do_not_get_through() -> None:
    assert wrap("a\x1b[2Jb\x07\n", 40) == ["a�[2Jb��"]


def test_long_lines_are_wrapped_whole_and_again_for_another_width() -> None:
    made = LogModel()
    made.set_width(20)
    made.add(LogPage((line(1, "PreArm: Compass 1 is not healthy at all"),), 1))
    assert texts(made) == ["PreArm: Compass 1 is", "not healthy at all"]
    made.set_width(80)
    assert texts(made) == ["PreArm: Compass 1 is not healthy at all"]


def test_saved_lines_have_date_and_offset() -> None:
    saved = format_lines([line(1, "PreArm: Compass", severity=4, count=3)])
    assert saved == "1970-01-01T00:00:00.0+0000 WARN  PreArm: Compass  ×3\n"
