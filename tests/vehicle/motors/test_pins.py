"""What really reaches lgpio: gpiozero's own lgpio pins, with lgpio's functions on the chip replaced by a record."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from gpiozero import Device

import vehicle.motors.pins  # noqa: F401 - before lgpio: see test_it_leaves_nothing_in_the_working_directory
from vehicle.motors import Motors
from vehicle.motors.drivers import open_motors

lgpio = pytest.importorskip("lgpio")
OUTPUT = 1 << 1


class Chip:
    """/dev/gpiochip0, as far as motors need it."""

    def __init__(self) -> None:
        self.pwm: dict[int, tuple[float, float]] = {}
        """Pin -> Hz, percent."""
        self.outputs: set[int] = set()

    def install(self, monkeypatch: pytest.MonkeyPatch) -> None:
        replaced = {
            "gpiochip_open": lambda chip: 7,
            "gpiochip_close": lambda handle: None,
            "gpio_claim_input": lambda handle, pin, flags=0: self.outputs.discard(pin),
            "gpio_claim_output": lambda handle, pin: self.outputs.add(pin),
            "gpio_free": lambda handle, pin: None,
            "gpio_get_mode": lambda handle, pin: OUTPUT if pin in self.outputs else 0,
            "tx_pwm": self._tx_pwm,
        }
        for name, function in replaced.items():
            monkeypatch.setattr(lgpio, name, function)

    def _tx_pwm(self, handle: int, pin: int, frequency: float, percent: float) -> None:
        assert pin in self.outputs
        self.pwm[pin] = (frequency, percent)


@pytest.fixture
def chip(monkeypatch: pytest.MonkeyPatch) -> Chip:
    from gpiozero.pins.lgpio import LGPIOFactory

    chip = Chip()
    chip.install(monkeypatch)
    monkeypatch.setattr(LGPIOFactory, "_get_revision", lambda self: 0xC03111)  # Raspberry Pi 4B
    monkeypatch.setattr(Device, "pin_factory", LGPIOFactory())
    return chip


def driven(throttles: tuple[float, float]) -> Motors:
    motors = open_motors("article-car")
    motors.enable()
    motors.set(throttles)
    return motors


def test_the_articles_car_gets_60_percent_at_2_khz(chip: Chip) -> None:
    motors = driven((0.6, 0.6))
    assert chip.pwm == {10: (2000, 60), 9: (2000, 0), 8: (2000, 60), 7: (2000, 0)}
    motors.set((-0.4, 0.4))
    assert chip.pwm == {10: (2000, 0), 9: (2000, 40), 8: (2000, 40), 7: (2000, 0)}
    motors.disable()
    assert chip.pwm == dict.fromkeys((10, 9, 8, 7), (2000, 0))
    motors.close()


def test_an_output_moves_in_steps_of_one_percent_rounded_down(chip: Chip) -> None:
    """Why this driver is not for servos; docs/pi.md says so too."""
    motors = driven((0.509, 0.511))
    assert (chip.pwm[10], chip.pwm[8]) == ((2000, 50), (2000, 51))
    motors.close()


def imported(module: str, directory: str) -> subprocess.CompletedProcess[str]:
    """A fresh process in `directory` that imports `module` and says where it is then."""
    program = f"import {module}, os; print(os.getcwd(), os.environ.get('LG_WD'))"
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[3])}
    environment.pop("LG_WD", None)
    return subprocess.run(
        [sys.executable, "-c", program], cwd=directory, env=environment, capture_output=True, text=True, check=False
    )


def test_it_can_be_imported_where_lgpio_alone_cannot() -> None:
    """lgpio wants to leave a pipe in the working directory; a service has none that it may write."""
    assert "FileNotFoundError" in imported("lgpio", "/proc").stderr
    assert imported("vehicle.motors.pins", "/proc").stdout == "/proc None\n"


def test_it_leaves_nothing_in_the_working_directory(tmp_path: Path) -> None:
    assert imported("vehicle.motors.pins", str(tmp_path)).stdout == f"{tmp_path} None\n"
    assert list(tmp_path.iterdir()) == []
