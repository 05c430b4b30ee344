"""The last gate: it is asked to pass everything, and must refuse what is not cleared."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.outputs import Clearance, Gate, Outputs, Permit

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)
FALL_TIME = 0.4
ZERO = Outputs((0.0, 0.0), enabled=False)


def test_all_facts_right_permits_to_drive() -> None:
    assert CLEARED.permit is Permit.DRIVE


@pytest.mark.parametrize(
    ("change", "permit"),
    [
        ({"armed": False}, Permit.NONE),
        ({"late": True}, Permit.NONE),
        ({"held": True}, Permit.FALL),
        ({"neutral_seen": False}, Permit.FALL),
        ({"demand_age": None}, Permit.FALL),
        ({"demand_age": 0.451}, Permit.FALL),
        ({"demand_age": -0.001}, Permit.FALL),
        ({"demand_age": math.nan}, Permit.FALL),
        ({"timeout": math.nan}, Permit.FALL),
    ],
)
def test_each_fact_alone_takes_the_permit_away(change: dict[str, float], permit: Permit) -> None:
    assert replace(CLEARED, **change).permit is permit  # type: ignore[arg-type]


def test_a_clearance_that_nobody_filled_in_permits_nothing() -> None:
    assert Clearance().permit is Permit.NONE


def test_drive_passes() -> None:
    assert Gate(2).judge((0.5, -1.0), Permit.DRIVE, FALL_TIME, 0.0) == Outputs((0.5, -1.0), enabled=True)


def test_none_is_zero_whatever_comes() -> None:
    gate = Gate(2)
    gate.judge((1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert gate.judge((1.0, 1.0), Permit.NONE, FALL_TIME, 0.02) == ZERO


@pytest.mark.parametrize("bad", [(math.nan, 0.0), (0.0, math.inf), (1.0001, 0.0), (-2.0, 0.0), (0.0,), (0.0, 0.0, 0.0)])
def test_values_that_are_none_are_refused_all_together(bad: tuple[float, ...]) -> None:
    gate = Gate(2)
    gate.judge((1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert gate.judge(bad, Permit.DRIVE, FALL_TIME, 0.02) == ZERO
    assert gate.refused == 1
    gate.judge(bad, Permit.DRIVE, FALL_TIME, 0.04)
    assert gate.refused == 2
    gate.judge((0.1, 0.1), Permit.DRIVE, FALL_TIME, 0.06)
    assert gate.refused == 0


def test_fall_lets_values_fall_and_nothing_else() -> None:
    gate = Gate(2)
    gate.judge((1.0, -1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert gate.judge((0.9, -0.9), Permit.FALL, FALL_TIME, 0.02) == Outputs((0.9, -0.9), enabled=True)
    assert gate.judge((0.91, -0.8), Permit.FALL, FALL_TIME, 0.04) == ZERO
    assert gate.judge((0.8, -0.8), Permit.FALL, FALL_TIME, 0.06) == ZERO


def test_a_fall_that_does_not_end_is_ended() -> None:
    gate = Gate(2)
    gate.judge((1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert gate.judge((1.0, 1.0), Permit.FALL, FALL_TIME, 0.02).enabled
    assert gate.judge((1.0, 1.0), Permit.FALL, FALL_TIME, 0.46).enabled
    assert gate.judge((1.0, 1.0), Permit.FALL, FALL_TIME, 0.48) == ZERO


def test_at_rest_without_permit_the_enable_line_is_off() -> None:
    gate = Gate(2)
    assert not gate.judge((0.0, 0.0), Permit.FALL, FALL_TIME, 0.0).enabled
    assert gate.judge((0.0, 0.0), Permit.DRIVE, FALL_TIME, 0.02).enabled


@given(
    st.lists(
        st.tuples(
            st.sampled_from(Permit),
            st.lists(st.floats(), min_size=1, max_size=3).map(tuple),
            st.floats(0.001, 0.3),
        )
    )
)
def test_whatever_comes_what_leaves_is_sound_and_permitted(
    moves: list[tuple[Permit, tuple[float, ...], float]],
) -> None:
    gate, now, before, drove = Gate(2), 0.0, (0.0, 0.0), -math.inf
    for permit, values, dt in moves:
        now += dt
        outputs = gate.judge(values, permit, FALL_TIME, now)
        assert len(outputs.throttles) == 2
        assert all(-1 <= value <= 1 for value in outputs.throttles)
        if permit is Permit.DRIVE:
            drove = now
        elif any(outputs.throttles):
            assert permit is Permit.FALL
            assert all(abs(new) <= abs(old) for new, old in zip(outputs.throttles, before, strict=True))
            assert now - drove <= FALL_TIME + 0.05 + 0.3
        before = outputs.throttles
