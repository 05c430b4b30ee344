from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any, ClassVar

import pytest
from gpiozero import Device
from gpiozero.exc import PinUnknownPi
from gpiozero.pins.mock import MockFactory, MockPWMPin
from msgspec.structs import astuple

from tests.vehicle.motors.contract import Bench, MotorsContract
from vehicle.config.merge import merge_params
from vehicle.drive.demand import Demand
from vehicle.drive.drive import Drive
from vehicle.drive.gate import Clearance
from vehicle.motors import MotorError, Motors, MotorSettingsError
from vehicle.motors.drivers import DRIVERS, open_motors, profile_params, safe_stop
from vehicle.motors.gpio import GpioMotors, GpioSettings, PhaseEnable, TwoInputs
from vehicle.motors.pins import translated

TWO_INPUTS = GpioSettings(bridges=(TwoInputs(10, 9), TwoInputs(8, 7)))
ENABLED_INPUTS = GpioSettings(bridges=(TwoInputs(23, 24, enable=12), TwoInputs(27, 22, enable=13)))
PHASE_ENABLE = GpioSettings(bridges=(PhaseEnable(enable=12, phase=5), PhaseEnable(enable=13, phase=6)))


@pytest.fixture
def factory() -> Iterator[MockFactory]:
    """The pins of this test, also for what opens a driver by its name."""
    before, Device.pin_factory = Device.pin_factory, MockFactory(pin_class=MockPWMPin)
    yield Device.pin_factory
    Device.pin_factory.reset()
    Device.pin_factory = before


def output(factory: MockFactory, bridge: TwoInputs | PhaseEnable) -> float:
    """What a motor at this bridge gets."""
    first, second, *enable = (float(factory.pin(pin).state) for pin in astuple(bridge) if pin is not None)
    if isinstance(bridge, TwoInputs):
        assert first == 0.0 or second == 0.0, "both inputs of a bridge are high"
        return (first - second) * (enable[0] if enable else 1.0)
    return first * (-1.0 if second else 1.0)


def bench_of(factory: MockFactory, motors: Any, settings: GpioSettings, core: Any = None) -> Bench:
    core = core or motors
    return Bench(motors, lambda: [output(factory, bridge) for bridge in settings.bridges], lambda: core.enabled)


class TestGpioMotors(MotorsContract):
    @pytest.fixture(
        params=[TWO_INPUTS, ENABLED_INPUTS, PHASE_ENABLE], ids=["two inputs", "inputs and enable", "phase and enable"]
    )
    def bench(self, request: pytest.FixtureRequest, factory: MockFactory) -> Bench:
        return bench_of(factory, GpioMotors(request.param), request.param)


@pytest.mark.parametrize(
    ("settings", "pwm"),
    [(TWO_INPUTS, (10, 9, 8, 7)), (ENABLED_INPUTS, (12, 13)), (PHASE_ENABLE, (12, 13))],
)
def test_the_pwm_pins_have_the_frequency(factory: MockFactory, settings: GpioSettings, pwm: tuple[int, ...]) -> None:
    motors = GpioMotors(settings)
    assert [factory.pin(pin).frequency for pin in pwm] == [500.0] * len(pwm)
    motors.close()


def test_enabling_begins_with_low_inputs_in_any_case(factory: MockFactory) -> None:
    motors = GpioMotors(TWO_INPUTS)
    factory.pin(10).state = 1.0
    motors.enable()
    assert output(factory, TwoInputs(10, 9)) == 0.0
    motors.close()


def levels(factory: MockFactory, *pins: int) -> list[float]:
    """What these pins have now."""
    return [float(factory.pin(pin).state) for pin in pins]


@pytest.mark.parametrize(
    "end", [GpioMotors.disable, GpioMotors.close, lambda motors: motors.set([0.0, 0.0])], ids=["disable", "close", "0"]
)
def test_enable_and_inputs_are_low_while_silent(factory: MockFactory, end: Callable[[GpioMotors], None]) -> None:
    motors = GpioMotors(ENABLED_INPUTS)
    assert levels(factory, 12, 23, 24, 13, 27, 22) == [0.0] * 6
    motors.enable()
    motors.set([0.5, -0.7])
    assert levels(factory, 12, 23, 24, 13, 27, 22) == pytest.approx([0.5, 1.0, 0.0, 0.7, 0.0, 1.0], abs=1e-3)
    end(motors)
    assert levels(factory, 12, 23, 24, 13, 27, 22) == [0.0] * 6
    motors.close()


