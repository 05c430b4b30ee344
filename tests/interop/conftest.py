"""Our vehicle as a process, with two UDP ports for foreign ground stations, directly or through a relay."""

from __future__ import annotations

import math
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.e2e.programs import Vehicle
from tests.e2e.relay import Relay
from tests.ports import free_port
from tests.waits import PATIENCE

HOME = (-35.3632581, 149.1652363)
"""Where the simulated rover starts, degrees."""
STEP = 0.02
"""s between two polls of the motor log."""
DEGREE = 1e7 / 89.83
"""m of a degree to the north."""
NEARLY = 1.2
"""m of allowed distance from the target: 0.3 m for the control, the rest for the simulated receiver."""


class Rover:
    """The vehicle and its two ports; `relay` is in front of the first."""

    def __init__(self, folder: Path, *options: str, relay: Relay | None = None) -> None:
        self.port = relay.ground_port if relay else free_port()
        self.second_port = free_port()
        first = relay.vehicle_port if relay else self.port
        self._truth = folder / "truth.log"
        self._stood = 0
        """Number of outputs when the wheels last stopped."""
        self.vehicle = Vehicle(
            folder, first, f"udpout:127.0.0.1:{self.second_port}", "--sim-truth", str(self._truth), *options
        )

    def soon(self, condition: Callable[[], bool], within: float) -> bool:
        """Poll the motors until `condition`; return False if it does not become true."""
        deadline = time.monotonic() + within
        tick = threading.Event()
        while not condition():
            if time.monotonic() >= deadline:
                return False
            tick.wait(STEP)
        return True

    def wait(self, condition: Callable[[], bool], within: float, what: str) -> None:
        """Poll the motors until `condition`."""
        assert self.soon(condition, within), (
            f"not within {within} s: {what}; {self.vehicle.outputs()[-3:]}, at {self._place()}"
        )

    def is_at(self, place: tuple[float, float], within: float = PATIENCE) -> None:
        """Wait until the true position is near `place` (latitude and longitude)."""
        north, east = _metres(place)
        self.wait(lambda: self.is_near(place), within, f"{north:.1f}, {east:.1f} m")

    def is_near(self, place: tuple[float, float]) -> bool:
        """Return whether the true position is near `place` (latitude and longitude)."""
        return math.dist(self._place(), _metres(place)) < NEARLY

    def _place(self) -> tuple[float, float]:
        """Return the true position, m to the north and east of the start."""
        lines = self._truth.read_text().rpartition("\n")[0].splitlines()
        _, north, east, *_ = lines[-1].split()
        return float(north), float(east)

    def speaks(self, within: float = PATIENCE) -> None:
        """Wait until the vehicle has started and sends."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
            ear.bind(("127.0.0.1", self.second_port))
            ear.settimeout(within)
            ear.recv(65536)

    def drives(self) -> None:
        """Wait until the wheels turn or have turned since the last stop: a short drive may be over before a poll."""
        self.wait(lambda: any(each.turning for each in self.vehicle.outputs()[self._stood :]), PATIENCE, "wheels turn")

    def stands(self) -> None:
        """Wait until the wheels have stopped."""
        self.wait(self.vehicle.stands, PATIENCE, "the wheels stop")
        self._stood = len(self.vehicle.outputs())


def _metres(place: tuple[float, float]) -> tuple[float, float]:
    """Return m to the north and east of HOME."""
    return (place[0] - HOME[0]) * DEGREE, (place[1] - HOME[1]) * DEGREE * math.cos(math.radians(HOME[0]))


LOSS = 0.1
"""Share of the frames that are lost in each direction."""


@pytest.fixture
def options() -> tuple[str, ...]:
    """Options of the vehicle; a test file may override this."""
    return ()


@pytest.fixture
def rover(tmp_path: Path, options: tuple[str, ...]) -> Iterator[Rover]:
    """A simulated rover that ends with the test."""
    with ExitStack() as stack:
        rover = Rover(tmp_path, *options)
        stack.callback(rover.vehicle.end)
        yield rover


@pytest.fixture
def relay() -> Iterator[Relay]:
    """A network that loses frames."""
    relay = Relay(loss=LOSS)
    yield relay
    relay.close()


@pytest.fixture
def far_rover(tmp_path: Path, relay: Relay) -> Iterator[Rover]:
    """A simulated rover behind a network that loses frames."""
    with ExitStack() as stack:
        rover = Rover(tmp_path, relay=relay)
        stack.callback(rover.vehicle.end)
        yield rover
