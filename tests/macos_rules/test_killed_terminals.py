"""What must end, ends, where no kernel of Linux sees to it: programs under the rules of macOS, killed with -9.

A pair of datagram sockets reports no end of file: with it, a station outlived its killed terminal by 45 s.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from tests.groundstation.screen import children, running, simulators
from tests.macos_rules.forced import FOLDER
from tests.ports import free_port
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.e2e

ENDS_WITHIN = 8.0
"""s for programs to end, with neutral for vehicles that are there; the kernel's delays are added."""


class Terminal:
    """A terminal with a ground station under the rules of macOS: its processes."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        words = ["-m", "tests.macos_rules.terminal", "-m", "groundstation", *arguments]
        environment = {**os.environ, "PYTHONPATH": str(FOLDER), "XDG_RUNTIME_DIR": str(folder)}
        self.process = subprocess.Popen([sys.executable, *words], stdout=subprocess.PIPE, env=environment)
        assert self.process.stdout is not None
        self.screen = int(self.process.stdout.readline())
        self.sockets = folder / "mavhelm"
        self.station = wait_until(self._find_station, "a station that takes programs")
        self.watchdog = wait_until(lambda: next(iter(self._watchdogs()), 0), "a watchdog")

    def _find_station(self) -> int:
        with suppress(OSError):
            for each in self.sockets.glob("station-*.sock"):
                return int(each.stem.partition("-")[2])
        return 0

    def _watchdogs(self) -> list[int]:
        return [child for child in children(self.station) if child not in simulators(self.station)]

    def end(self) -> None:
        """Kill all of it."""
        for pid in (self.screen, self.station, self.watchdog):
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self.process.kill()
        self.process.communicate()


@pytest.fixture
def terminal(tmp_path: Path) -> Iterator[Callable[..., Terminal]]:
    opened: list[Terminal] = []

    def build(*arguments: str) -> Terminal:
        opened.append(Terminal(tmp_path, *arguments))
        return opened[-1]

    yield build
    for each in opened:
        each.end()


@pytest.mark.parametrize("killed", ["terminal", "screen"])
def test_a_station_ends_when_its_terminal_is_killed(terminal: Callable[..., Terminal], killed: str) -> None:
    world = terminal(f"udpin:127.0.0.1:{free_port()}")
    delays = Waits(world.station, world.watchdog)
    os.kill(world.process.pid if killed == "terminal" else world.screen, signal.SIGKILL)
    for pid in (world.screen, world.station, world.watchdog):
        wait_until(lambda pid=pid: not running(pid), "the end of all", ENDS_WITHIN + delays.total())  # type: ignore[misc]


def test_a_killed_screen_leaves_no_simulator(terminal: Callable[..., Terminal]) -> None:
    world = terminal("--sitl")
    (simulator,) = wait_until(lambda: simulators(world.station), "a simulator")
    for pid in (world.screen, world.station):
        os.kill(pid, signal.SIGKILL)
    delays = Waits(simulator)
    wait_until(lambda: not running(simulator), "the end of the simulator", ENDS_WITHIN + delays.total())


def test_a_station_that_is_killed_leaves_its_screen_running(terminal: Callable[..., Terminal]) -> None:
    world = terminal(f"udpin:127.0.0.1:{free_port()}")
    os.kill(world.station, signal.SIGKILL)
    wait_until(lambda: not running(world.watchdog), "the end of the watchdog")
    assert running(world.screen)
