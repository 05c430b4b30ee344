from __future__ import annotations

from typing import Any

import pytest

from tests.vehicle.motors.contract import Bench, MotorsContract
from tests.vehicle.motors.fake_pca9685 import ADDRESS, FakePca9685
from vehicle.motors import MotorError, MotorSettingsError
from vehicle.motors.drivers import open_motors, safe_stop
from vehicle.motors.pca9685 import Pca9685Channel, Pca9685Motors, Pca9685Settings
from vehicle.motors.pulses import Pulse

STEP = 122 / 25e6
"""s, 4.88 us."""
NARROW = Pulse(min_us=1100, trim_us=1480, max_us=1900)
SETTINGS = Pca9685Settings(channels=(Pca9685Channel(0), Pca9685Channel(15, NARROW)))
SILENT = Pca9685Settings(channels=SETTINGS.channels, idle="off")


def throttle(width: float | None, pulse: Pulse) -> float:
    """What an ESC with this range makes of a pulse; without pulses it stands."""
    if width is None:
        return 0.0
    offset = width * 1e6 - pulse.trim_us
    return offset / (pulse.max_us - pulse.trim_us if offset >= 0 else pulse.trim_us - pulse.min_us)


def bench_of(fake: FakePca9685, settings: Pca9685Settings) -> Bench:
    motors = Pca9685Motors(settings, bus=fake)
    return Bench(
        motors,
        lambda: [throttle(fake.pulse(channel.channel), channel.pulse) for channel in settings.channels],
        lambda: motors.enabled,
        tolerance=STEP * 1e6 / 380,
    )


class TestPca9685Motors(MotorsContract):
    """With neutral pulses while disabled: what the ESC makes of the wire is the same."""

    @pytest.fixture
    def bench(self) -> Bench:
        return bench_of(FakePca9685(), SETTINGS)


class TestPca9685MotorsWithoutIdlePulses(MotorsContract):
    """Here enabled is what the chip says: there are pulses."""

    @pytest.fixture
    def bench(self) -> Bench:
        fake = FakePca9685()
        bench = bench_of(fake, SILENT)
        bench.enabled = lambda: fake.pulse(0) is not None and fake.pulse(15) is not None
        return bench


@pytest.mark.parametrize(
    ("value", "steps"),
    [(-1.0, (205, 225)), (-0.5, (256, 264)), (0.0, (307, 303)), (0.25, (333, 325)), (1.0, (410, 389))],
)
def test_the_pulses_are_exact_to_one_step(value: float, steps: tuple[int, int]) -> None:
    """1000 us is 204.9 steps of 4.88 us, 1500 is 307.4, 2000 is 409.8; 1100, 1480, 1900 are 225.4, 303.3, 389.3."""
    fake = FakePca9685()
    motors = Pca9685Motors(SETTINGS, bus=fake)
    motors.enable()
    motors.set((value, value))
    assert (fake.pulse(0), fake.pulse(15)) == pytest.approx((steps[0] * STEP, steps[1] * STEP), abs=1e-9)


def test_the_frequency_is_50_hz_as_near_as_the_chip_can() -> None:
    fake = FakePca9685()
    Pca9685Motors(SETTINGS, bus=fake)
    assert fake.registers[0xFE] == 121
    assert fake.frequency == pytest.approx(50.03, abs=0.01)
    assert fake.registers[0] & 0x01 == 0, "all-call is on"


def test_a_measured_oscillator_makes_up_for_a_slow_chip() -> None:
    settings = Pca9685Settings(channels=(Pca9685Channel(0),), oscillator=24e6)
    assert settings.prescale == 116
    assert settings.step == pytest.approx(117 / 24e6)


def test_opening_gives_no_pulse_and_enabling_gives_neutral_first() -> None:
    fake = FakePca9685()
    motors = Pca9685Motors(SETTINGS, bus=fake)
    assert (fake.pulse(0), fake.pulse(15)) == (None, None)
    fake.writes.clear()
    motors.enable()
    assert fake.writes == [(6, [0, 0, 307 & 0xFF, 1]), (66, [0, 0, 303 & 0xFF, 1])]


@pytest.mark.parametrize(("settings", "after"), [(SETTINGS, 307 * STEP), (SILENT, None)])
def test_disabled_and_closed_is_neutral_or_nothing(settings: Pca9685Settings, after: float | None) -> None:
    fake = FakePca9685()
    motors = Pca9685Motors(settings, bus=fake)
    motors.enable()
    motors.set((1.0, 1.0))
    assert fake.pulse(0) == pytest.approx(410 * STEP)
    motors.disable()
    assert fake.pulse(0) == (after and pytest.approx(after))
    motors.close()
    assert fake.pulse(0) == (after and pytest.approx(after))
    assert fake.closed


class Watched(FakePca9685):
    """Remembers what comes out of channel 0 after each write."""

    def __init__(self) -> None:
        super().__init__()
        self.seen: list[float | None] = []

    def _write(self, register: int, value: int) -> None:
        super()._write(register, value)
        if register != 8:  # the low byte of a width: the chip takes both together, at the end of the transfer
            self.seen.append(self.pulse(0))