def test_enable_is_low_while_the_direction_changes(factory: MockFactory) -> None:
    class Seen(MockPWMPin):  # type: ignore[misc]  # gpiozero has no types
        """A pin that notes what enable has whenever an input changes."""

        enable: ClassVar[list[float]] = []

        def _change_state(self, value: float) -> bool:
            if self.info.name in ("GPIO23", "GPIO24"):
                self.enable.append(float(factory.pin(12).state))
            return bool(super()._change_state(value))

    factory.pin_class = Seen
    motors = GpioMotors(ENABLED_INPUTS)
    motors.enable()
    motors.set([0.5, 0.0])
    motors.set([0.6, 0.0])
    assert levels(factory, 12) == pytest.approx([0.6], abs=1e-3)
    Seen.enable.clear()
    motors.set([-0.6, 0.0])
    assert levels(factory, 12, 23, 24) == pytest.approx([0.6, 0.0, 1.0], abs=1e-3)
    assert len(Seen.enable) >= 2
    assert set(Seen.enable) == {0.0}
    motors.close()


def test_pins_are_let_go_by_close(factory: MockFactory) -> None:
    for settings in (TWO_INPUTS, ENABLED_INPUTS) * 2:
        GpioMotors(settings).close()


def test_a_pin_in_use_is_named_in_one_line_and_others_are_freed(factory: MockFactory) -> None:
    other = GpioMotors(GpioSettings(bridges=(TwoInputs(8, 6),)))
    with pytest.raises(MotorError, match="GPIO8") as caught:
        GpioMotors(TWO_INPUTS)
    assert "\n" not in str(caught.value)
    with pytest.raises(MotorError, match="GPIO8"):
        GpioMotors(GpioSettings(bridges=(TwoInputs(10, 8, enable=9),)))
    other.close()
    GpioMotors(TWO_INPUTS).close()


def test_without_a_raspberry_pi_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Device, "pin_factory", None)
    monkeypatch.setenv("GPIOZERO_PIN_FACTORY", "nothing")
    with pytest.raises(MotorError, match="motor pins: Unable to find pin factory"):
        GpioMotors(TWO_INPUTS)


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (PinUnknownPi("unable to locate Pi revision in /proc/device-tree or /proc/cpuinfo"), "is this a Raspberry Pi"),
        (OSError("can not open gpiochip"), "sudo usermod -aG gpio"),
        (ModuleNotFoundError("No module named 'lgpio'"), r"python\S* -m pip install 'mavhelm\[pi\]'"),
    ],
)
def test_what_to_do_is_said_where_it_is_known(error: Exception, says: str) -> None:
    with pytest.raises(MotorError, match=f"^motor pins: {error}; .*{says}"), translated("motor pins"):
        raise error


def article_car() -> Motors:
    return open_motors("article-car")


def driven(sticks: tuple[float, float], driver: str, kept: dict[str, float] | None = None) -> tuple[float, ...]:
    """What the vehicle's motors get once throttle and steering were held for a while."""
    params, _ = merge_params({"MAN_DEADBAND": 0}, kept=kept or {}, usual=profile_params(driver))
    drive = Drive(params, 0.0)
    clearance = Clearance(armed=True, held=False, neutral_seen=True, demand_age=0.0, timeout=1.0)
    return drive.update(Demand(*sticks, 0.0, 255, 0), clearance, limited=False, now=10.0).throttles


