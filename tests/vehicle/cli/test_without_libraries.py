"""A laptop on which the file of a Raspberry Pi is written: the libraries of the hardware are not installed there."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from vehicle.config.schema import build_schema
from vehicle.config.template import build_template

ABSENT = """
import sys

class Absent:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("gpiozero", "lgpio", "smbus2"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Absent())
"""
"""Imported by each Python that starts with this module's folder in PYTHONPATH."""
HEAD = 'endpoints = ["udpout:127.0.0.1:9"]\n'
BRIDGE = 'driver = "gpio"\nbridges = [{{wiring = "{0}", forward = 5, backward = {1}}}]\n'
WHEELS = "\n[sensors]\ncomputer = false\nencoders = {wheels = [{a = 5, b = 23}]}\n"
PCA9685 = 'driver = "pca9685"\nchannels = [{channel = 0}, {channel = 1}]\n'
RELAY = '[[accessories.relays]]\ndriver = "gpio"\nnumber = 0\npin = 5\n'


@pytest.fixture
def laptop(tmp_path: Path) -> dict[str, str]:
    """Return the environment of programs without the libraries."""
    (tmp_path / "sitecustomize.py").write_text(ABSENT)
    return {**os.environ, "PYTHONPATH": f"{tmp_path}:{Path(__file__).parents[3]}"}


def run(laptop: dict[str, str], *words: str) -> tuple[int, str]:
    """Run `vehicle`; return the exit code and what it printed."""
    command = [sys.executable, "-m", "vehicle", *words]
    done = subprocess.run(command, env=laptop, capture_output=True, text=True, timeout=60, check=False)
    return done.returncode, done.stdout + done.stderr


def test_template_and_schema_are_the_same(laptop: dict[str, str], tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    assert run(laptop, "init", str(file)) == (0, f"wrote {file}; edit it, then run: mavhelm vehicle check {file}\n")
    assert file.read_text() == build_template()
    assert run(laptop, "schema") == (0, build_schema())


@pytest.mark.parametrize(
    ("motors", "problem"),
    [
        (BRIDGE.format("l298n", 6), "motors.bridges[0].wiring: 'l298n' is not known; there are two-inputs, phase-"),
        (BRIDGE.format("two-inputs", 6) + "backwards = true", "motors.backwards: unknown key; there are bridges, freq"),
        (BRIDGE.format("two-inputs", 5), "motors: GPIO 5 is used twice"),
        (BRIDGE.format("two-inputs", 6) + WHEELS, "sensors.encoders: GPIO 5 is already used by motors; change one"),
        (BRIDGE.format("two-inputs", 6) + RELAY, "accessories.relays[0]: GPIO 5 is already used by motors; change "),
        (PCA9685 + "frequency = true", "motors.frequency: must be a number, not true or false"),
    ],
)
def test_the_settings_are_checked(laptop: dict[str, str], tmp_path: Path, motors: str, problem: str) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(f"{HEAD}[motors]\n{motors}")
    code, text = run(laptop, "check", str(file))
    assert (code, text.count("\n")) == (2, 1)
    assert text.startswith(f"FAIL  settings: {file}: {problem}")


def test_a_file_without_mistakes_lacks_the_library(laptop: dict[str, str], tmp_path: Path) -> None:
    file = tmp_path / "rover.toml"
    file.write_text(f"{HEAD}[motors]\n{BRIDGE.format('two-inputs', 6)}[sensors]\ncomputer = false\n")
    code, text = run(laptop, "check", str(file), "--state", str(tmp_path))
    assert code == 1  # the hardware, not the file
    assert f"ok    settings: {file}\n" in text
    assert "FAIL  motors: No module named 'gpiozero'; install it: " in text
