from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from gpiozero import Device
from gpiozero.pins.mock import MockFactory

from tests.vehicle.motors.contract import Bench, MotorsContract
from tests.vehicle.motors.fake_sysfs import FakeSysfs
from vehicle.motors import MotorError, MotorSettingsError
from vehicle.motors.drivers import open_motors, safe_stop
from vehicle.motors.pulses import Pulse
from vehicle.motors.pwm_channel import export_channel
from vehicle.motors.sysfs_pwm import BridgePwm, ServoPwm, SysfsPwmMotors, SysfsPwmSettings

DEVICE = "fe20c000.pwm"
BRIDGES = SysfsPwmSettings(outputs=(BridgePwm(DEVICE, 0, 5), BridgePwm(DEVICE, 1, 6)))
SERVOS = SysfsPwmSettings(outputs=(ServoPwm(DEVICE, 0), ServoPwm(DEVICE, 1, Pulse(1100, 1480, 1900))))
SILENT = SysfsPwmSettings(outputs=SERVOS.outputs, idle="off")


@pytest.fixture
def sysfs(tmp_path: Path) -> FakeSysfs:
    return FakeSysfs(tmp_path)


@pytest.fixture
def pins() -> MockFactory:
    return MockFactory()


def opened(settings: SysfsPwmSettings, sysfs: FakeSysfs, pins: MockFactory) -> SysfsPwmMotors:
    return SysfsPwmMotors(settings, root=sysfs.root, write=sysfs.write, pin_factory=pins)


def output(sysfs: FakeSysfs, pins: MockFactory, wanted: BridgePwm | ServoPwm) -> float:
    """What the motor at this output gets."""
    width = sysfs.pulse(wanted.channel)
    if width is None:
        return 0.0
    if isinstance(wanted, BridgePwm):
        return width * wanted.frequency * (-1 if pins.pin(wanted.direction).state else 1)
    offset = width * 1e6 - wanted.pulse.trim_us
    side = wanted.pulse.max_us - wanted.pulse.trim_us if offset >= 0 else wanted.pulse.trim_us - wanted.pulse.min_us
    return offset / side


def bench_of(settings: SysfsPwmSettings, sysfs: FakeSysfs, pins: MockFactory) -> Bench:
    motors = opened(settings, sysfs, pins)
    return Bench(
        motors,
        lambda: [output(sysfs, pins, wanted) for wanted in settings.outputs],
        lambda: motors.enabled,
        tolerance=1e-4,
    )


class TestBridges(MotorsContract):
    """Enabled is what sysfs says."""

    @pytest.fixture
    def bench(self, sysfs: FakeSysfs, pins: MockFactory) -> Bench:
        bench = bench_of(BRIDGES, sysfs, pins)
        bench.enabled = lambda: [sysfs.value(number, "enable") for number in (0, 1)] == [1, 1]
        return bench


class TestServos(MotorsContract):
    @pytest.fixture
    def bench(self, sysfs: FakeSysfs, pins: MockFactory) -> Bench:
        return bench_of(SERVOS, sysfs, pins)


class TestServosWithoutIdlePulses(MotorsContract):
    @pytest.fixture
    def bench(self, sysfs: FakeSysfs, pins: MockFactory) -> Bench:
        bench = bench_of(SILENT, sysfs, pins)
        bench.enabled = lambda: [sysfs.value(number, "enable") for number in (0, 1)] == [1, 1]
        return bench


def test_the_chip_is_found_by_its_device_and_not_by_its_number(sysfs: FakeSysfs, pins: MockFactory) -> None:
    opened(BRIDGES, sysfs, pins)
    assert (sysfs.root / "pwmchip2" / "pwm1").is_dir()
    assert not (sysfs.root / "pwmchip0" / "pwm0").exists()


def test_a_missing_device_is_said_with_those_that_are_there(sysfs: FakeSysfs, pins: MockFactory) -> None:
    settings = SysfsPwmSettings(outputs=(ServoPwm("1f00098000.pwm", 0),))
    with pytest.raises(MotorError, match=r"no device '1f00098000.pwm'; there is 107d517a80.pwm, fe20c000.pwm"):
        opened(settings, sysfs, pins)


def test_no_chip_at_all_points_at_the_overlay(tmp_path: Path, pins: MockFactory) -> None:
    with pytest.raises(MotorError, match="pwm-2chan is missing"):
        SysfsPwmMotors(SERVOS, root=tmp_path, pin_factory=pins)


def test_a_channel_that_the_chip_lacks_is_said(sysfs: FakeSysfs, pins: MockFactory) -> None:
    settings = SysfsPwmSettings(outputs=(ServoPwm(DEVICE, 2),))
    with pytest.raises(MotorError, match=r"fe20c000.pwm has 2 channels, 0 to 1"):
        opened(settings, sysfs, pins)


def test_period_and_neutral_pulse_are_set_before_output_is_on(sysfs: FakeSysfs, pins: MockFactory) -> None:
    motors = opened(SERVOS, sysfs, pins)
    assert sysfs.value(0, "period") == 20_000_000
    assert sysfs.pulse(0) is None
    sysfs.writes.clear()
    motors.enable()
    assert sysfs.writes == [("duty_cycle", 1_500_000), ("enable", 1), ("duty_cycle", 1_480_000), ("enable", 1)]


