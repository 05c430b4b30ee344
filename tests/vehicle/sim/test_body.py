from __future__ import annotations

import math

import pytest

from vehicle.motors.simulated import SimulatedMotors
from vehicle.readings import Readings
from vehicle.sim.battery import Battery
from vehicle.sim.body import SimulatedBody, SimulatedHome
from vehicle.sim.chassis import AckermannChassis


def read_for(body: SimulatedBody, seconds: float, start: float = 0.0) -> Readings:
    body.read(start)
    for cycle in range(1, round(seconds * 50) + 1):
        readings = body.read(start + cycle / 50)
    return readings


def test_a_rover_at_rest_measures_rest() -> None:
    body = SimulatedBody(lambda: (0.0, 0.0), home=SimulatedHome(50.0, 8.0, 100.0))
    readings = read_for(body, 1.0)
    assert (body.motion.north, body.motion.east, readings.speed, readings.yaw) == (0.0, 0.0, 0.0, 0.0)
    assert (readings.roll, readings.pitch, readings.yaw_rate) == (0.0, 0.0, 0.0)
    assert (readings.latitude, readings.longitude, readings.altitude) == (50.0, 8.0, 100.0)
    assert readings.gps_fix == 3
    assert readings.battery_voltage == pytest.approx(12.6, abs=0.1)
    assert readings.battery_current == pytest.approx(0.5)


def test_nothing_it_could_measure_is_missing() -> None:
    readings = SimulatedBody(lambda: (0.0, 0.0)).read(0.0)
    assert all(getattr(readings, name) is not None for name in Readings.__struct_fields__)


def test_it_follows_the_motors_only_while_they_have_power() -> None:
    motors = SimulatedMotors()
    body = SimulatedBody(lambda: motors.outputs)
    motors.set((1.0, 1.0))
    assert read_for(body, 1.0).speed == 0.0
    motors.enable()
    motors.set((1.0, 1.0))
    assert (read_for(body, 1.0, 1.0).speed or 0) > 1.0
    motors.disable()
    assert read_for(body, 2.0, 2.0).speed == 0.0


def test_driving_north_raises_the_latitude() -> None:
    body = SimulatedBody(lambda: (1.0, 1.0), home=SimulatedHome(50.0, 8.0))
    readings = read_for(body, 10.0)
    assert body.motion.north > 10.0
    assert readings.latitude == pytest.approx(50.0 + body.motion.north / 111_320, abs=1e-6)
    assert readings.longitude == 8.0
    assert (readings.velocity_north, readings.velocity_east) == (readings.speed, 0.0)


def test_driving_east_raises_the_longitude() -> None:
    throttles = [(1.0, -1.0)]
    body = SimulatedBody(lambda: throttles[0], home=SimulatedHome(60.0, 8.0))
    now = 0.0
    while (body.read(now).yaw or 0.0) < math.pi / 2:
        now += 0.02
    throttles[0] = (1.0, 1.0)
    readings = read_for(body, 10.0, now)
    east = body.motion.east
    assert east > 5.0
    assert readings.longitude == pytest.approx(8.0 + east / 111_320 / math.cos(math.radians(60)), abs=1e-6)


def test_the_nose_lifts_and_the_body_leans_out_of_a_turn() -> None:
    body = SimulatedBody(lambda: (1.0, 0.6))
    start = read_for(body, 0.1)
    assert (start.pitch or 0) > 0.01
    turning = read_for(body, 3.0, 0.1)
    assert (turning.yaw_rate or 0) > 0
    assert (turning.roll or 0) < -0.005


def test_driving_empties_the_battery_faster_than_standing() -> None:
    standing = read_for(SimulatedBody(lambda: (0.0, 0.0)), 60.0)
    driving = read_for(SimulatedBody(lambda: (1.0, 1.0)), 60.0)
    assert (standing.battery_remaining or 0) > (driving.battery_remaining or 0)
    assert (standing.battery_voltage or 0) > (driving.battery_voltage or 0)
    assert driving.battery_current == pytest.approx(0.5 + 2 * 1.2, abs=0.2)


def test_pulling_away_takes_more_current_than_rolling() -> None:
    body = SimulatedBody(lambda: (1.0, 1.0))
    assert (read_for(body, 0.04).battery_current or 0) > 2 * (read_for(body, 3.0, 0.04).battery_current or 0)


def test_an_empty_battery_turns_nothing() -> None:
    readings = read_for(SimulatedBody(lambda: (1.0, 1.0), battery=Battery(0.0)), 1.0)
    assert readings.speed == 0.0
    assert readings.battery_current == pytest.approx(0.5)


def test_a_car_is_steered_by_its_second_output() -> None:
    readings = read_for(SimulatedBody(lambda: (0.5, 1.0), chassis=AckermannChassis()), 1.0)
    assert (readings.yaw or 0) > 0.3


def test_how_often_it_is_read_hardly_matters() -> None:
    often, seldom = SimulatedBody(lambda: (1.0, 0.8)), SimulatedBody(lambda: (1.0, 0.8))
    read_for(often, 2.0)
    seldom.read(0.0)
    seldom.read(2.0)
    assert seldom.motion.north == pytest.approx(often.motion.north)


def test_a_long_stop_of_the_process_is_left_out() -> None:
    body = SimulatedBody(lambda: (1.0, 1.0))
    body.read(0.0)
    body.read(3600.0)
    assert body.motion.north < 10.0


def test_noise_is_repeatable_and_small() -> None:
    def measured(seed: int | None) -> tuple[Readings, SimulatedBody]:
        body = SimulatedBody(lambda: (0.0, 0.0), home=SimulatedHome(50.0, 8.0), seed=seed)
        return read_for(body, 30.0), body

    assert measured(1)[0] == measured(1)[0]
    assert measured(1)[0].latitude != measured(2)[0].latitude
    assert measured(1)[0].latitude == pytest.approx(50.0, abs=1e-5)  # 1 m
    assert measured(1)[1].motion.north == 0.0  # what the rover really does is not noisy


def test_the_gps_speaks_at_5_hz_and_every_sensor_errs_a_little() -> None:
    body = SimulatedBody(lambda: (1.0, 0.9), seed=3)
    readings = [body.read(cycle / 50) for cycle in range(500)]
    assert len({each.latitude for each in readings}) == pytest.approx(50, abs=1)
    motion, last = body.motion, readings[-1]
    for told, true in (
        (last.yaw, motion.yaw),
        (last.yaw_rate, motion.yaw_rate),
        (last.speed, motion.speed),
        (last.velocity_north, motion.speed * math.cos(motion.yaw)),
    ):
        assert told != true
        assert told == pytest.approx(true, abs=0.3)
