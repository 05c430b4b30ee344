"""From demand to motor outputs: shares, caps, limits, motor tests, and values that the gate must see."""

from __future__ import annotations

import math

import pytest

from dialects.enums import DriveLimit, DriveType
from dialects.modes import Mode
from tests.rows import each_row
from tests.vehicle.bench import AHEAD, CYCLE, Bench, said
from vehicle.drive.demand import Demand
from vehicle.drive.drive import LIMITED_THROTTLE_MAX, Drive, shape_demand
from vehicle.drive.gate import Clearance, MotorTest, Outputs
from vehicle.drive.slew import Slew, SlewLimits
from vehicle.params import Params

CLEARED = Clearance(armed=True, late=False, held=False, neutral_seen=True, demand_age=0.1, timeout=0.45)


def demand(throttle: float, steering: float = 0.0) -> Demand:
    return Demand(throttle, steering, 0.0, 255, 0)


def run(drive: Drive, wish: Demand | None, cycles: int = 100, *, limited: bool = False, start: float = 0.0) -> Outputs:
    for cycle in range(1, cycles + 1):
        drive.update(wish, CLEARED, limited=limited, now=start + cycle * CYCLE)
    return drive.outputs


@each_row("wrong", [demand(math.nan), demand(0.0, math.nan), demand(math.nan, math.nan)])
@each_row("kind", [1, 2, 3, 4])
@each_row("largest", [100, 50])
def test_nan_becomes_zero_and_not_speed(wrong: Demand, kind: int, largest: float) -> None:
    drive = Drive(Params({"DRIVE_TYPE": kind, "MOT_THR_MAX": largest}), 0.0)
    assert any(run(drive, demand(1.0)).throttles)
    for cycle in range(1, 5):
        outputs = drive.update(wrong, CLEARED, limited=False, now=2.0 + cycle * CYCLE)
        assert outputs == Outputs((0.0,) * len(drive.mixer.motors), enabled=False)
        assert drive.rejected_cycles == cycle
    assert any(run(drive, demand(1.0), start=3.0).throttles)
    assert drive.rejected_cycles == 0


def test_a_nan_sideways_demand_becomes_zero() -> None:
    drive = Drive(Params({"DRIVE_TYPE": 4}), 0.0)
    assert any(run(drive, Demand(0.0, 0.0, 0.0, 255, 0, sideways=1.0)).throttles)
    wrong = Demand(0.0, 0.0, 0.0, 255, 0, sideways=math.nan)
    assert drive.update(wrong, CLEARED, limited=False, now=2.1) == Outputs((0.0,) * 4, enabled=False)


def test_three_cycles_of_nan_are_hold() -> None:
    bench = Bench()
    bench.drive()
    wrong = Demand(math.nan, 0.0, bench.now, 255, 0)
    for _ in range(4):
        bench.rover._control.demand = wrong
        bench.rover._control.neutral_seen = True
        bench.wait(CYCLE)
        assert not bench.turning
    bench.wait(0.2, AHEAD)
    assert bench.mode is Mode.HOLD
    assert said(bench, "Motor values are not numbers: HOLD")


def test_a_limited_throttle_is_reported() -> None:
    drive = Drive(Params({"MOT_THR_MAX": 70}), 0.0)
    found = []
    for start, throttle, limited in ((0.0, 1.0, False), (2.0, 1.0, True), (4.0, 0.3, True)):
        throttles = run(drive, demand(throttle), limited=limited, start=start).throttles
        found.append((round(throttles[0], 2), drive.limits))
    assert found == [(0.7, DriveLimit.SPEED), (0.5, DriveLimit.SPEED), (0.28, DriveLimit(0))]


def test_expo_softens_values_around_neutral() -> None:
    plain, soft = (run(Drive(Params({"MANUAL_EXPO": e}), 0.0), demand(0.3)).throttles[0] for e in (0.0, 0.7))
    assert 0 < soft < plain


def test_a_stop_makes_every_motor_fall_from_the_first_cycle_on() -> None:
    drive = Drive(Params(), 0.0)
    before = run(drive, demand(0.8, -0.6)).throttles
    assert drive.limits == DriveLimit.SATURATED
    after = drive.update(None, CLEARED, limited=False, now=2.0 + CYCLE).throttles
    assert all(abs(new) < abs(old) for new, old in zip(after, before, strict=True))


def test_a_cycle_of_zero_length_changes_nothing() -> None:
    drive = Drive(Params(), 0.0)
    before = run(drive, demand(0.5), cycles=5).throttles
    assert drive.update(demand(1.0), CLEARED, limited=False, now=0.1).throttles == before
    assert drive.update(demand(1.0), CLEARED, limited=False, now=0.05).throttles == before


