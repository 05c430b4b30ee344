"""Our vehicle as a process, looking for foreign ground stations on two UDP ports of this machine."""

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
    """The vehicle, and the ports where it looks for its ground stations."""

    def __init__(self, folder: Path, *options: str) -> None:
        self.port = free_port()
        self.second_port = free_port()
        self.vehicle = Vehicle(folder, self.port, f"udpout:127.0.0.1:{self.second_port}", *options)

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
def options() -> tuple[str, ...]:
    """More words for the vehicle; a test file may have its own."""
    return ()


@pytest.fixture
def rover(tmp_path: Path, options: tuple[str, ...]) -> Iterator[Rover]:
    """A simulated rover; ended with the test."""
    with ExitStack() as stack:
        rover = Rover(tmp_path, *options)
        stack.callback(rover.vehicle.end)
        yield rover
