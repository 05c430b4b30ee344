"""The last gate: it rejects everything that is not cleared, to the edges of its rules."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.rows import each_row
from vehicle.drive.gate import (
    RAMP_TOLERANCE,
    Clearance,
    Gate,
    MotorTest,
    Outputs,
    Permit,
)

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)
FALL_TIME = 0.4
ZERO = Outputs((0.0, 0.0), enabled=False)
TRIAL = MotorTest(1, 0, 0.2)


def judge(
    gate: Gate, values: Sequence[float], permit: Permit, fall_time: float, now: float, trial: MotorTest | None = None
) -> Outputs:  # fmt: skip
    """With motors that get what their wheels are to do."""
    return gate.filter(values, values, permit, fall_time, now, trial)


def test_all_facts_together_permit_driving() -> None:
    assert CLEARED.permit is Permit.DRIVE


@each_row(
    ("change", "permit"),
    [
        ({"armed": False}, Permit.NONE),
        ({"late": True}, Permit.NONE),
        ({"held": True}, Permit.RAMP_DOWN),
        ({"neutral_seen": False}, Permit.RAMP_DOWN),
        ({"demand_age": None}, Permit.RAMP_DOWN),
        ({"demand_age": 0.0}, Permit.DRIVE),
        ({"demand_age": 0.45}, Permit.DRIVE),  # to the last moment
        ({"demand_age": math.nextafter(0.45, 1.0)}, Permit.RAMP_DOWN),
        ({"demand_age": 0.451}, Permit.RAMP_DOWN),
        ({"demand_age": -1e-9}, Permit.RAMP_DOWN),
        ({"demand_age": -0.001}, Permit.RAMP_DOWN),
        ({"demand_age": math.nan}, Permit.RAMP_DOWN),
        ({"timeout": math.nan}, Permit.RAMP_DOWN),
    ],
)
def test_each_fact_alone_decides_on_the_permit(change: dict[str, float], permit: Permit) -> None:
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


class TestClearance:
    @pytest.mark.parametrize("fact", ["held", "neutral_seen", "demand_age", "timeout"])
    def test_a_fact_that_is_not_filled_in_permits_no_driving(self, fact: str) -> None:
        facts = {"held": False, "neutral_seen": True, "demand_age": 0.5, "timeout": 1.0}
        assert Clearance(armed=True, **facts).permit is Permit.DRIVE  # type: ignore[arg-type]
        del facts[fact]
        assert Clearance(armed=True, **facts).permit is Permit.RAMP_DOWN  # type: ignore[arg-type]

    def test_by_default_a_cycle_is_on_time_without_a_motor_test(self) -> None:
        assert Clearance(motor_test=TRIAL).permit is Permit.TEST
        assert Clearance(motor_test=TRIAL, late=True).permit is Permit.NONE
        assert Clearance().motor_test is None


class TestGate:
    def test_a_new_one_stands_and_has_refused_nothing(self) -> None:
        gate = Gate(3)
        assert gate.refused == 0
        assert gate.wheels == (0.0, 0.0, 0.0)
        assert gate.filter((0.1,) * 3, (0.1,) * 3, Permit.RAMP_DOWN, FALL_TIME, 0.0) == Outputs(
            (0.0,) * 3, enabled=False
        )

    def test_it_counts_what_it_refuses_in_a_row(self) -> None:
        gate = Gate(2)
        for count in (1, 2, 3):
            assert gate.filter((2.0, 0.0), (0.0, 0.0), Permit.DRIVE, FALL_TIME, count * 0.02) == ZERO
            assert gate.refused == count
        gate.filter((2.0, 0.0), (0.0, 0.0), Permit.NONE, FALL_TIME, 1.0)
        assert gate.refused == 3  # nothing was judged
        gate.filter((1.0, -1.0), (1.0, -1.0), Permit.DRIVE, FALL_TIME, 1.02)
        assert gate.refused == 0

    @pytest.mark.parametrize("permit", [Permit.DRIVE, Permit.RAMP_DOWN, Permit.TEST])
    def test_full_either_way_is_sound_and_more_is_not(self, permit: Permit) -> None:
        for value in (1.0, -1.0):
            gate = Gate(2)
            gate.filter((value, 0.0), (value, 0.0), permit, FALL_TIME, 0.0, TRIAL)
            assert gate.refused == 0
            gate.filter((value * 1.000001, 0.0), (0.0, 0.0), permit, FALL_TIME, 0.0, TRIAL)
            assert gate.refused == 1
            gate.filter((value, 0.0), (value * 1.000001, 0.0), permit, FALL_TIME, 0.0, TRIAL)
            assert gate.refused == 2

    def test_each_driven_motor_has_to_stand_with_its_wheel(self) -> None:
        for index in (0, 1):
            motors = [0.0, 0.0, 0.1]
            gate = Gate(3, driven=2)
            assert gate.filter((0.0, 0.0, 0.0), motors, Permit.DRIVE, FALL_TIME, 0.0).enabled
            motors[index] = -0.1
            assert not gate.filter((0.0, 0.0, 0.0), motors, Permit.DRIVE, FALL_TIME, 0.02).enabled
            assert gate.refused == 1

    @pytest.mark.parametrize(("wheels", "motors"), [((0.1,), (0.1, 0.1)), ((0.1, 0.1), (0.1,)), ((0.1,), (0.1,))])
    def test_a_missing_value_is_refused(self, wheels: tuple[float, ...], motors: tuple[float, ...]) -> None:
        gate = Gate(2)
        assert gate.filter(wheels, motors, Permit.DRIVE, FALL_TIME, 0.0) == ZERO
        assert gate.refused == 1

    def test_a_ramp_is_timed_from_its_begin_each_time(self) -> None:
        assert RAMP_TOLERANCE == 0.05
        gate = Gate(1)
        half = ((0.5,), (0.5,))
        assert gate.filter(*half, Permit.DRIVE, 1.0, 100.0).enabled
        for now in (100.5, 101.0, 101.55):
            assert gate.filter(*half, Permit.RAMP_DOWN, 1.0, now).enabled
        assert not gate.filter(*half, Permit.RAMP_DOWN, 1.0, 101.56).enabled
        assert gate.filter(*half, Permit.DRIVE, 1.0, 102.0).enabled
        assert gate.filter(*half, Permit.RAMP_DOWN, 1.0, 102.5).enabled
        assert gate.filter(*half, Permit.RAMP_DOWN, 1.0, 103.5).enabled

    def test_a_ramp_may_end_at_its_last_moment_and_no_wheel_later(self) -> None:
        gate = Gate(2)
        gate.filter((0.5, 0.0), (0.5, 0.0), Permit.DRIVE, 0.45, 0.98)
        assert gate.filter((0.5, 0.0), (0.5, 0.0), Permit.RAMP_DOWN, 0.45, 1.0).enabled
        assert gate.filter((0.5, 0.0), (0.5, 0.0), Permit.RAMP_DOWN, 0.45, 1.5).enabled
        assert gate.filter((0.5, 0.0), (0.5, 0.0), Permit.RAMP_DOWN, 0.45, 1.52) == ZERO

    def test_after_the_ramp_zero_still_passes(self) -> None:
        gate = Gate(2, driven=1)
        gate.filter((0.5, 0.0), (0.5, 0.0), Permit.DRIVE, FALL_TIME, 0.0)
        gate.filter((0.5, 0.0), (0.5, 0.0), Permit.RAMP_DOWN, FALL_TIME, 0.02)
        gate.filter((0.0, 0.0), (0.0, 0.1), Permit.RAMP_DOWN, FALL_TIME, 9.0)
        assert gate.refused == 0
        assert gate.wheels == (0.0, 0.0)

    def test_the_request_means_nothing_to_the_other_permits(self) -> None:
        gate = Gate(2)
        assert gate.filter((0.5, 0.5), (0.5, 0.5), Permit.DRIVE, FALL_TIME, 0.0, TRIAL).enabled
        assert gate.filter((0.2, 0.0), (0.2, 0.0), Permit.TEST, FALL_TIME, 0.02, TRIAL).enabled

    def test_of_a_motor_test_the_motor_gets_what_was_made_of_it(self) -> None:
        gate = Gate(2)
        outputs = gate.filter((0.2, 0.0), (0.6, 0.0), Permit.TEST, FALL_TIME, 0.0, TRIAL)
        assert outputs == Outputs((0.6, 0.0), enabled=True)
        assert gate.wheels == (0.2, 0.0)
        still = gate.filter((0.0, 0.0), (0.0, 0.0), Permit.TEST, FALL_TIME, 0.02, TRIAL)
        assert still == Outputs((0.0, 0.0), enabled=True)