def test_a_changed_parameter_takes_effect_in_the_next_cycle() -> None:
    params = Params()
    drive = Drive(params, 0.0)
    assert run(drive, demand(1.0)).throttles == (1.0, 1.0)
    params.set("MOT1_MAX", 60)
    assert drive.update(demand(1.0), CLEARED, limited=False, now=2.02).throttles == (0.6, 1.0)
    params.set("MOT_DECEL", 1000)
    assert drive.update(demand(0.0), CLEARED, limited=False, now=2.04).throttles[1] == pytest.approx(0.8)


AT_ONCE = {"MOT_SLEWRATE": 1000.0, "MOT_DECEL": 1000.0, "MAN_DEADBAND": 0.0}
"""Ramps of 0.1 s."""
HELD = CLEARED._replace(held=True)
OFF = Outputs((0.0, 0.0), enabled=False)


def direct(throttle: float | None, steering: float | None = 0.0, sideways: float | None = None) -> Demand:
    return Demand(throttle, steering, 0.0, 255, 0, sideways, direct=True)


class Rig:
    """A drive whose time moves by `step` s an update."""

    def __init__(self, step: float = 0.125, **params: float) -> None:
        self.params = Params(AT_ONCE | params)
        self.step = step
        self.now = 0.0
        self.drive = Drive(self.params, self.now)

    def update(self, wanted: Demand | None, clearance: Clearance = CLEARED, *, limited: bool = False) -> Outputs:
        self.now += self.step
        return self.drive.update(wanted, clearance, limited=limited, now=self.now)


def test_a_new_one_stands_and_limits_nothing() -> None:
    for kind, motors in ((DriveType.SKID, 2), (DriveType.ACKERMANN, 2), (DriveType.OMNI, 4)):
        drive = Drive(Params({"DRIVE_TYPE": kind}), 0.0)
        assert drive.kind is kind
        assert drive.outputs == Outputs((0.0,) * motors, enabled=False)
        assert drive.limits == DriveLimit(0)
        assert drive.wheels == (0.0,) * motors
        assert drive.rejected_cycles == 0


def test_only_motors_that_drive_are_wheels_that_move_the_rover() -> None:
    rig = Rig(DRIVE_TYPE=DriveType.ACKERMANN)
    rig.update(direct(0.5, 0.25))
    assert rig.drive.wheels == (0.5, 0.25)
    assert rig.drive.driven_wheels == (0.5,)
    rig = Rig()
    rig.update(direct(0.5))
    assert rig.drive.driven_wheels == (0.5, 0.5)


def test_wheels_are_as_they_turn_however_their_motors_are_wired() -> None:
    rig = Rig(MOT1_REVERSED=1, MOT2_MAX=50)
    assert rig.update(direct(0.5)).throttles == (-0.5, 0.25)
    assert rig.drive.wheels == (0.5, 0.5)


def test_the_first_step_counts_from_the_start() -> None:
    drive = Drive(Params({"MOT_SLEWRATE": 100, "MAN_DEADBAND": 0}), 10.0)
    assert drive.update(direct(1.0), CLEARED, limited=False, now=10.25).throttles == (0.25, 0.25)
    assert drive.update(direct(1.0), CLEARED, limited=False, now=10.5).throttles == (0.5, 0.5)
    assert drive.limits == DriveLimit.SLEW


@pytest.mark.parametrize("demanded", [0.75, -0.75])
def test_throttle_and_sideways_are_capped_and_steering_is_not(demanded: float) -> None:
    assert LIMITED_THROTTLE_MAX == 0.5
    side = math.copysign(1.0, demanded)
    for params, limited, largest in (({"MOT_THR_MAX": 75.0}, False, 0.75), ({"MOT_THR_MAX": 60.0}, False, 0.6),
                                     ({}, True, 0.5), ({"MOT_THR_MAX": 40.0}, True, 0.4)):  # fmt: skip
        rig = Rig(DRIVE_TYPE=DriveType.MECANUM, **params)
        capped = DriveLimit.SPEED if largest < 0.75 else DriveLimit(0)
        assert rig.update(direct(demanded), limited=limited).throttles == (side * largest,) * 4
        assert rig.drive.limits == capped
        rig = Rig(DRIVE_TYPE=DriveType.MECANUM, **params)
        throttles = rig.update(direct(0.0, 0.0, demanded), limited=limited).throttles
        assert throttles == (side * largest, -side * largest, -side * largest, side * largest)
        assert rig.drive.limits == capped
    rig = Rig()
    assert rig.update(direct(0.0, demanded), limited=True).throttles == (demanded, -demanded)
    assert rig.drive.limits == DriveLimit(0)


