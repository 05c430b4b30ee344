from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from gpiozero import Device
from gpiozero.pins.mock import MockFactory

from tests.vehicle.motors.contract import Bench, MotorsContract
from vehicle.motors import MotorError
from vehicle.motors.drivers import open_motors, safe_stop
from vehicle.motors.safety_pins import GuardedMotors, SafetyPins
from vehicle.motors.settings import SafetyPinSettings
from vehicle.motors.simulated import SimulatedMotors

ESTOP, ENABLE, HEARTBEAT = 17, 22, 27
ALL = SafetyPinSettings(estop_pin=ESTOP, enable_pin=ENABLE, heartbeat_pin=HEARTBEAT)


@pytest.fixture
def pins() -> MockFactory:
    """With the contact of the emergency stop closed, to ground."""
    factory = MockFactory()
    factory.pin(ESTOP)
    return factory


def release(factory: MockFactory) -> None:
    factory.pin(ESTOP).drive_low()


def press(factory: MockFactory) -> None:
    factory.pin(ESTOP).drive_high()


class Guarded:
    """Simulated motors behind pins."""

    def __init__(self, factory: MockFactory, safety: SafetyPinSettings = ALL) -> None:
        self.inner = SimulatedMotors()
        self.motors = GuardedMotors(self.inner, SafetyPins(safety, pin_factory=factory))
        self._level, self._active_high = factory.pin(ENABLE), safety.enable_active_high
        release(factory)

    def powered(self) -> bool:
        return bool(self._level.state) == self._active_high

    def turning(self) -> bool:
        return any(self.inner.outputs) and self.powered()


@pytest.fixture
def guarded(pins: MockFactory) -> Guarded:
    guarded = Guarded(pins)
    guarded.motors.enable()
    guarded.motors.set((0.5, 0.5))
    assert guarded.turning()
    return guarded


class TestGuardedMotors(MotorsContract):
    """As safe as what they guard; enabled is the level of the enable pin."""

    @pytest.fixture(params=[True, False], ids=["active high", "active low"])
    def bench(self, request: pytest.FixtureRequest, pins: MockFactory) -> Bench:
        guarded = Guarded(pins, SafetyPinSettings(estop_pin=ESTOP, enable_pin=ENABLE, enable_active_high=request.param))
        level = pins.pin(ENABLE)
        return Bench(
            guarded.motors,
            lambda: guarded.inner.outputs if guarded.powered() else (0.0, 0.0),
            lambda: level.function == "output" and guarded.powered(),
        )


def test_a_press_cuts_the_power_at_the_edge_before_any_call(guarded: Guarded, pins: MockFactory) -> None:
    press(pins)
    assert not guarded.powered()


def test_after_a_press_writes_raise_and_release_turns_nothing(guarded: Guarded, pins: MockFactory) -> None:
    press(pins)
    with pytest.raises(MotorError, match="the emergency stop is pressed, or its wire is open"):
        guarded.motors.set((0.5, 0.5))
    release(pins)
    with pytest.raises(MotorError, match="emergency stop"):
        guarded.motors.set((0.5, 0.5))
    guarded.motors.disable()
    assert not guarded.turning()
    guarded.motors.set((0.5, 0.5))
    assert not guarded.turning()


def test_a_press_shorter_than_a_control_cycle_counts(guarded: Guarded, pins: MockFactory) -> None:
    press(pins)
    release(pins)
    with pytest.raises(MotorError, match="emergency stop"):
        guarded.motors.set((0.5, 0.5))


def test_pressed_nothing_can_be_enabled_or_tested(pins: MockFactory) -> None:
    guarded = Guarded(pins)
    press(pins)
    with pytest.raises(MotorError, match="emergency stop"):
        guarded.motors.enable()
    with pytest.raises(MotorError, match="emergency stop"):
        guarded.motors.set((0.0, 0.0))
    assert not guarded.powered()
    release(pins)
    guarded.motors.disable()
    guarded.motors.enable()
    assert guarded.powered()


