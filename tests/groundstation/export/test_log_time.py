"""Moments in a log, as people write them."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from groundstation.export.log_time import describe_offset, iso_time, parse_log_time
from tests.groundstation.export.logs import START

SECOND = 1_000_000


@pytest.fixture(autouse=True, scope="module")
def newfoundland() -> Iterator[None]:
    """Let the clock here be 3 h 30 min behind UTC: the log begins at 7:36:40."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TZ", "NST3:30")
        time.tzset()
        yield
    time.tzset()


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("0:31", 31), ("75:00.5", 4500.5), ("+30", 30), ("+0.25", 0.25), ("+2:05", 125), ("+1:02:03", 3723),
        ("07:36:41", 1), ("7:36:40", 0), ("7:36:40.5", 0.5), ("7:36:39", 86_399), ("2026-11-18T11:07:40Z", 60),
        ("2026-11-18T12:06:41+01:00", 1), ("2026-11-18 07:36:41", 1), ("2026-11-19", 59_000),
    ],
)  # fmt: skip
def test_a_moment(text: str, seconds: float) -> None:
    assert parse_log_time(text).resolve(START) - START == round(seconds * SECOND)


def test_a_time_of_day_in_the_second_of_the_start_is_today() -> None:
    assert parse_log_time("7:36:40").resolve(START + 400_000) == START


@pytest.mark.parametrize(
    "text", ["", "soon", "0:61", "25:00:00", "-5", "2026-13-01", "1:2:3:4", "+", "nan", "0:31s", "0001-01-01"]
)
def test_anything_else_is_one_line(text: str) -> None:
    with pytest.raises(ValueError, match=r"is not a time in a log: write 0:31 or \+31"):
        parse_log_time(text)


@settings(max_examples=100)
@given(st.text("0123456789:.+-TZ ", max_size=24))
def test_no_text_raises_anything_else(text: str) -> None:
    with suppress(ValueError):
        parse_log_time(text).resolve(START)


def test_times_of_a_damaged_clock_are_written() -> None:
    assert iso_time(0) == "1970-01-01T00:00:00.000000Z"
    assert iso_time((1 << 64) - 1).startswith("2262-")


def test_an_offset_is_one_that_from_takes() -> None:
    assert [describe_offset(each) for each in (0, 31_500_000, 3_600_000_000, -5)] == ["0:00", "0:31.5", "60:00", "0:00"]
