"""The estimate compared with the truth of the simulator: noisy, missing and impossible sensors."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from dialects import messages as m
from dialects.enums import EstimatorFlag
from tests.examples import examples
from tests.vehicle.bench import EVERYTHING, Bench
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.estimator import GPS_LOST, Estimator
from vehicle.navigation.geo import Origin, Point, wrap_angle
from vehicle.readings import Readings
from vehicle.sim.body import SimulatedBody, SimulatedHome
from vehicle.sim.noise import SensorNoise

HOME = SimulatedHome(50.0, 8.0)


class Ride:
    """A simulated rover that drives squares and what the filter makes of its sensors."""

    def __init__(self, seed: int | None, noise: SensorNoise | None = None, **missing: None) -> None:
        self.throttles = (0.0, 0.0)
        self.body = SimulatedBody(lambda: self.throttles, home=HOME, seed=seed, noise=noise)
        self.estimator = Estimator()
        self.missing = missing
        self.cycle = 0
        self.errors: list[float] = []

    @property
    def estimate(self) -> Estimate:
        return self.estimator.estimate

    @property
    def truth(self) -> Point:
        return Point(self.body.motion.north, self.body.motion.east)

    @property
    def believed(self) -> Point:
        """On the globe, as metres from the plant's home."""
        assert self.estimate.lat_lon is not None
        return Origin(HOME.latitude, HOME.longitude).to_local(*self.estimate.lat_lon)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds * 50)):
            self.cycle += 1
            readings = replace(self.body.read(self.cycle / 50), **self.missing)
            self.estimator.update(readings, self.cycle / 50)
            if self.estimate.origin is not None:
                self.errors.append(self.believed.distance(self.truth))

    def squares(self, rounds: int) -> None:
        for _ in range(4 * rounds):
            self.throttles = (0.6, 0.6)
            self.run(12.0)
            self.throttles = (0.3, -0.3)
            self.run(1.22)
        self.throttles = (0.0, 0.0)
        self.run(1.0)


def test_perfect_sensors_give_the_truth() -> None:
    ride = Ride(None)
    ride.squares(2)
    assert max(ride.errors) < 0.05
    assert abs(wrap_angle((ride.estimate.yaw or 0.0) - ride.body.motion.yaw)) < 0.01


