"""A motor driver and a relay driver as a newcomer writes them, with one row each in the tables of drivers."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Annotated

import msgspec

from vehicle.accessories.drivers import DRIVERS as ACCESSORY_DRIVERS
from vehicle.accessories.simulated import SimulatedAccessory
from vehicle.motors.drivers import DRIVERS, DriverEntry
from vehicle.motors.simulated import SimulatedMotors


class ToySettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A toy."""

    port: str
    """The port of the toy."""
    gain: Annotated[float, msgspec.Meta(ge=0, le=1)] = 0.5
    """Gain of the toy."""


class ToyMotors(SimulatedMotors):
    """Two motors of a toy."""

    Settings = ToySettings

    def __init__(self, settings: ToySettings) -> None:
        super().__init__(2)
        self.settings = settings


ROWS = (
    (DRIVERS, DriverEntry(f"{__name__}:ToyMotors", "a toy on a serial port", example={"port": "/dev/toy"})),
    (ACCESSORY_DRIVERS["relay"], DriverEntry(f"{__name__}:ToyRelay", "a relay of a toy")),
)


class ToyRelay(SimulatedAccessory):
    """A relay without settings of its own."""


def add_rows(set_item: Callable[[dict[str, DriverEntry], str, DriverEntry], None] = dict.__setitem__) -> None:
    """Add a row for each toy, as the recipe in CONTRIBUTING.md says."""
    for table, entry in ROWS:
        set_item(table, "toy", entry)


if __name__ == "__main__":
    from tests.vehicle.cli import toy_drivers
    from vehicle.cli.main import main

    toy_drivers.add_rows()
    sys.exit(main())