def test_limits_are_reported_for_the_cycle_in_which_they_hold() -> None:
    rig = Rig()
    rig.update(direct(1.0, 0.5))
    assert rig.drive.limits == DriveLimit.SATURATED
    rig.update(direct(0.5))
    assert rig.drive.limits == DriveLimit(0)
    rig = Rig(MOT_REV_DELAY=0.2)
    rig.update(direct(0.5))
    reported = []
    for _ in range(2):
        rig.update(direct(-0.5))
        reported.append(rig.drive.limits)
    assert reported == [DriveLimit.SLEW, DriveLimit.REVERSE_DELAY]


def test_limits_add_up() -> None:
    rig = Rig(MOT_SLEWRATE=100)
    rig.update(direct(1.0, 1.0))
    assert rig.drive.limits == DriveLimit.SATURATED | DriveLimit.SLEW
    rig = Rig(MOT_THR_MAX=75)
    rig.update(direct(1.0, 1.0))
    assert rig.drive.limits == DriveLimit.SATURATED | DriveLimit.SPEED
    rig = Rig(MOT_SLEWRATE=100, MOT_REV_DELAY=1.0)
    for _ in range(2):
        rig.update(direct(0.25))
    for _ in range(2):
        rig.update(direct(0.0, 1.0))
    assert rig.drive.limits == DriveLimit.SLEW | DriveLimit.REVERSE_DELAY


def test_on_spot_skid_wheels_get_a_share_and_steered_wheels_all() -> None:
    assert Rig(MOT_PIVOT_MAX=50).update(direct(0.0, 0.5)).throttles == (0.25, -0.25)
    assert Rig(MOT_PIVOT_MAX=50).update(direct(0.5, 0.0)).throttles == (0.5, 0.5)
    assert Rig(MOT_PIVOT_MAX=50, DRIVE_TYPE=DriveType.ACKERMANN).update(direct(0.0, 0.5)).throttles == (0.0, 0.5)


def test_a_steering_servo_does_not_wait_before_it_reverses() -> None:
    rig = Rig(DRIVE_TYPE=DriveType.ACKERMANN, MOT_REV_DELAY=1.0)
    rig.update(direct(0.5, 0.5))
    rig.update(direct(-0.5, -0.5))
    assert rig.update(direct(-0.5, -0.5)).throttles == (0.0, -0.5)


def test_limits_of_the_mixer_are_parameters() -> None:
    assert Rig(MOT_STR_THR_MIX=1.0).update(direct(1.0, 0.75)).throttles == (1.0, -0.5)
    assert Rig(MOT_THST_ASYM=2.0).update(direct(-0.25)).throttles == (-0.5, -0.5)


def test_ramps_are_parameters() -> None:
    rig = Rig(MOT_SLEWRATE=100, MOT_DECEL=400)
    assert rig.update(direct(1.0)).throttles == (0.125, 0.125)
    for _ in range(7):
        rig.update(direct(1.0))
    assert rig.update(direct(0.0)).throttles == (0.5, 0.5)


def test_a_stop_may_take_as_long_as_its_ramp() -> None:
    rig = Rig(MOT_DECEL=400)
    assert rig.update(direct(1.0)).throttles == (1.0, 1.0)
    assert rig.update(direct(1.0), HELD) == Outputs((0.5, 0.5), enabled=True)
    assert rig.update(direct(1.0), HELD) == OFF
    assert rig.drive.rejected_cycles == 0


def test_a_ramp_that_does_not_fall_is_ended_by_the_gate() -> None:
    class Stuck(Slew):
        def step(self, target: float, dt: float, limits: SlewLimits) -> float:
            return 0.5

    drive = Drive(Params({"MOT_DECEL": 250}), 0.0)
    drive._slews[:] = [Stuck(), Stuck()]
    assert drive.update(None, CLEARED, limited=False, now=0.0).enabled
    for now, passes in ((0.0, True), (0.45, True), (0.452, False)):
        assert drive.update(None, HELD, limited=False, now=now).enabled is passes


def test_without_a_permit_it_stands_at_once_and_begins_from_zero() -> None:
    rig = Rig(MOT_SLEWRATE=100, MOT_DECEL=250)
    for _ in range(4):
        rig.update(direct(1.0))
    assert rig.drive.wheels == (0.5, 0.5)
    assert rig.update(direct(1.0), CLEARED._replace(late=True)) == OFF
    assert rig.drive.limits == DriveLimit(0)
    assert rig.update(direct(1.0)).throttles == (0.125, 0.125)


def test_what_the_gate_refuses_is_no_begin_of_a_ramp() -> None:
    rig = Rig(MOT_SLEWRATE=100)
    rig.update(direct(1.0))
    assert rig.update(direct(math.nan)) == OFF
    assert rig.drive.rejected_cycles == 1
    assert rig.update(direct(1.0)).throttles == (0.125, 0.125)


