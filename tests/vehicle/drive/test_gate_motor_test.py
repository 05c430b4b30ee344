"""The motor test at the last gate: one motor, 0.3 of full, 3 s, and each request once."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.drive.gate import (
    MOTOR_TEST_THROTTLE_MAX,
    MOTOR_TEST_TIME_MAX,
    Clearance,
    Gate,
    MotorTest,
    MotorTestTimer,
    Outputs,
    Permit,
)

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)
FALL_TIME = 0.4
ZERO = Outputs((0.0, 0.0), enabled=False)
TRIAL = MotorTest(1, 0, 0.2)


def judge(gate: Gate, values: Sequence[float], permit: Permit, now: float, trial: MotorTest | None = None) -> Outputs:
    """Filter values of wheels whose motors get the same."""
    return gate.filter(values, values, permit, FALL_TIME, now, trial)


def test_a_motor_test_is_permitted_while_disarmed_and_on_time() -> None:
    asked = Clearance(motor_test=TRIAL)
    assert asked.permit is Permit.TEST
    assert asked._replace(late=True).permit is Permit.NONE
    assert asked._replace(armed=True).permit is Permit.RAMP_DOWN
    assert CLEARED._replace(motor_test=TRIAL).permit is Permit.DRIVE


def test_a_motor_test_passes_one_motor_for_3_s_and_no_longer() -> None:
    gate = Gate(2)
    for cycle in range(150):
        assert judge(gate, (-0.3, 0.0), Permit.TEST, 10 + cycle * 0.02, TRIAL) == Outputs((-0.3, 0.0), True)
    for cycle in range(150, 400):
        assert judge(gate, (-0.3, 0.0), Permit.TEST, 10 + cycle * 0.02, TRIAL) == ZERO


@pytest.mark.parametrize(
    "wrong",
    [(0.301, 0.0), (-0.301, 0.0), (0.2, 0.2), (0.0, 0.2), (0.2, -1e-9), (math.nan, 0.0), (0.2, math.nan), (0.2,)],
)
def test_an_invalid_motor_test_is_rejected(wrong: tuple[float, ...]) -> None:
    gate = Gate(2)
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.0, TRIAL).enabled
    assert judge(gate, wrong, Permit.TEST, 0.02, TRIAL) == ZERO


def test_without_a_request_there_is_no_motor_test() -> None:
    assert judge(Gate(2), (0.2, 0.0), Permit.TEST, 0.0) == ZERO


@pytest.mark.parametrize("between", [Permit.NONE, Permit.RAMP_DOWN, Permit.DRIVE])
def test_interrupted_motor_test_is_over_and_new_one_has_its_time(between: Permit) -> None:
    gate = Gate(2)
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.0, TRIAL).enabled
    judge(gate, (0.0, 0.0), between, 0.02, TRIAL)
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.04, TRIAL) == ZERO
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.06, MotorTest(2, 0, 0.2)).enabled
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.08, TRIAL) == ZERO  # an older one does not come back
    assert judge(gate, (0.2, 0.0), Permit.TEST, 0.10, MotorTest(2, 0, 0.2)) == ZERO


def test_a_renewed_motor_test_continues() -> None:
    gate = Gate(2)
    for number in range(1, 11):
        for now in (float(number), number + 0.9):
            assert judge(gate, (0.2, 0.0), Permit.TEST, now, MotorTest(number, 0, 0.2)).enabled
    assert judge(gate, (0.2, 0.0), Permit.TEST, 13.5, MotorTest(10, 0, 0.2)) == ZERO


def test_no_ramp_follows_a_motor_test() -> None:
    gate = Gate(2)
    judge(gate, (0.3, 0.0), Permit.TEST, 0.0, TRIAL)
    assert judge(gate, (0.2, 0.0), Permit.RAMP_DOWN, 0.02) == ZERO


def test_a_clock_that_goes_back_ends_a_motor_test() -> None:
    gate = Gate(2)
    judge(gate, (0.3, 0.0), Permit.TEST, 5.0, TRIAL)
    assert judge(gate, (0.3, 0.0), Permit.TEST, 4.0, TRIAL) == ZERO


@given(
    st.lists(
        st.tuples(
            st.one_of(st.none(), st.integers(1, 4)),
            st.lists(st.sampled_from([0.0, 0.1, 0.3, -0.3, 0.31, math.nan]), min_size=2, max_size=2).map(tuple),
            st.floats(0.001, 1.0),
        )
    )
)
def test_no_request_turns_a_motor_longer_or_faster_than_allowed(
    moves: list[tuple[int | None, tuple[float, ...], float]],
) -> None:
    gate, now, first = Gate(2), 0.0, dict[int, float]()
    for number, values, dt in moves:
        now += dt
        trial = None if number is None else MotorTest(number, 0, 0.2)
        outputs = judge(gate, values, Permit.NONE if trial is None else Permit.TEST, now, trial)
        if number is None:
            assert outputs == ZERO
            continue
        first.setdefault(number, now)
        if any(outputs.throttles):
            assert abs(outputs.throttles[0]) <= MOTOR_TEST_THROTTLE_MAX
            assert outputs.throttles[1] == 0
            assert now - first[number] < MOTOR_TEST_TIME_MAX


class TestTimer:
    def test_a_request_has_its_time_once(self) -> None:
        assert (MOTOR_TEST_THROTTLE_MAX, MOTOR_TEST_TIME_MAX) == (0.3, 3.0)
        timer = MotorTestTimer()
        assert timer.permits((0.3, 0.0), TRIAL, 100.0)
        assert timer.permits((-0.3, 0.0), TRIAL, 102.99)
        assert not timer.permits((0.3, 0.0), TRIAL, 103.0)
        assert not timer.permits((0.3, 0.0), TRIAL, 99.9)
        assert not timer.permits((0.3, 0.0), None, 101.0)
        assert not timer.permits((0.3, 0.0), TRIAL, 101.0)

    def test_numbers_begin_with_one(self) -> None:
        assert not MotorTestTimer().permits((0.2,), MotorTest(0, 0, 0.2), 0.0)

    def test_the_wheel_that_is_meant_and_no_other(self) -> None:
        timer = MotorTestTimer()
        second = MotorTest(1, 1, 0.2)
        assert timer.permits((0.0, 0.2, 0.0), second, 0.0)
        assert not timer.permits((0.2, 0.2, 0.0), second, 0.1)
        assert not timer.permits((0.0, 0.2, 0.2), second, 0.1)
        assert timer.permits((0.0, 0.2, 0.0), second, 0.2)

    def test_a_newer_request_ends_the_one_before(self) -> None:
        timer = MotorTestTimer()
        assert timer.permits((0.2,), MotorTest(5, 0, 0.2), 0.0)
        assert timer.permits((0.2,), MotorTest(7, 0, 0.2), 2.0)
        assert timer.permits((0.2,), MotorTest(7, 0, 0.2), 4.9)
        assert not timer.permits((0.2,), MotorTest(6, 0, 0.2), 4.92)
        assert not timer.permits((0.2,), MotorTest(5, 0, 0.2), 4.94)
        assert not timer.permits((0.2,), MotorTest(7, 0, 0.2), 4.96)
        assert timer.permits((0.2,), MotorTest(8, 0, 0.2), 4.98)

    def test_an_older_request_after_nothing_does_not_come_back(self) -> None:
        timer = MotorTestTimer()
        assert timer.permits((0.2,), MotorTest(5, 0, 0.2), 0.0)
        assert not timer.permits((0.0,), None, 0.1)
        assert not timer.permits((0.0,), None, 0.2)
        assert not timer.permits((0.2,), MotorTest(3, 0, 0.2), 0.3)
        assert not timer.permits((0.2,), MotorTest(5, 0, 0.2), 0.4)
