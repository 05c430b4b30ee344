"""The bars of demand and outputs."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.snapshot import OutputView
from groundstation.ui.drive.instruments.sticks import Bar, StickBars, bar_cells, build_bars
from groundstation.ui.look.roles import Role
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.frames import texts


@given(st.integers(-100, 100), st.none() | st.integers(-100, 100), st.integers(5, 60))
def test_a_bar_always_has_its_width(percent: int, obeyed: int | None, width: int) -> None:
    width |= 1
    assert len("".join(part for part, _ in bar_cells(Bar("x", Role.GOOD, percent, obeyed), width))) == width


@pytest.mark.parametrize(("percent", "full", "where"), [(0, 0, None), (50, 5, 11), (-50, 5, 5), (100, 10, 11)])
def test_a_bar_grows_from_the_middle(percent: int, full: int, where: int | None) -> None:
    cells = "".join(part for part, _ in bar_cells(Bar("x", Role.GOOD, percent), 21))
    assert cells.count("█") == full
    assert cells[10] == "│"
    assert where is None or cells.index("█") == where


def test_outputs_have_stations_names_and_unknown_ones_are_hidden() -> None:
    assert [bar.label for bar in build_bars(snapshot())] == ["throttle", "steering", "left wheel", "right wheel"]
    assert len(build_bars(snapshot(vehicle=vehicle(outputs=())))) == 2


@pytest.mark.parametrize("width", [40, 42])
def test_all_bars_begin_in_one_column(width: int) -> None:
    servos = (OutputView(name="steering servo", value=-0.3), OutputView(name="throttle servo", value=0.0))
    lines = texts(StickBars(build_bars(snapshot(vehicle=vehicle(outputs=servos)))).draw(width, 4))
    assert lines[2].startswith("steering servo ")
    assert len({line.index("│") if "│" in line else 15 + (width - 21 - 1) // 2 for line in lines}) == 1
