"""The chart."""

from __future__ import annotations

import math

import pytest

from groundstation.ui.look.roles import Role
from groundstation.ui.widgets.chart import Chart, ChartValue, Samples, Series
from tests.groundstation.ui.frames import texts

SERIES = (Series("", Role.GOOD), Series("asked", Role.CAUTION, dotted=True))


def chart(samples: Samples, span: float = 60.0, rows: int = 6) -> list[str]:
    made = Chart(ChartValue(samples, span), title="speed", unit="m/s", series=SERIES, step=0.5, id="x")
    return texts(made.draw(60, rows))


def test_gaps_and_strange_numbers_are_no_values() -> None:
    samples = tuple((float(at), (None if at % 7 == 0 else at / 100, math.nan)) for at in range(200))
    lines = chart(samples)
    assert len(lines) == 6
    assert "1.99 m/s" in lines[0]
    assert "asked" not in lines[0]
    assert "2.0" in lines[0], "the scale has room for the largest"


def test_a_shorter_span_shows_less() -> None:
    samples = tuple((float(at), (5.0 if at < 50 else 0.5, None)) for at in range(61))
    assert "5.0" in chart(samples)[0]
    assert "1.5" in chart(samples, 7.5)[0], "the large values are out of sight"
    assert "7.5 s" in chart(samples, 7.5)[-1]


def test_both_series_are_named_with_their_newest_value() -> None:
    assert "0.80 m/s  asked 0.90 m/s" in chart(((1.0, (0.8, 0.9)),))[0]
    assert "nothing yet" in chart(())[0]


def test_noise_around_a_step_of_the_scale_does_not_widen_it() -> None:
    samples = tuple((float(at), (-0.01 if at % 2 else 1.0, None)) for at in range(60))
    lines = chart(samples)
    assert lines[0].lstrip().startswith("1.0 ")
    assert lines[-1].lstrip().startswith("0.0")


@pytest.mark.parametrize(("speed", "top"), [(1.0, "1.0"), (1.03, "1.05"), (1.05, "1.05"), (1.06, "1.5"), (-0.7, "0.0")])
def test_no_speed_is_above_the_end_of_the_axis(speed: float, top: str) -> None:
    lines = chart(tuple((float(at), (speed if at > 50 else 0.0, None)) for at in range(60)))
    assert lines[0].split()[0] == top
    assert speed <= float(top)


def test_a_high_chart_has_its_names_above_the_lines() -> None:
    lines = chart(tuple((float(at), (1.0, 0.0)) for at in range(60)), rows=9)
    assert "1.00 m/s  asked 0.00 m/s" in lines[0]
    assert lines[1].lstrip().startswith("1.0")
