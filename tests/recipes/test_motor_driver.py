"""Recipe: a motor driver, in two files: its class and its row in DRIVERS."""

from __future__ import annotations

import pytest

from tests.recipes.tree import Tree

pytestmark = pytest.mark.e2e

TOY = '''"""Motors that hold a toy."""

from __future__ import annotations

from collections.abc import Sequence

import msgspec

from vehicle.motors import check_throttles


class Settings(msgspec.Struct, forbid_unknown_fields=True):
    """Settings of the toy."""

    spring: int
    """Number of the spring."""


class ToyMotors:
    """Two toy motors."""

    Settings = Settings
    count = 2

    def __init__(self, settings: Settings) -> None:
        self._settings = settings

    def enable(self) -> None:
        """Do nothing: a toy has no power."""

    def disable(self) -> None:
        """Do nothing: a toy has no power."""

    def set(self, throttles: Sequence[float]) -> None:
        """Check the throttles."""
        check_throttles(throttles, self.count)

    def close(self) -> None:
        """Do nothing: a toy holds no hardware."""
'''

ROW = '    "toy": DriverEntry("vehicle.motors.toy:ToyMotors", "a toy", example={"spring": 7}),'


def test_a_motor_driver(tree: Tree) -> None:
    tree.write("vehicle/motors/toy.py", TOY)
    tree.insert_after("vehicle/motors/drivers.py", "DRIVERS: dict[str, DriverEntry] = {", ROW)
    tree.check_recipe("a motor driver")
    assert "toy" in tree.run("vehicle", "--help")
    tree.run("vehicle", "init", "rover.toml")
    template = (tree.folder / "rover.toml").read_text()
    assert "#spring = 7" in template
    settings = template.replace('driver = "simulated"', 'driver = "toy"\nspring = 7')
    (tree.folder / "rover.toml").write_text(settings.replace("14550", str(tree.port)))
    assert "motors: toy with 2 motors" in tree.run("vehicle", "check", "rover.toml")
    assert "toy" in tree.run("vehicle", "schema")
