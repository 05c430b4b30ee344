"""MOTn_ parameters (direction, minimum, maximum, trim) through the whole rover in virtual time."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec.structs import replace

from dialects import messages as m
from dialects.axes import Axes
from dialects.enums import Command, DriveLimit, Failsafe, ParamErrorCode, Result
from dialects.modes import Mode
from tests.vehicle.bench import AHEAD, CYCLE, EVERYTHING, NEUTRAL, Bench, said
from vehicle.config.merge import merge_params
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Clearance, Outputs
from vehicle.motors.drivers import profile_params
from vehicle.params import ORDERED_PAIRS, PARAMETERS, Params
from vehicle.rover import Rover

MOTOR_PARAMS = [name for name in PARAMETERS if name.startswith("MOT")]
REAL32 = 9


def set_(bench: Bench, name: str, value: float) -> float:
    bench.say(m.ParamSet(1, 1, name.encode(), value, REAL32))
    return float(bench.newest(m.ParamValue).param_value)


def test_a_reversed_motor_inverts_only_the_motor_output() -> None:
    bench = Bench(MOT1_REVERSED=1)
    bench.drive()
    bench.wait(1.0, AHEAD)
    assert bench.throttles == (-1.0, 1.0)
    servos = bench.newest(m.ServoOutputRaw)
    assert (servos.servo1_raw, servos.servo3_raw) == (1100, 1900)
    assert bench.newest(m.RoverDriveStatus).output == [10_000, 10_000, 0, 0]
    assert bench.newest(m.VfrHud).throttle == 100


def test_a_reversed_motor_ramps_down_as_any_other() -> None:
    bench = Bench(MOT1_REVERSED=1, MOT1_MIN=40, MOT2_MIN=40, MOT2_TRIM=10)
    bench.drive()
    before = bench.throttles
    for _ in range(60):  # no demands
        bench.wait(CYCLE)
        assert all(abs(new) <= abs(old) for new, old in zip(bench.throttles, before, strict=True))
        before = bench.throttles
    assert bench.throttles == (0.0, 0.0)
    assert not bench.rover.outputs.enabled


@pytest.mark.parametrize("how", ["disarm", "e-stop"])
def test_disarming_zeroes_the_outputs_at_once(how: str) -> None:
    bench = Bench(DRIVE_TYPE=2, MOT1_TRIM=20, MOT1_MIN=50, MOT2_TRIM=20)
    bench.drive(Axes(throttle=1.0, steering=0.5))
    command = (Command.COMPONENT_ARM_DISARM, 0) if how == "disarm" else (Command.DO_SET_SAFETY_SWITCH_STATE, 0)
    assert bench.command(*command) is Result.ACCEPTED
    assert bench.rover.outputs == Outputs((0.0, 0.0), enabled=False)
    bench.wait(1.0, AHEAD)
    assert bench.rover.outputs == Outputs((0.0, 0.0), enabled=False)


def test_the_trim_is_the_centre_of_a_servo_and_moves_no_wheel() -> None:
    bench = Bench(DRIVE_TYPE=2, MOT1_TRIM=10, MOT2_TRIM=-10, MOT1_MIN=30)
    bench.drive()
    bench.wait(1.0, NEUTRAL)
    assert bench.throttles == pytest.approx((0.0, -0.1))
    assert bench.throttles[0] == 0.0
    assert bench.newest(m.RoverDriveStatus).output == [0, 0, 0, 0]
    assert bench.newest(m.VfrHud).throttle == 0
    bench.wait(1.0, Axes(throttle=0.5, steering=1.0))
    assert bench.throttles == pytest.approx((0.3 + 0.7 * 0.4845 + 0.1, 1.0), abs=1e-3)
    bench.wait(1.0, Axes(steering=-1.0))
    assert bench.throttles == pytest.approx((0.0, -1.0))
    assert bench.newest(m.VfrHud).throttle == 0  # a servo is not a throttle


def test_the_reverse_delay_is_for_wheels_and_not_for_a_servo() -> None:
    bench = Bench(DRIVE_TYPE=2, MOT_REV_DELAY=1.0)
    bench.drive(Axes(throttle=0.5, steering=1.0))
    bench.wait(1.0, Axes(throttle=-0.5, steering=-1.0))
    assert bench.throttles == (0.0, -1.0)
    assert bench.newest(m.RoverDriveStatus).limits & DriveLimit.REVERSE_DELAY
    bench.wait(1.0, Axes(throttle=-0.5, steering=-1.0))
    assert bench.throttles[0] < -0.4


def test_a_motor_test_turns_the_wheel_in_its_driving_direction() -> None:
    bench = Bench(MOT1_REVERSED=1, MOT1_MIN=20, MOT2_MIN=20)
    bench.heartbeat()
    assert bench.command(Command.DO_MOTOR_TEST, 1, 0, 25, 1) is Result.ACCEPTED
    bench.wait(0.5)
    assert bench.throttles == pytest.approx((-0.4, 0.0))
    assert bench.newest(m.RoverDriveStatus).output == [2_500, 0, 0, 0]
    bench.wait(1.0)
    assert bench.rover.outputs == Outputs((0.0, 0.0), enabled=False)


def test_a_reversed_rover_that_pushes_without_moving_is_blocked() -> None:
    bench = Bench(MOT1_REVERSED=1, MOT2_REVERSED=1, MOT1_MAX=25, MOT2_MAX=25)
    bench.readings = replace(EVERYTHING, wheel_speeds=(0.0, 0.0))
    bench.drive()
    bench.wait(2.5, AHEAD)
    assert said(bench, "Failsafe")
    assert bench.newest(m.RoverFailsafeStatus).latched & Failsafe.BLOCKED
    assert bench.mode is Mode.HOLD


def test_a_minimum_output_does_not_count_as_blocked() -> None:
    """The operator requests a crawl: 15 % of throttle, which the motor's minimum turns into 49 %."""
    bench = Bench(MOT1_MIN=40, MOT2_MIN=40)
    bench.readings = replace(EVERYTHING, wheel_speeds=(0.0, 0.0))
    bench.drive(Axes(throttle=0.15))
    bench.wait(5.0, Axes(throttle=0.15))
    assert min(bench.throttles) > 0.45
    assert bench.mode is Mode.MANUAL


