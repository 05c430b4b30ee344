"""The bars of demand and outputs."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from groundstation.ui.widgets.sticks import Bar, bar_cells, build_bars
from tests.groundstation.ui.examples import snapshot, vehicle


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
