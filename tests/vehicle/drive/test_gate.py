"""The last gate: it rejects everything that is not cleared."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vehicle.drive.gate import MOTOR_TEST_THROTTLE_MAX, MOTOR_TEST_TIME_MAX, Clearance, Gate, MotorTest, Outputs, Permit

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)
FALL_TIME = 0.4
ZERO = Outputs((0.0, 0.0), enabled=False)


def judge(
    gate: Gate, values: Sequence[float], permit: Permit, fall_time: float, now: float, trial: MotorTest | None = None
) -> Outputs:  # fmt: skip
    """With motors that get what their wheels are to do."""
    return gate.filter(values, values, permit, fall_time, now, trial)


def test_all_facts_together_permit_driving() -> None:
    assert CLEARED.permit is Permit.DRIVE


@pytest.mark.parametrize(
    ("change", "permit"),
    [
        ({"armed": False}, Permit.NONE),
        ({"late": True}, Permit.NONE),
        ({"held": True}, Permit.RAMP_DOWN),
        ({"neutral_seen": False}, Permit.RAMP_DOWN),
        ({"demand_age": None}, Permit.RAMP_DOWN),
        ({"demand_age": 0.451}, Permit.RAMP_DOWN),
        ({"demand_age": -0.001}, Permit.RAMP_DOWN),
        ({"demand_age": math.nan}, Permit.RAMP_DOWN),
        ({"timeout": math.nan}, Permit.RAMP_DOWN),
    ],
)
def test_each_fact_alone_revokes_the_permit(change: dict[str, float], permit: Permit) -> None:
    assert CLEARED._replace(**change).permit is permit  # type: ignore[arg-type]


def test_a_default_clearance_permits_nothing() -> None:
    assert Clearance().permit is Permit.NONE


def test_drive_passes() -> None:
    assert judge(Gate(2), (0.5, -1.0), Permit.DRIVE, FALL_TIME, 0.0) == Outputs((0.5, -1.0), enabled=True)


def test_permit_none_is_zero_for_any_value() -> None:
    gate = Gate(2)
    judge(gate, (1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, (1.0, 1.0), Permit.NONE, FALL_TIME, 0.02) == ZERO


@pytest.mark.parametrize("bad", [(math.nan, 0.0), (0.0, math.inf), (1.0001, 0.0), (-2.0, 0.0), (0.0,), (0.0, 0.0, 0.0)])
def test_invalid_values_reject_all_outputs(bad: tuple[float, ...]) -> None:
    gate = Gate(2)
    judge(gate, (1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, bad, Permit.DRIVE, FALL_TIME, 0.02) == ZERO
    assert gate.refused == 1
    judge(gate, bad, Permit.DRIVE, FALL_TIME, 0.04)
    assert gate.refused == 2
    judge(gate, (0.1, 0.1), Permit.DRIVE, FALL_TIME, 0.06)
    assert gate.refused == 0


def test_ramp_down_passes_only_falling_values() -> None:
    gate = Gate(2)
    judge(gate, (1.0, -1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, (0.9, -0.9), Permit.RAMP_DOWN, FALL_TIME, 0.02) == Outputs((0.9, -0.9), enabled=True)
    assert judge(gate, (0.91, -0.8), Permit.RAMP_DOWN, FALL_TIME, 0.04) == ZERO
    assert judge(gate, (0.8, -0.8), Permit.RAMP_DOWN, FALL_TIME, 0.06) == ZERO


@pytest.mark.parametrize("wheels", [(-0.51, 0.5), (0.5, -0.51), (-1.0, -1.0), (0.51, 0.5)])
def test_a_ramp_to_neutral_grows_neither_forwards_nor_backwards(wheels: tuple[float, float]) -> None:
    gate = Gate(2)
    judge(gate, (0.5, 0.5), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, wheels, Permit.RAMP_DOWN, FALL_TIME, 0.02) == ZERO
    gate = Gate(2)
    judge(gate, (0.5, 0.5), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, (0.4, -0.1), Permit.RAMP_DOWN, FALL_TIME, 0.02).enabled


def test_a_deceleration_that_takes_too_long_is_ended() -> None:
    gate = Gate(2)
    judge(gate, (1.0, 1.0), Permit.DRIVE, FALL_TIME, 0.0)
    assert judge(gate, (1.0, 1.0), Permit.RAMP_DOWN, FALL_TIME, 0.02).enabled
    assert judge(gate, (1.0, 1.0), Permit.RAMP_DOWN, FALL_TIME, 0.46).enabled
    assert judge(gate, (1.0, 1.0), Permit.RAMP_DOWN, FALL_TIME, 0.48) == ZERO


def test_at_rest_without_permit_the_enable_line_is_off() -> None:
    gate = Gate(2)
    assert not judge(gate, (0.0, 0.0), Permit.RAMP_DOWN, FALL_TIME, 0.0).enabled
    assert judge(gate, (0.0, 0.0), Permit.DRIVE, FALL_TIME, 0.02).enabled


# ---- what the motors get of it


def test_the_gate_passes_the_motor_values_of_the_wheels() -> None:
    gate = Gate(2)
    assert gate.filter((0.5, 0.5), (-0.6, 0.7), Permit.DRIVE, FALL_TIME, 0.0) == Outputs((-0.6, 0.7), enabled=True)
    assert gate.wheels == (0.5, 0.5)


@pytest.mark.parametrize("bad", [(math.nan, 0.5), (0.5, -1.01), (math.inf, 0.5), (0.5,), (0.5, 0.5, 0.5)])
def test_invalid_motor_values_reject_all_outputs(bad: tuple[float, ...]) -> None:
    gate = Gate(2)
    assert gate.filter((0.5, 0.5), (0.5, 0.5), Permit.DRIVE, FALL_TIME, 0.0).enabled
    assert gate.filter((0.5, 0.5), bad, Permit.DRIVE, FALL_TIME, 0.02) == ZERO
    assert gate.refused == 1
    assert gate.wheels == (0.0, 0.0)


def test_a_wheel_at_zero_requires_its_motor_at_zero() -> None:
    assert judge(Gate(2), (0.5, 0.0), Permit.DRIVE, FALL_TIME, 0.0).enabled
    assert Gate(2).filter((0.5, 0.0), (0.5, 0.01), Permit.DRIVE, FALL_TIME, 0.0) == ZERO
    centred = Gate(2, driven=1).filter((0.5, 0.0), (0.5, 0.1), Permit.DRIVE, FALL_TIME, 0.0)  # of a steering servo
    assert centred == Outputs((0.5, 0.1), enabled=True)


def test_a_servo_off_centre_does_not_keep_the_outputs_enabled() -> None:
    gate = Gate(2, driven=1)
    gate.filter((0.5, 0.0), (0.5, 0.1), Permit.DRIVE, FALL_TIME, 0.0)
    assert gate.filter((0.1, 0.0), (0.1, 0.1), Permit.RAMP_DOWN, FALL_TIME, 0.02) == Outputs((0.1, 0.1), enabled=True)
    assert gate.filter((0.0, 0.0), (0.0, 0.1), Permit.RAMP_DOWN, FALL_TIME, 0.04) == ZERO


def test_a_minimum_output_steps_to_zero_in_time() -> None:
    gate = Gate(1)
    for step in range(21):
        wheel = 1.0 - step / 20
        motor = 0.5 + wheel / 2 if wheel else 0.0
        permit = Permit.RAMP_DOWN if step else Permit.DRIVE
        outputs = gate.filter((wheel,), (motor,), permit, FALL_TIME, step * 0.02)
        assert outputs.enabled == (step < 20)
    assert gate.refused == 0


TRIAL = MotorTest(1, 0, 0.2)


def test_a_motor_test_is_permitted_while_disarmed_and_on_time() -> None:
    asked = Clearance(motor_test=TRIAL)
    assert asked.permit is Permit.TEST
    assert asked._replace(late=True).permit is Permit.NONE
    assert asked._replace(armed=True).permit is Permit.RAMP_DOWN
    assert CLEARED._replace(motor_test=TRIAL).permit is Permit.DRIVE


def test_a_motor_test_passes_one_motor_for_3_s_and_no_longer() -> None:
    gate = Gate(2)
    for cycle in range(150):
        assert judge(gate, (-0.3, 0.0), Permit.TEST, FALL_TIME, 10 + cycle * 0.02, TRIAL) == Outputs((-0.3, 0.0), True)
    for cycle in range(150, 400):
        assert judge(gate, (-0.3, 0.0), Permit.TEST, FALL_TIME, 10 + cycle * 0.02, TRIAL) == ZERO


@pytest.mark.parametrize(
    "wrong",
    [(0.301, 0.0), (-0.301, 0.0), (0.2, 0.2), (0.0, 0.2), (0.2, -1e-9), (math.nan, 0.0), (0.2, math.nan), (0.2,)],
)
def test_an_invalid_motor_test_is_rejected(wrong: tuple[float, ...]) -> None:
    gate = Gate(2)
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.0, TRIAL).enabled
    assert judge(gate, wrong, Permit.TEST, FALL_TIME, 0.02, TRIAL) == ZERO


def test_without_a_request_there_is_no_motor_test() -> None:
    assert judge(Gate(2), (0.2, 0.0), Permit.TEST, FALL_TIME, 0.0) == ZERO


@pytest.mark.parametrize("between", [Permit.NONE, Permit.RAMP_DOWN, Permit.DRIVE])
def test_interrupted_motor_test_is_over_and_new_one_has_its_time(between: Permit) -> None:
    gate = Gate(2)
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.0, TRIAL).enabled
    judge(gate, (0.0, 0.0), between, FALL_TIME, 0.02, TRIAL)
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.04, TRIAL) == ZERO
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.06, MotorTest(2, 0, 0.2)).enabled
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.08, TRIAL) == ZERO  # an older one does not come back
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 0.10, MotorTest(2, 0, 0.2)) == ZERO


def test_a_renewed_motor_test_continues() -> None:
    gate = Gate(2)
    for number in range(1, 11):
        for now in (float(number), number + 0.9):
            assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, now, MotorTest(number, 0, 0.2)).enabled
    assert judge(gate, (0.2, 0.0), Permit.TEST, FALL_TIME, 13.5, MotorTest(10, 0, 0.2)) == ZERO


def test_no_ramp_follows_a_motor_test() -> None:
    gate = Gate(2)
    judge(gate, (0.3, 0.0), Permit.TEST, FALL_TIME, 0.0, TRIAL)
    assert judge(gate, (0.2, 0.0), Permit.RAMP_DOWN, FALL_TIME, 0.02) == ZERO


def test_a_clock_that_goes_back_ends_a_motor_test() -> None:
    gate = Gate(2)
    judge(gate, (0.3, 0.0), Permit.TEST, FALL_TIME, 5.0, TRIAL)
    assert judge(gate, (0.3, 0.0), Permit.TEST, FALL_TIME, 4.0, TRIAL) == ZERO


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
        outputs = judge(gate, values, Permit.NONE if trial is None else Permit.TEST, FALL_TIME, now, trial)
        if number is None:
            assert outputs == ZERO
            continue
        first.setdefault(number, now)
        if any(outputs.throttles):
            assert abs(outputs.throttles[0]) <= MOTOR_TEST_THROTTLE_MAX
            assert outputs.throttles[1] == 0
            assert now - first[number] < MOTOR_TEST_TIME_MAX


@given(
    st.lists(
        st.tuples(
            st.sampled_from(Permit),
            st.lists(st.floats(), min_size=1, max_size=3).map(tuple),
            st.floats(0.001, 0.3),
        )
    )
)
def test_every_output_is_valid_and_permitted(
    moves: list[tuple[Permit, tuple[float, ...], float]],
) -> None:
    gate, now, before, drove = Gate(2), 0.0, (0.0, 0.0), -math.inf
    for permit, values, dt in moves:
        now += dt
        outputs = judge(gate, values, permit, FALL_TIME, now)
        assert len(outputs.throttles) == 2
        assert all(-1 <= value <= 1 for value in outputs.throttles)
        if permit is Permit.DRIVE:
            drove = now
        elif any(outputs.throttles):
            assert permit is Permit.RAMP_DOWN
            assert all(abs(new) <= abs(old) for new, old in zip(outputs.throttles, before, strict=True))
            assert now - drove <= FALL_TIME + 0.05 + 0.3
        before = outputs.throttles