@pytest.mark.parametrize(
    ("axes", "wheels"),
    [(Axes(throttle=1.0), (0.6, 0.6)), (Axes(steering=1.0), (0.4, -0.4)), (Axes(throttle=1.0, steering=1.0), (0.5, 0))],
)
def test_turning_on_the_spot_is_limited(axes: Axes, wheels: tuple[float, float]) -> None:
    bench = Bench(MOT1_MAX=60, MOT2_MAX=60, MOT_PIVOT_MAX=66.7)
    bench.drive(axes)
    assert bench.throttles == pytest.approx(wheels, abs=1e-3)


@pytest.mark.parametrize("name", MOTOR_PARAMS)
def test_motor_parameters_cannot_be_changed_while_armed(name: str) -> None:
    bench = Bench()
    parameter = PARAMETERS[name]
    other = parameter.high if parameter.default != parameter.high else parameter.low
    bench.drive()
    assert set_(bench, name, other) == pytest.approx(parameter.default)
    assert bench.newest(m.ParamError).error == ParamErrorCode.PERMISSION_DENIED
    bench.command(Command.COMPONENT_ARM_DISARM, 0)
    assert set_(bench, name, other) == pytest.approx(other)


def test_contradicting_parameters_are_rejected() -> None:
    bench = Bench(MOT1_MAX=50)
    assert set_(bench, "MOT1_MIN", 60) == 0
    assert bench.newest(m.ParamError).error == ParamErrorCode.VALUE_OUT_OF_RANGE
    bench.wait(0.1)
    assert said(bench, "MOT1_MIN not changed: MOT1_MIN 60 must be smaller than MOT1_MAX 50")
    assert set_(bench, "MOT1_MAX", 80) == 80
    assert set_(bench, "MOT1_MIN", 60) == 60


def test_a_parameter_reset_restores_the_profile_of_the_car() -> None:
    bench = Bench()
    params, _ = merge_params({}, kept={"MOT1_MAX": 100.0, "MOT1_MIN": 70.0}, usual=profile_params("article-car"))
    assert params["MOT1_MAX"] == 100.0
    bench.rover = Rover(params, now=bench.now)
    bench.wait(CYCLE)
    assert bench.command(Command.PREFLIGHT_STORAGE, 2, -1) is Result.ACCEPTED
    assert (params["MOT1_MAX"], params["MOT1_MIN"]) == (60.0, 0.0)


# ---- whatever the parameters say


@st.composite
def any_params(draw: st.DrawFn) -> Params:
    values = {name: draw(st.floats(PARAMETERS[name].low, PARAMETERS[name].high)) for name in MOTOR_PARAMS}
    values |= {name: draw(st.integers(0, 1)) for name in MOTOR_PARAMS if PARAMETERS[name].whole}
    for small, large in ORDERED_PAIRS:
        values[small] = min(values[small], values[large] - 1)
    return Params({**values, "DRIVE_TYPE": draw(st.integers(1, 4)), "MANUAL_EXPO": draw(st.floats(0, 0.9))})


AXIS = st.one_of(st.none(), st.just(0.0), st.floats(-1, 1), st.sampled_from([-1.0, 1.0, math.nan]))
STEPS = st.lists(st.tuples(AXIS, AXIS, AXIS, st.booleans(), st.booleans(), st.floats(0, 0.2)), max_size=40)


@given(any_params(), STEPS)
def test_outputs_are_valid_zero_stays_zero_and_disarmed_is_off(
    params: Params, steps: list[tuple[float | None, float | None, float | None, bool, bool, float]]
) -> None:
    drive, now = Drive(params, 0.0), 0.0
    for throttle, steering, sideways, armed, held, dt in steps:
        now += dt
        demand = Demand(throttle, steering, now, 255, 0, sideways)
        clearance = Clearance(armed=armed, held=held, neutral_seen=True, demand_age=0.0, timeout=0.45)
        outputs = drive.update(demand, clearance, limited=False, now=now)
        assert all(math.isfinite(value) and abs(value) <= 1.0 for value in outputs.throttles)
        assert outputs.enabled or not any(outputs.throttles)
        assert armed or not outputs.enabled
        for wheel, motor in zip(drive.driven_wheels, outputs.throttles, strict=False):
            assert wheel or motor == 0.0


@given(any_params(), st.floats(-1, 1), st.floats(-1, 1))
def test_a_demand_of_zero_ends_at_zero(params: Params, throttle: float, steering: float) -> None:
    drive = Drive(params, 0.0)
    clearance = Clearance(armed=True, held=False, neutral_seen=True, demand_age=0.0, timeout=0.45)
    drive.update(Demand(throttle, steering, 0.0, 255, 0), clearance, limited=False, now=20.0)
    outputs = drive.update(Demand(0.0, 0.0, 0.0, 255, 0), clearance, limited=False, now=21.0)
    assert outputs.enabled
    assert outputs.throttles[: drive.mixer.driven_count] == (0.0,) * drive.mixer.driven_count
