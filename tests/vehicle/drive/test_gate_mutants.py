"""The last gate: its defaults, its edges, and what it remembers."""

from __future__ import annotations

import math

import pytest

from vehicle.drive.gate import (
    MOTOR_TEST_THROTTLE_MAX,
    MOTOR_TEST_TIME_MAX,
    RAMP_TOLERANCE,
    Clearance,
    Gate,
    MotorTest,
    MotorTestTimer,
    Outputs,
    Permit,
)

ZERO = Outputs((0.0, 0.0), enabled=False)
FALL_TIME = 0.4
TEST = MotorTest(1, 0, 0.2)


class TestClearance:
    @pytest.mark.parametrize("fact", ["held", "neutral_seen", "demand_age", "timeout"])
    def test_a_fact_that_is_not_filled_in_permits_no_driving(self, fact: str) -> None:
        facts = {"held": False, "neutral_seen": True, "demand_age": 0.5, "timeout": 1.0}
        assert Clearance(armed=True, **facts).permit is Permit.DRIVE  # type: ignore[arg-type]
        del facts[fact]
        assert Clearance(armed=True, **facts).permit is Permit.RAMP_DOWN  # type: ignore[arg-type]

    def test_by_default_a_cycle_is_on_time_without_a_motor_test(self) -> None:
        assert Clearance(motor_test=TEST).permit is Permit.TEST
        assert Clearance(motor_test=TEST, late=True).permit is Permit.NONE
        assert Clearance().motor_test is None

    @pytest.mark.parametrize("age", [0.0, 0.5])
    def test_a_demand_counts_to_the_last_moment(self, age: float) -> None:
        facts = Clearance(armed=True, held=False, neutral_seen=True, demand_age=age, timeout=0.5)
        assert facts.permit is Permit.DRIVE
        assert facts._replace(demand_age=math.nextafter(0.5, 1.0)).permit is Permit.RAMP_DOWN
        assert facts._replace(demand_age=-1e-9).permit is Permit.RAMP_DOWN


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
            gate.filter((value, 0.0), (value, 0.0), permit, FALL_TIME, 0.0, TEST)
            assert gate.refused == 0
            gate.filter((value * 1.000001, 0.0), (0.0, 0.0), permit, FALL_TIME, 0.0, TEST)
            assert gate.refused == 1
            gate.filter((value, 0.0), (value * 1.000001, 0.0), permit, FALL_TIME, 0.0, TEST)
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
        assert gate.filter((0.5, 0.5), (0.5, 0.5), Permit.DRIVE, FALL_TIME, 0.0, TEST).enabled
        assert gate.filter((0.2, 0.0), (0.2, 0.0), Permit.TEST, FALL_TIME, 0.02, TEST).enabled

    def test_of_a_motor_test_the_motor_gets_what_was_made_of_it(self) -> None:
        gate = Gate(2)
        outputs = gate.filter((0.2, 0.0), (0.6, 0.0), Permit.TEST, FALL_TIME, 0.0, TEST)
        assert outputs == Outputs((0.6, 0.0), enabled=True)
        assert gate.wheels == (0.2, 0.0)
        still = gate.filter((0.0, 0.0), (0.0, 0.0), Permit.TEST, FALL_TIME, 0.02, TEST)
        assert still == Outputs((0.0, 0.0), enabled=True)


class TestTimer:
    def test_a_request_has_its_time_once(self) -> None:
        assert (MOTOR_TEST_THROTTLE_MAX, MOTOR_TEST_TIME_MAX) == (0.3, 3.0)
        timer = MotorTestTimer()
        assert timer.permits((0.3, 0.0), TEST, 100.0)
        assert timer.permits((-0.3, 0.0), TEST, 102.99)
        assert not timer.permits((0.3, 0.0), TEST, 103.0)
        assert not timer.permits((0.3, 0.0), TEST, 99.9)
        assert not timer.permits((0.3, 0.0), None, 101.0)
        assert not timer.permits((0.3, 0.0), TEST, 101.0)

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