def test_press_at_moment_of_switching_on_cuts_the_power_again(pins: MockFactory) -> None:
    class Pressing:
        """An enable pin that is switched on just after somebody pressed."""

        def __init__(self, pin: Any) -> None:
            self.off = self.close = pin.off
            self._pin = pin

        def on(self) -> None:
            press(pins)
            self._pin.on()
            assert pins.pin(ENABLE).state

    safety = SafetyPins(ALL, pin_factory=pins)
    safety._enable = Pressing(safety._enable)
    wheels = SimulatedMotors()
    release(pins)
    with pytest.raises(MotorError, match="emergency stop"):
        GuardedMotors(wheels, safety).enable()
    assert not pins.pin(ENABLE).state
    assert not wheels.enabled


def test_an_input_without_a_wire_is_pressed(pins: MockFactory) -> None:
    motors = GuardedMotors(SimulatedMotors(), SafetyPins(ALL, pin_factory=pins))  # its pull-up makes it high
    with pytest.raises(MotorError, match="its wire is open"):
        motors.enable()


def test_the_heartbeat_changes_with_each_write_and_stops_without(guarded: Guarded, pins: MockFactory) -> None:
    pin = pins.pin(HEARTBEAT)
    pin.clear_states()
    for _ in range(4):
        guarded.motors.set((0.5, 0.5))
    assert len(pin.states) == 5
    guarded.motors.disable()
    pin.clear_states()
    guarded.motors.set((0.5, 0.5))
    assert len(pin.states) == 1
    assert not pin.state


def test_a_driver_that_fails_to_enable_gets_no_power(pins: MockFactory) -> None:
    class Broken(SimulatedMotors):
        def enable(self) -> None:
            raise MotorError("no reply")

    motors = GuardedMotors(Broken(), SafetyPins(ALL, pin_factory=pins))
    release(pins)
    with pytest.raises(MotorError, match="no reply"):
        motors.enable()
    assert not pins.pin(ENABLE).state


def test_the_power_goes_off_even_if_the_driver_fails_to_disable(pins: MockFactory) -> None:
    class Broken(SimulatedMotors):
        def disable(self) -> None:
            raise MotorError("no reply")

    motors = GuardedMotors(Broken(), SafetyPins(ALL, pin_factory=pins))
    release(pins)
    motors.enable()
    assert pins.pin(ENABLE).state
    for stop in (motors.disable, motors.close):
        with pytest.raises(MotorError, match="no reply"):
            stop()
        assert not pins.pin(ENABLE).state


class TestByItsSettings:
    """Around any driver, by its name."""

    SETTINGS = {"safety": {"estop_pin": ESTOP, "enable_pin": ENABLE}}  # noqa: RUF012

    @pytest.fixture(autouse=True)
    def default(self, pins: MockFactory) -> Iterator[None]:
        before, Device.pin_factory = Device.pin_factory, pins
        yield
        Device.pin_factory = before

    def test_it_opens_without_power(self, pins: MockFactory) -> None:
        motors = open_motors("simulated", self.SETTINGS)
        assert isinstance(motors, GuardedMotors)
        assert not pins.pin(ENABLE).state
        motors.close()

    def test_safe_stop_cuts_the_power_with_the_stop_pressed_too(self, pins: MockFactory) -> None:
        pins.pin(ENABLE).function = "output"
        pins.pin(ENABLE).state = True
        press(pins)
        assert safe_stop("simulated", self.SETTINGS) == []
        assert not pins.pin(ENABLE).state

    def test_the_power_is_off_before_the_driver_touches_its_hardware(self, pins: MockFactory) -> None:
        pins.pin(ENABLE).function = "output"
        pins.pin(ENABLE).state = True
        Watcher.pins = pins
        open_motors(f"{__name__}:Watcher", self.SETTINGS).close()
        assert Watcher.seen == [False]


class Watcher(SimulatedMotors):
    """Notes the level of the enable pin when it is made."""

    pins: MockFactory
    seen: Sequence[bool] = ()

    def __init__(self) -> None:
        super().__init__()
        type(self).seen = [bool(self.pins.pin(ENABLE).state)]