@pytest.mark.parametrize("frequency", [60, 100])
def test_another_frequency_in_the_file_keeps_the_neutral_width(frequency: float) -> None:
    fake = Watched()
    before = Pca9685Motors(SETTINGS, bus=fake)
    before.enable()
    before.close()
    assert fake.pulse(0) == pytest.approx(1.5e-3, abs=STEP)
    fake.seen, fake.closed = [], False
    motors = Pca9685Motors(Pca9685Settings(channels=SETTINGS.channels, frequency=frequency), bus=fake)
    motors.enable()
    assert fake.frequency == pytest.approx(frequency, rel=0.01)
    assert all(width is None or width == pytest.approx(1.5e-3, abs=STEP) for width in fake.seen)
    assert fake.pulse(0) is not None


@pytest.mark.parametrize("idle", ["neutral", "off"])
def test_safe_stop_ends_the_pulses_of_a_killed_process(idle: str, monkeypatch: pytest.MonkeyPatch) -> None:
    fake = FakePca9685()
    monkeypatch.setattr("vehicle.motors.pca9685_board.open_bus", lambda number: fake)
    settings = {"channels": [{"channel": 0}, {"channel": 1}], "idle": idle}
    killed = open_motors("pca9685", settings)
    killed.enable()
    killed.set((1.0, -1.0))
    assert fake.pulse(0) == pytest.approx(410 * STEP)
    assert safe_stop("pca9685", settings) == []
    wanted = None if idle == "off" else pytest.approx(307 * STEP)
    assert [fake.pulse(0), fake.pulse(1)] == [wanted, wanted]


def test_a_glitch_of_the_bus_passes_and_a_dead_one_does_not() -> None:
    fake, times = FakePca9685(), iter((0.0, 0.02, 0.04, 0.06, 0.08))
    motors = Pca9685Motors(SETTINGS, bus=fake, clock=times.__next__)
    motors.enable()
    fake.failing = 2
    motors.set((0.5, 0.5))
    motors.set((0.5, 0.5))
    motors.set((0.5, 0.5))
    assert fake.pulse(0) == pytest.approx(359 * STEP)
    fake.failing = 99
    motors.set((0.6, 0.6))
    motors.set((0.6, 0.6))
    with pytest.raises(MotorError, match="PCA9685 at 0x40 on I2C bus 1: Remote I/O error"):
        motors.set((0.6, 0.6))


def test_slow_failures_end_after_a_fifth_of_a_second() -> None:
    fake, times = FakePca9685(), iter((0.0, 0.21))
    motors = Pca9685Motors(SETTINGS, bus=fake, clock=times.__next__)
    motors.enable()
    fake.failing = 99
    motors.set((0.6, 0.6))
    with pytest.raises(MotorError, match="Remote I/O"):
        motors.set((0.6, 0.6))


def test_disable_reports_deaf_chip_and_works_when_it_hears_again() -> None:
    fake = FakePca9685()
    motors = Pca9685Motors(SETTINGS, bus=fake)
    motors.enable()
    motors.set((1.0, 1.0))
    fake.failing = 99
    with pytest.raises(MotorError):
        motors.disable()
    fake.failing = 2
    motors.disable()
    assert fake.pulse(0) == pytest.approx(307 * STEP)


def test_a_chip_that_lost_power_is_set_up_again_before_enabling() -> None:
    fake = FakePca9685()
    motors = Pca9685Motors(SETTINGS, bus=fake)
    fake.lose_power()
    motors.enable()
    assert fake.registers[0xFE] == 121
    assert fake.pulse(0) == pytest.approx(307 * STEP)


def test_something_else_at_the_address_is_refused() -> None:
    class NoPca(FakePca9685):
        def read_byte_data(self, i2c_addr: int, register: int) -> int:
            return 0x5A

    fake = NoPca()
    with pytest.raises(MotorError, match="wrote mode and prescale"):
        Pca9685Motors(SETTINGS, bus=fake)
    assert fake.closed


def test_no_board_is_said_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("vehicle.motors.pca9685_board.open_bus", lambda number: FakePca9685())
    with pytest.raises(
        MotorError, match=r"PCA9685 at 0x41 on I2C bus 1: Remote I/O error: no response; .* `i2cdetect -y 1`"
    ):
        open_motors("pca9685", {"channels": [{"channel": 0}], "address": ADDRESS + 1})


def test_no_bus_is_said_in_one_line() -> None:
    with pytest.raises(
        MotorError,
        match=r"I2C bus 99: .*No such file or directory: no such bus; on a Pi `sudo raspi-config nonint do_i2c 0`",
    ):
        open_motors("pca9685", {"channels": [{"channel": 0}], "bus": 99})


@pytest.mark.parametrize(
    ("settings", "says"),
    [
        ({"channels": [{"channel": 16}]}, "Expected `int` <= 15"),
        ({"channels": [{"channel": 1}, {"channel": 1}]}, "1 is used twice"),
        ({"channels": [{"channel": 1, "pulse": {"trim_us": 2100}}]}, "min 1000 <= trim 2100 < max 2000 us must hold"),
        ({"channels": [{"channel": 1, "pulse": {"max_us": 2450}}], "frequency": 400}, "does not fit into 400 Hz, 2500"),
        ({"channels": [{"channel": 1}], "idle": "full"}, "Invalid enum value 'full'"),
        ({"channels": [{"channel": 1}], "frequency": 1600}, "Expected `float` <= 400"),
    ],
)
def test_settings_are_read_strictly(settings: dict[str, Any], says: str) -> None:
    with pytest.raises(MotorSettingsError) as caught:
        open_motors("pca9685", settings)
    assert says in str(caught.value)