class TestArticleCar:
    """The car of the articles, on its own wires: BCM 10, 9 left and 8, 7 right."""

    @pytest.mark.parametrize(
        ("sticks", "pins"),
        [
            ((1.0, 0.0), {10: 0.6, 9: 0.0, 8: 0.6, 7: 0.0}),
            ((-1.0, 0.0), {10: 0.0, 9: 0.6, 8: 0.0, 7: 0.6}),
            ((0.0, -1.0), {10: 0.0, 9: 0.4, 8: 0.4, 7: 0.0}),
            ((0.0, 1.0), {10: 0.4, 9: 0.0, 8: 0.0, 7: 0.4}),
            ((0.5, 0.0), {10: 0.3, 9: 0.0, 8: 0.3, 7: 0.0}),
            ((0.5, 0.5), {10: 0.5, 9: 0.0, 8: 0.0, 7: 0.0}),
            ((0.0, 0.0), {10: 0.0, 9: 0.0, 8: 0.0, 7: 0.0}),
        ],
        ids=["forward", "backward", "left", "right", "half forward", "curve", "stop"],
    )
    def test_does_what_its_own_program_did(
        self, factory: MockFactory, sticks: tuple[float, float], pins: dict[int, float]
    ) -> None:
        motors = article_car()
        motors.enable()
        motors.set(driven(sticks, "article-car"))
        assert {pin: factory.pin(pin).state for pin in pins} == pytest.approx(pins, abs=1e-3)
        assert [factory.pin(pin).frequency for pin in pins] == [2000.0] * 4

    def test_is_in_the_table(self) -> None:
        assert DRIVERS["article-car"].path == DRIVERS["gpio"].path

    def test_the_full_power_of_its_motors_is_a_matter_of_parameters(self, factory: MockFactory) -> None:
        motors = article_car()
        motors.enable()
        motors.set(driven((1.0, 0.0), "article-car", {"MOT1_MAX": 100.0, "MOT2_MAX": 80.0}))
        assert [factory.pin(pin).state for pin in (10, 8)] == pytest.approx([1.0, 0.8])

    def test_one_setting_can_be_replaced(self, factory: MockFactory) -> None:
        motors = open_motors("article-car", {"frequency": 500.0})
        motors.enable()
        assert factory.pin(10).frequency == 500.0


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({}, "needs settings, at least bridges"),
        ({"bridges": []}, "bridges: Expected `array` of length >= 1"),
        ({"bridges": [{"wiring": "two-inputs", "forward": 10}]}, "missing required field `backward`"),
        ({"bridges": [{"wiring": "two-inputs", "forward": 10, "backward": 28}]}, "backward: Expected `int` <= 27"),
        ({"bridges": [{"wiring": "two-inputs", "forward": 10, "backward": 10}]}, "10 is used twice"),
        ({"bridges": [{"wiring": "two-inputs", "forward": 10, "backward": 9, "enable": 9}]}, "9 is used twice"),
        ({"bridges": [{"wiring": "three", "forward": 10, "backward": 9}]}, "Invalid value 'three'"),
        ({"bridges": [{"forward": 10, "backward": 9}]}, "missing required field `wiring`"),
        ({"frequenzy": 500, "bridges": [{"wiring": "two-inputs", "forward": 1, "backward": 9}]}, "frequenzy"),
        ({"frequency": 20_000}, "frequency: Expected `float` <= 10000"),
    ],
)
def test_settings_are_read_strictly(factory: MockFactory, settings: dict[str, Any], says: str) -> None:
    with pytest.raises(MotorSettingsError) as caught:
        open_motors("gpio", settings)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)


def test_safe_stop_pulls_down_enable_of_a_killed_process(factory: MockFactory) -> None:
    for number in (12, 23):
        pin = factory.pin(number)
        pin.function = "output"
        pin.state = 1.0
    assert output(factory, ENABLED_INPUTS.bridges[0]) == 1.0
    bridges = [{"wiring": "two-inputs", "forward": 23, "backward": 24, "enable": 12}]
    assert safe_stop("gpio", {"bridges": bridges}) == []
    assert [factory.pin(pin).states[-1].state for pin in (12, 23, 24)] == [0.0] * 3


def test_safe_stop_pulls_down_pins_that_killed_process_left_high(factory: MockFactory) -> None:
    for number in (10, 7):
        pin = factory.pin(number)
        pin.function = "output"
        pin.state = 1.0
    assert output(factory, TwoInputs(10, 9)) == 1.0
    factory.pin(10).clear_states()
    assert safe_stop("article-car") == []
    assert [factory.pin(pin).states[-1].state for pin in (10, 9, 8, 7)] == [0.0] * 4
    assert all(state.state == 0.0 for state in factory.pin(10).states[1:])