@pytest.mark.parametrize("seed", range(4))
def test_noisy_sensors_give_decimetres(seed: int) -> None:
    ride = Ride(seed)
    ride.squares(6)
    errors = sorted(ride.errors[1000:])
    assert errors[len(errors) // 2] < 0.45
    assert errors[-1] < 0.8
    assert abs(wrap_angle((ride.estimate.yaw or 0.0) - ride.body.motion.yaw)) < 0.03  # the compass alone is 0.03 off
    assert ride.estimate.good
    assert errors[-1] < ride.estimate.accuracy


def test_the_bias_of_the_gyro_is_learned() -> None:
    ride = Ride(7, SensorNoise(gyro_bias=0.05))
    ride.run(120.0)
    assert ride.estimate.yaw_rate == pytest.approx(0.0, abs=0.03)


@pytest.mark.parametrize("seed", range(4))
def test_the_scale_of_the_wheels_is_learned(seed: int) -> None:
    ride = Ride(seed, SensorNoise(wheel_scale=0.08))
    ride.throttles = (0.6, 0.6)
    ride.run(90.0)
    assert ride.estimate.speed == pytest.approx(ride.body.motion.speed, abs=0.07)  # 0.02 of it is a reading's own noise
    assert max(ride.errors) < 1.5  # wheels that are 8 % off make 6 m of 80


def test_slipping_wheels_do_not_change_the_scale() -> None:
    slipping, steady = Estimator(), Estimator()
    for cycle in range(3000):
        for estimator, speed in ((slipping, 1.0), (steady, 0.0)):
            estimator.update(
                Readings(yaw=0.0, speed=speed, latitude=50.0, longitude=8.0, gps_fix=3, velocity_north=0.0,
                         velocity_east=0.0), cycle / 50
            )  # fmt: skip
    assert slipping.estimate.speed == 1.0
    assert steady.estimate.speed == 0.0


@pytest.mark.parametrize(
    "missing", [{"yaw": None}, {"yaw_rate": None}, {"speed": None}, {"yaw": None, "speed": None}], ids=str
)
def test_the_estimate_works_without_some_sensors(missing: dict[str, None]) -> None:
    ride = Ride(2, **missing)
    ride.squares(4)
    assert ride.estimate.good
    assert sorted(ride.errors)[len(ride.errors) // 2] < 2.0


def test_without_gps_the_position_is_relative_to_the_start() -> None:
    ride = Ride(None, gps_fix=None)
    ride.throttles = (0.6, 0.6)
    ride.run(5.0)
    assert ride.estimate.moving_place
    assert ride.estimate.place.distance(ride.truth) < 0.05
    assert (ride.estimate.lat_lon, ride.estimate.good) == (None, False)


def test_a_first_fix_after_driving_keeps_the_driven_distance() -> None:
    ride = Ride(None, gps_fix=None)
    ride.throttles = (0.6, 0.6)
    ride.run(5.0)
    before = ride.estimate.place
    ride.missing = {}
    ride.run(0.02)
    assert ride.estimate.place.distance(before) < 0.05
    assert ride.believed.distance(ride.truth) < 0.05


def test_a_lost_gps_is_detected_and_recovers() -> None:
    ride = Ride(3)
    ride.squares(1)
    assert ride.estimate.good
    ride.missing = {"latitude": None}
    ride.run(GPS_LOST + 0.3)
    assert not ride.estimate.good
    ride.missing = {}
    ride.run(0.5)
    assert ride.estimate.good


def test_one_outlier_is_ignored_and_many_move_the_position() -> None:
    estimator = Estimator()
    for cycle in range(500):
        estimator.update(Readings(yaw=0.0, speed=0.0, latitude=50.0, longitude=8.0, gps_fix=3), cycle / 50)
    wild = Readings(yaw=0.0, speed=0.0, latitude=50.001, longitude=8.0, gps_fix=3)
    estimator.update(wild, 10.0)
    assert estimator.estimate.place.distance(Point(0.0, 0.0)) < 0.01
    assert estimator.estimate.resets == 0
    for cycle in range(600):
        estimator.update(wild, 10.02 + cycle / 50)
    assert estimator.estimate.place.north == pytest.approx(111.3, abs=0.2)
    assert estimator.estimate.resets == 1


BAD = st.sampled_from([math.nan, math.inf, -math.inf, 1e308, -1e308, 0.0, 1.0, -1.0, 89.9, None])


@settings(max_examples=examples(200))
@given(st.lists(st.tuples(BAD, BAD, BAD, BAD, BAD, BAD, BAD), max_size=20), st.floats(0.0, 10.0))
def test_no_reading_makes_the_estimate_nan(rows: list[tuple[float | None, ...]], dt: float) -> None:
    estimator = Estimator()
    names = ("yaw", "yaw_rate", "speed", "latitude", "longitude", "velocity_north", "velocity_east")
    for number, row in enumerate(rows):
        values: dict[str, float | None] = dict(zip(names, row, strict=True))
        estimate = estimator.update(Readings(gps_fix=3, **values), number * dt)  # type: ignore[arg-type]
        numbers = (estimate.yaw, estimate.yaw_rate, estimate.speed, *estimate.place, *estimate.velocity)
        assert all(value is None or math.isfinite(value) for value in numbers)


def test_the_estimate_is_reported_with_its_health() -> None:
    bench = Bench()
    bench.wait(1.5)
    assert bench.newest(m.EstimatorStatus).flags == 0
    assert math.isnan(bench.newest(m.EstimatorStatus).pos_horiz_accuracy)
    bench.readings = EVERYTHING
    bench.wait(1.5)
    status = bench.newest(m.EstimatorStatus)
    assert status.flags == sum(EstimatorFlag)
    assert 0.5 < status.pos_horiz_accuracy < 5.0
    assert bench.newest(m.LocalPositionNed).vx == pytest.approx(0.5, abs=0.02)
