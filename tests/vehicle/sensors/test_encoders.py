from __future__ import annotations

import math

import pytest
from gpiozero.pins.mock import MockFactory
from hypothesis import given
from hypothesis import strategies as st

from vehicle.motors import MotorError
from vehicle.sensors.encoders import Encoders, EncoderSettings, Wheel, WheelSpeedFilter

SETTINGS = EncoderSettings(wheels=(Wheel(5, 6), Wheel(16, 26)), lines=20, diameter=0.065)


def test_a_steady_wheel() -> None:
    meter = WheelSpeedFilter(0.01)
    speeds = [meter.update(cycle, cycle * 0.02) for cycle in range(50)]
    assert speeds[0] == 0.0
    assert speeds[1:] == pytest.approx([0.5] * 49)


def test_a_wheel_that_stands_is_zero_after_the_window() -> None:
    meter = WheelSpeedFilter(0.01)
    for cycle in range(20):
        meter.update(cycle, cycle * 0.02)
    assert meter.update(19, 0.48) > 0.0
    for cycle in range(25, 40):
        speed = meter.update(19, cycle * 0.02)
    assert speed == 0.0


def test_backwards_is_negative() -> None:
    meter = WheelSpeedFilter(0.01)
    meter.update(0, 0.0)
    assert meter.update(-3, 0.1) == pytest.approx(-0.3)


def test_a_repeated_or_earlier_time_gives_no_speed() -> None:
    meter = WheelSpeedFilter(0.01)
    assert meter.update(5, 1.0) == 0.0
    assert meter.update(9, 1.0) == 0.0
    assert meter.update(9, 0.5) == 0.0


@given(st.lists(st.tuples(st.integers(-1000, 1000), st.floats(0.0, 1.0)), max_size=50))
def test_no_counts_and_times_give_a_speed_that_is_no_number(steps: list[tuple[int, float]]) -> None:
    meter, now = WheelSpeedFilter(0.01), 0.0
    for count, later in steps:
        now += later
        assert math.isfinite(meter.update(count, now)) or later < 1e-300


def turn(factory: MockFactory, wheel: Wheel, counts: int) -> None:
    """One line of a disc passes: four edges, A before B, or B before A backwards."""
    first, second = (wheel.a, wheel.b) if counts > 0 else (wheel.b, wheel.a)
    for _ in range(abs(counts)):
        for pin, level in ((first, "low"), (second, "low"), (first, "high"), (second, "high")):
            getattr(factory.pin(pin), f"drive_{level}")()


def test_turning_wheels_are_counted() -> None:
    factory = MockFactory()
    encoders = Encoders(SETTINGS, pin_factory=factory)
    assert encoders.latest(0.0) == (0.0, 0.0)
    turn(factory, SETTINGS.wheels[0], 8)
    turn(factory, SETTINGS.wheels[1], -4)
    speeds = encoders.latest(0.2)
    assert speeds is not None
    assert [abs(speed) for speed in speeds] == pytest.approx(
        [8 * math.pi * 0.065 / 20 / 0.2, 4 * math.pi * 0.065 / 20 / 0.2]
    )
    assert speeds[0] * speeds[1] < 0.0
    encoders.close()
    assert encoders.latest(0.3) is None
    encoders.close()


def test_more_than_a_detent_encoder_could_count() -> None:
    factory = MockFactory()
    encoders = Encoders(EncoderSettings(wheels=(Wheel(5, 6),)), pin_factory=factory)
    encoders.latest(0.0)
    turn(factory, Wheel(5, 6), 100)
    speeds = encoders.latest(1.0)
    assert speeds is not None
    assert abs(speeds[0]) == pytest.approx(100 * math.pi * 0.065 / 20)
    encoders.close()


def test_a_pin_in_use_is_a_motor_error_and_lets_the_others_go() -> None:
    factory = MockFactory()
    other = Encoders(EncoderSettings(wheels=(Wheel(26, 25),)), pin_factory=factory)
    with pytest.raises(MotorError, match=r"wheel encoders: .*GPIO26"):
        Encoders(SETTINGS, pin_factory=factory)
    other.close()
    Encoders(SETTINGS, pin_factory=factory).close()