def test_a_bridge_turns_round_with_no_duty_on_it(sysfs: FakeSysfs, pins: MockFactory) -> None:
    motors = opened(BRIDGES, sysfs, pins)
    motors.enable()
    motors.set((0.5, 0.5))
    sysfs.writes.clear()
    pins.pin(5).clear_states()
    motors.set((-0.5, 0.5))
    assert sysfs.writes == [("duty_cycle", 0), ("duty_cycle", 25_000), ("duty_cycle", 25_000)]
    assert pins.pin(5).state


def test_another_period_is_replaced_with_no_duty_on_it(sysfs: FakeSysfs, pins: MockFactory) -> None:
    """The kernel takes no period that is shorter than the duty."""
    killed = opened(SysfsPwmSettings(outputs=(ServoPwm(DEVICE, 0),)), sysfs, pins)
    killed.enable()
    killed.set((1.0,))
    assert sysfs.pulse(0) == pytest.approx(0.002)
    opened(SysfsPwmSettings(outputs=(BridgePwm(DEVICE, 0, 5),)), sysfs, pins)
    assert sysfs.value(0, "period") == 50_000
    assert sysfs.pulse(0) is None


def test_a_running_servo_gets_another_period_with_no_pulse_on_it(sysfs: FakeSysfs, pins: MockFactory) -> None:
    killed = opened(SERVOS, sysfs, pins)
    killed.enable()
    killed.set((1.0, 1.0))
    sysfs.writes.clear()
    opened(SysfsPwmSettings(outputs=(ServoPwm(DEVICE, 0, frequency=100),)), sysfs, pins)
    assert sysfs.writes == [("duty_cycle", 0), ("period", 10_000_000), ("duty_cycle", 1_500_000)]


@pytest.mark.parametrize(("idle", "after"), [("neutral", 0.0015), ("off", None)])
def test_safe_stop_ends_the_pulses_of_a_killed_process(
    idle: str, after: float | None, sysfs: FakeSysfs, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("vehicle.motors.pwm_channel.ROOT", sysfs.root)
    monkeypatch.setattr("vehicle.motors.pwm_channel.write_file", sysfs.write)
    outputs = [{"drives": "servo", "device": DEVICE, "channel": channel} for channel in (0, 1)]
    killed = open_motors("sysfs-pwm", {"outputs": outputs, "idle": idle})
    killed.enable()
    killed.set((1.0, -1.0))
    assert (sysfs.pulse(0), sysfs.pulse(1)) == pytest.approx((0.002, 0.001))
    assert safe_stop("sysfs-pwm", {"outputs": outputs, "idle": idle}) == []
    assert [sysfs.pulse(0), sysfs.pulse(1)] == [after, after]


def test_safe_stop_ends_the_duty_of_a_killed_process(sysfs: FakeSysfs, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vehicle.motors.pwm_channel.ROOT", sysfs.root)
    monkeypatch.setattr("vehicle.motors.pwm_channel.write_file", sysfs.write)
    monkeypatch.setattr(Device, "pin_factory", MockFactory())
    killed = opened(BRIDGES, sysfs, MockFactory())
    killed.enable()
    killed.set((1.0, 1.0))
    assert sysfs.pulse(0) == pytest.approx(50e-6)
    outputs = [{"drives": "bridge", "device": DEVICE, "channel": n, "direction": 5 + n} for n in (0, 1)]
    assert safe_stop("sysfs-pwm", {"outputs": outputs}) == []
    assert [sysfs.pulse(0), sysfs.pulse(1)] == [None, None]


def test_disable_tries_every_output_and_says_what_failed(sysfs: FakeSysfs, pins: MockFactory) -> None:
    motors = opened(BRIDGES, sysfs, pins)
    motors.enable()
    motors.set((1.0, 1.0))
    sysfs.refusing = "duty_cycle"
    with pytest.raises(MotorError, match="duty_cycle: Invalid argument"):
        motors.disable()
    assert [sysfs.value(number, "enable") for number in (0, 1)] == [0, 0]


@pytest.mark.parametrize(
    ("outputs", "says"),
    [
        ([], "length >= 1"),
        ([{"drives": "servo", "device": DEVICE, "channel": 0}] * 2, "a channel is used twice"),
        ([{"drives": "bridge", "device": DEVICE, "channel": 0}], "missing required field `direction`"),
        (
            [{"drives": "servo", "device": DEVICE, "channel": 0, "frequency": 400, "pulse": {"max_us": 2450}}],
            "does not fit into 400 Hz",
        ),
        ([{"drives": "lamp", "device": DEVICE, "channel": 0}], "Invalid value 'lamp'"),
    ],
)
def test_settings_are_read_strictly(outputs: list[Any], says: str) -> None:
    with pytest.raises(MotorSettingsError) as caught:
        open_motors("sysfs-pwm", {"outputs": outputs})
    assert says in str(caught.value)


def test_an_exported_channel_is_waited_for_until_it_is_writable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers = iter([False, False, True])
    asked: list[Path] = []

    def access(path: Path, mode: int) -> bool:
        asked.append(path)
        return next(answers)

    monkeypatch.setattr("vehicle.motors.pwm_channel.os.access", access)
    export_channel(FakeSysfs(tmp_path).root, DEVICE, 1, lambda path, text: None)
    assert [path.name for path in asked] == ["enable"] * 3
