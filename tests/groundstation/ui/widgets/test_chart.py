"""The chart."""

from __future__ import annotations

from groundstation.ui.roles import Role
from groundstation.ui.widgets.chart import Chart, Series
from tests.groundstation.ui.frames import texts


def test_a_chart_takes_gaps_and_keeps_a_minute() -> None:
    chart = Chart((), title="speed", unit="m/s", series=(Series("", Role.GOOD),), step=0.5, id="x")
    for second in range(200):
        chart.add(float(second), None if second % 7 == 0 else second / 100)
    assert 59 <= len(chart.value) <= 61
    assert len(chart.draw(40, 6)) == 6
    assert "1.99 m/s" in texts(chart.draw(40, 6))[0]
