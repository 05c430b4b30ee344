"""The drivers of relays and servos: the contract, and what each has of its own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from gpiozero.pins.mock import MockFactory

from tests.vehicle.accessories.contract import AccessoryContract, Bench
from tests.vehicle.motors.fake_pca9685 import FakePca9685
from vehicle.accessories.gpio import GpioRelay, GpioRelaySettings
from vehicle.accessories.output import AccessoryOutput, AccessorySpec
from vehicle.accessories.pca9685 import Pca9685Servo, Pca9685ServoSettings
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.motors import MotorError
from vehicle.motors.pca9685 import Pca9685Channel, Pca9685Motors, Pca9685Settings

STEP = 5
"""us, about a step of the chip."""


@pytest.fixture
def pins() -> Iterator[MockFactory]:
    factory = MockFactory()
    yield factory
    factory.reset()


class TestSimulated(AccessoryContract):
    @pytest.fixture
    def bench(self) -> Bench:
        made: list[SimulatedAccessory] = []

        def make(value: int) -> SimulatedAccessory:
            made.append(SimulatedAccessory(value))
            return made[-1]

        return Bench(make, lambda: made[-1].value, (1, 1700))


@pytest.mark.parametrize("active_high", [True, False])
class TestGpioRelay(AccessoryContract):
    @pytest.fixture
    def bench(self, pins: MockFactory, active_high: bool) -> Bench:
        settings = GpioRelaySettings(16, active_high)
        return Bench(
            lambda value: GpioRelay(settings, value, pin_factory=pins),
            lambda: int(pins.pin(16).state is active_high),
            (1,),
        )


@pytest.mark.parametrize(("active_high", "value"), [(True, 0), (True, 1), (False, 0), (False, 1)])
def test_a_relay_is_opened_with_its_first_state_at_the_pin(pins: MockFactory, active_high: bool, value: int) -> None:
    pin = pins.pin(16)
    pin.clear_states()
    relay = GpioRelay(GpioRelaySettings(16, active_high), value, pin_factory=pins)
    as_output = [bool(each.state) for each in pin.states[1:]]
    assert set(as_output) <= {bool(value) is active_high}
    assert pin.function == "output"
    relay.close()


def test_a_relay_whose_pin_is_taken_says_so(pins: MockFactory) -> None:
    first = GpioRelay(GpioRelaySettings(16), 1, pin_factory=pins)
    with pytest.raises(MotorError, match=r"pin: .*GPIO16 is already in use"):
        GpioRelay(GpioRelaySettings(16), 0, pin_factory=pins)
    assert pins.pin(16).state
    first.close()
    assert pins.pin(16).function == "input"
    with pytest.raises(MotorError, match="pin: "):
        first.set(1)


class TestPca9685Servo(AccessoryContract):
    @pytest.fixture
    def bench(self) -> Bench:
        fake = FakePca9685()

        def make(value: int) -> Pca9685Servo:
            fake.closed = False
            return Pca9685Servo(Pca9685ServoSettings(channel=4), value, bus=fake)

        return Bench(make, lambda: round((fake.pulse(4) or 0.0) * 1e6), (1100, 1500, 1900), STEP)


def test_its_pulses_are_those_of_the_chips_clock() -> None:
    fake = FakePca9685()
    servo = Pca9685Servo(Pca9685ServoSettings(channel=15), 0, bus=fake)
    assert fake.pulse(15) is None
    servo.set(1700)
    assert fake.pulse(15) == pytest.approx(1700e-6, abs=122 / 25e6)
    servo.close()
    assert fake.pulse(15) == pytest.approx(1700e-6, abs=122 / 25e6)  # who closes it has made it safe before
    assert fake.closed


def test_at_the_motors_board_it_touches_its_own_channel_only() -> None:
    fake = FakePca9685()
    motors = Pca9685Motors(Pca9685Settings(channels=(Pca9685Channel(0), Pca9685Channel(1))), bus=fake)
    motors.enable()
    motors.set((0.5, -0.5))
    before = fake.pulse(0), fake.pulse(1)
    fake.writes.clear()
    servo = Pca9685Servo(Pca9685ServoSettings(channel=4), 1200, bus=fake)
    for width in (1000, 2000, 0, 1500):
        servo.set(width)
    own = range(6 + 4 * 4, 6 + 4 * 5)
    assert fake.writes
    assert all(register in own and register + len(data) - 1 in own for register, data in fake.writes)
    assert (fake.pulse(0), fake.pulse(1)) == before


def test_a_chip_that_lost_its_power_is_not_woken_by_a_servo() -> None:
    """Its motors would start with it."""
    fake = FakePca9685()
    servo = Pca9685Servo(Pca9685ServoSettings(channel=4), 0, bus=fake)
    fake.lose_power()
    fake.writes.clear()
    with pytest.raises(MotorError, match="it has lost its power; restart the vehicle"):
        servo.set(1500)
    assert fake.writes == []


def test_no_board_and_a_dead_bus_are_said_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    fake = FakePca9685()
    monkeypatch.setattr("vehicle.motors.pca9685_board.open_bus", lambda number: fake)
    with pytest.raises(MotorError, match="PCA9685 at 0x41 on I2C bus 1: Remote I/O error"):
        Pca9685Servo(Pca9685ServoSettings(channel=0, address=0x41), 0)
    assert fake.closed
    fake.closed = False
    servo = Pca9685Servo(Pca9685ServoSettings(channel=0), 0)
    fake.failing = 1
    with pytest.raises(MotorError, match="PCA9685 at 0x40 on I2C bus 1: Remote I/O error"):
        servo.set(1500)
    servo.set(1500)
    assert fake.pulse(0) == pytest.approx(1500e-6, abs=5e-6)


def test_an_outlet_takes_whatever_a_driver_raises() -> None:
    class Broken:
        def __init__(self, value: int) -> None:
            self.closed = False

        def set(self, value: int) -> None:
            raise ZeroDivisionError

        def close(self) -> None:
            raise KeyError("pin\n16")

    outlet = AccessoryOutput(AccessorySpec("relay", 0, Broken))
    outlet.open()
    outlet.set_value(1)
    assert not outlet.update(10.0)
    assert (outlet.fault, outlet.actual) == ("ZeroDivisionError", 0)
    outlet.close()
    assert outlet.fault == "'pin\\n16'"
    assert outlet.actual is None
    outlet.close()
