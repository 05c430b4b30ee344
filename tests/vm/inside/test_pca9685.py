"""The PCA9685 driver through smbus2 and the kernel's i2c-dev; i2c-stub keeps the registers as the chip would."""

from __future__ import annotations

from pathlib import Path

import pytest

from dialects.axes import Axes
from tests.vehicle.ground import Ground
from tests.vm.inside.header import PCA9685, drive, pulse, rover, safe_stop, write_config
from tests.waits import PATIENCE

NEUTRAL, FULL = 1500.0, 2000.0
STEP = 5.0
"""us, one step of the chip."""


def both(width: float) -> bool:
    """Return whether both motors get pulses of this width, us."""
    return all(pulse(channel) == pytest.approx(width, abs=STEP) for channel in (0, 1))


def test_pulses_follow_the_demand_and_end_in_neutral(tmp_path: Path) -> None:
    with Ground() as ground, rover(write_config(tmp_path, ground.endpoint, PCA9685)):
        drive(ground)
        ground.wait(lambda: both(FULL), "full pulses")
        ground.demand = Axes(throttle=-1.0)
        ground.wait(lambda: all(pulse(channel) < NEUTRAL - 100 for channel in (0, 1)), "pulses for reverse")
        ground.demand = Axes()
        ground.wait(lambda: both(NEUTRAL), "neutral pulses")


def test_chip_repeats_its_pulses_after_kill_9_until_safe_stop(tmp_path: Path) -> None:
    with Ground() as ground:
        config = write_config(tmp_path, ground.endpoint, PCA9685)
        with rover(config) as process:
            drive(ground)
            ground.wait(lambda: both(FULL), "full pulses")
            process.kill()
            process.wait(PATIENCE)
            assert both(FULL), "the chip has no timeout"
            assert "pca9685: motors neutral" in safe_stop(config)
            assert both(NEUTRAL) or not any(pulse(channel) for channel in (0, 1))