class TestMotorTest:
    FIRST = Clearance(motor_test=MotorTest(1, 0, 0.25))
    SECOND = Clearance(motor_test=MotorTest(2, 1, -0.25))

    def test_it_turns_one_motor(self) -> None:
        rig = Rig()
        assert rig.update(None, self.FIRST) == Outputs((0.25, 0.0), enabled=True)
        rig = Rig()
        assert rig.update(direct(1.0), self.SECOND) == Outputs((0.0, -0.25), enabled=True)

    def test_it_does_not_ramp_down_into_another_one(self) -> None:
        rig = Rig(step=0.03125, MOT_DECEL=400, MOT_SLEWRATE=400)
        rig.update(None, self.FIRST)
        assert rig.update(None, self.FIRST).throttles == (0.25, 0.0)
        assert rig.update(None, self.SECOND) == Outputs((0.0, -0.125), enabled=True)

    def test_nor_into_a_drive(self) -> None:
        rig = Rig(step=0.03125, MOT_DECEL=400, MOT_SLEWRATE=400)
        rig.update(None, self.FIRST)
        rig.update(None, self.FIRST)
        assert rig.update(direct(0.0)).throttles == (0.0, 0.0)
        assert rig.drive.rejected_cycles == 0

    def test_a_renewed_one_goes_on(self) -> None:
        rig = Rig(MOT_DECEL=400, MOT_SLEWRATE=100)
        rig.update(None, self.FIRST)
        again = Clearance(motor_test=MotorTest(2, 0, 0.25))
        assert rig.update(None, again).throttles == (0.25, 0.0)

    def test_while_armed_it_means_nothing(self) -> None:
        armed = CLEARED._replace(motor_test=MotorTest(1, 0, 0.25))
        assert Rig().update(direct(0.5), armed).throttles == (0.5, 0.5)


@pytest.mark.parametrize(
    ("params", "shaped"),
    [
        ({"MAN_DEADBAND": 0.0}, (0.5, -0.5, 0.5)),
        ({"MAN_DEADBAND": 20.0}, (0.375, -0.375, 0.375)),
        ({"MAN_DEADBAND": 0.0, "MANUAL_EXPO": 0.5}, (1 / 3, -0.5, 1 / 3)),
        ({"MAN_DEADBAND": 0.0, "MANUAL_STR_EXPO": 0.5}, (0.5, -1 / 3, 0.5)),
    ],
)
def test_a_drivers_demand_has_a_dead_band_and_softness(
    params: dict[str, float], shaped: tuple[float, float, float]
) -> None:
    of_a_driver = Demand(0.5, -0.5, 0.0, 255, 0, 0.5)
    assert shape_demand(of_a_driver, Params(params)) == pytest.approx(shaped)
    assert shape_demand(of_a_driver._replace(direct=True), Params(params)) == (0.5, -0.5, 0.5)


def test_an_axis_without_a_demand_is_zero() -> None:
    assert shape_demand(Demand(None, None, 0.0, 255, 0), Params()) == (0.0, 0.0, 0.0)
    assert shape_demand(direct(None, None), Params()) == (0.0, 0.0, 0.0)


def test_a_sideways_nan_stops_a_drive_that_does_not_use_it() -> None:
    rig = Rig(DRIVE_TYPE=DriveType.SKID)
    assert rig.update(direct(0.5)).throttles == (0.5, 0.5)
    assert rig.update(direct(0.5, sideways=math.nan)) == OFF
    assert rig.drive.rejected_cycles == 1


def test_steering_trim_counts_beside_a_motor_without_settings() -> None:
    rig = Rig(DRIVE_TYPE=DriveType.ACKERMANN, MOT2_TRIM=10.0)
    assert rig.update(direct(0.5)).throttles == (0.5, 0.1)
    assert rig.drive.wheels == (0.5, 0.0)


@each_row("kind", [1, 2, 4])
@each_row(("share", "left"), [(1.5, 1.0), (1.0, 1.0), (0.5, 0.5), (0.0, 0.0), (-1.0, 0.0), (math.nan, 0.0)])
def test_obstacles_make_values_smaller_and_never_larger(kind: int, share: float, left: float) -> None:
    drive = Drive(Params({"DRIVE_TYPE": kind}), 0.0)
    full = run(drive, demand(0.6, 0.2)).throttles
    for cycle in range(1, 101):
        drive.update(
            demand(0.6, 0.2), CLEARED, limited=False, now=2.0 + cycle * CYCLE,
            avoid=lambda wanted, present: (share, DriveLimit.OBSTACLE.value),
        )  # fmt: skip
    driven = 1 if kind == 2 else len(full)
    assert drive.outputs.throttles[:driven] == pytest.approx([left * value for value in full[:driven]])
    assert drive.outputs.throttles[driven:] == full[driven:], "a servo steers as before"
    assert bool(drive.limits & DriveLimit.OBSTACLE) == (left < 1.0)
    assert (drive.avoiding_speed < math.inf) == (left < 1.0)
