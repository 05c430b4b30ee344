"""Our vehicle as a process, waiting for a foreign ground station on a UDP port of this machine."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.programs import Vehicle
from tests.e2e.relay import free_port

STEP = 0.02
"""s between two looks at the motor log."""


class Rover:
    """The vehicle, and the port where it looks for its ground station."""

    def __init__(self, folder: Path) -> None:
        self.port = free_port()
        self.vehicle = Vehicle(folder, self.port)

    def wait(self, condition: Callable[[], bool], within: float, what: str) -> None:
        """Look at the motors until `condition`."""
        deadline = time.monotonic() + within
        tick = threading.Event()
        while not condition():
            assert time.monotonic() < deadline, f"not within {within} s: {what}; {self.vehicle.outputs()[-3:]}"
            tick.wait(STEP)

    def drives(self, within: float = 5.0) -> None:
        """Wait until the wheels turn."""
        self.wait(self.vehicle.turning, within, "the wheels turn")

    def stands(self, within: float = 3.0) -> None:
        """Wait until they do not."""
        self.wait(lambda: not self.vehicle.turning(), within, "the wheels stop")


@pytest.fixture
def rover(tmp_path: Path) -> Iterator[Rover]:
    """A simulated rover; ended with the test."""
    with ExitStack() as stack:
        rover = Rover(tmp_path)
        stack.callback(rover.vehicle.end)
        yield rover
