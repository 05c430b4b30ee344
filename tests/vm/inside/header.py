"""The pins and the I2C bus of the virtual machine as something outside of it sees them, and a rover that uses them."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from smbus2 import SMBus

from dialects.axes import Axes
from tests.vehicle.ground import PATIENT_LOOP, Ground
from tests.waits import PATIENCE

LINES = Path("/sys/devices/platform/gpio-sim.0/gpiochip0")
FORWARD, BACKWARD = (10, 8), (9, 7)
"""Of the article's car."""
ESTOP, ENABLE = 17, 22
BUS = 0
ADDRESS = 0x40
LED0_ON_L, FULL_OFF = 0x06, 0x10
PERIOD = 20_000.0
"""us of 50 Hz."""
MANY = 60
"""Samples of a pin: more than a period of its PWM."""
PARAMS = "[params]\nMOT1_MAX = 100\nMOT2_MAX = 100\n{} = {}\n".format(*PATIENT_LOOP.split("="))
GPIO = '[motors]\ndriver = "article-car"\n'
GUARDED = f"{GPIO}safety = {{ estop_pin = {ESTOP}, enable_pin = {ENABLE} }}\n"
PCA9685 = f'[motors]\ndriver = "pca9685"\nbus = {BUS}\nchannels = [{{ channel = 0 }}, {{ channel = 1 }}]\n'


def level(pin: int) -> int:
    """Return 1 if the pin is high."""
    return int((LINES / f"sim_gpio{pin}/value").read_text())


def duty(pin: int) -> float:
    """Return the share of time in which the pin is high, 0..1."""
    return sum(level(pin) for _ in range(MANY)) / MANY


def button(pin: int, *, pressed: bool) -> None:
    """Open or close a contact to ground. A program that opens the pin sets it high, by the pull-up that it asks for."""
    (LINES / f"sim_gpio{pin}/pull").write_text("pull-up" if pressed else "pull-down")


def ahead() -> bool:
    """Return whether both motors of the article's car are driven forward at this moment."""
    return all(map(level, FORWARD)) and not any(map(level, BACKWARD))


def silent() -> bool:
    """Return whether all inputs of both H-bridges are low, for as long as PWM could hide a pulse."""
    return not any(level(pin) for _ in range(MANY) for pin in (*FORWARD, *BACKWARD))


def registers(first: int, count: int) -> list[int]:
    """Return registers of the PCA9685, read by a process other than the one that drives."""
    with SMBus(BUS) as bus:
        return [int(value) for value in bus.read_i2c_block_data(ADDRESS, first, count)]


def until(condition: Callable[[], bool], what: str) -> None:
    """Look again and again until `condition`."""
    deadline = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < deadline, f"not within {PATIENCE:g} s: {what}"


def write_config(folder: Path, endpoint: str, motors: str) -> Path:
    """Write a settings file."""
    path = folder / "rover.toml"
    path.write_text(f'endpoints = ["{endpoint}"]\n\n{motors}\n{PARAMS}')
    return path


@contextlib.contextmanager
def rover(config: Path, *words: str) -> Iterator[subprocess.Popen[str]]:
    """Run `mavhelm vehicle --config FILE` until the end of the test."""
    with (config.parent / "vehicle.err").open("a") as errors:
        process = subprocess.Popen(
            [sys.executable, "-m", "vehicle", "--config", str(config), *words], stderr=errors, text=True
        )
    try:
        yield process
    finally:
        process.kill()
        process.wait(PATIENCE)
        print((config.parent / "vehicle.err").read_text())


def safe_stop(config: Path) -> str:
    """Run `mavhelm vehicle safe-stop`; return what it prints."""
    command = [sys.executable, "-m", "vehicle", "safe-stop", "--config", str(config)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stderr


def pulse(channel: int) -> float:
    """Return the width of a channel's pulse in us at 50 Hz; 0 while it has none."""
    on_low, on_high, off_low, off_high = registers(LED0_ON_L + 4 * channel, 4)
    if off_high & FULL_OFF:
        return 0.0
    steps = (off_low | off_high << 8) - (on_low | on_high << 8)
    return steps % 4096 * PERIOD / 4096


def drive(ground: Ground, throttle: float = 1.0) -> None:
    """Arm and demand a throttle from now on."""
    ground.arm()
    ground.demand = Axes(throttle=throttle)
