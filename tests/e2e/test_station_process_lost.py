"""The station process killed or stopped under a running screen, with the real programs; and the screen killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path

import pytest

from groundstation.station_socket.connect import running_stations
from tests.e2e.conftest import Rig
from tests.e2e.programs import LET_GO, GroundStation, drive_on
from tests.e2e.test_stop_matrix import assert_stood, assert_stops
from tests.fakes.lines import on_line
from tests.fakes.rover import LONG_LATCH, FakeArduPilot
from tests.groundstation.screen import children, running
from tests.groundstation.ui.wheel import modes
from tests.ports import free_port
from tests.waits import PATIENCE, Waits, wait_until

pytestmark = pytest.mark.e2e

Build = Callable[..., Rig]
TAKES_OVER, RAMP = 0.3, 0.4
"""s for the watchdog to notice a stopped station, and for our rover to ramp from full to neutral."""


def station_of(program: GroundStation) -> int:
    """Return the station process of a ground station."""
    (station,) = children(program.process.pid)
    return station


def shows(program: GroundStation, text: str) -> None:
    """Wait until the screen shows a text."""
    program.wait_for(lambda: text in program.drawn(), PATIENCE, text)


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_our_rover_stops(rig: Build, number: signal.Signals) -> None:
    world = rig()
    world.drive()
    station = station_of(world.station)
    at = time.monotonic()
    os.kill(station, number)
    assert_stops(world)
    assert_stood(world, at, TAKES_OVER + RAMP)


def test_a_held_key_moves_nothing_after_the_freeze(rig: Build) -> None:
    world = rig()
    world.drive()
    station = station_of(world.station)
    os.kill(station, signal.SIGSTOP)
    world.station.hold("i", world.vehicle.stands)
    os.kill(station, signal.SIGCONT)
    back = time.monotonic()
    world.station.hold("i", lambda: time.monotonic() > back + 2.0)
    assert not world.vehicle.moved_since(back)
    drive_on(world.station, world.vehicle)


class Bench:
    """The ground station in a terminal, and an ArduRover, which keeps a demand for LONG_LATCH."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self.rover = FakeArduPilot(latch=LONG_LATCH)
        vehicle = stack.enter_context(on_line(self.rover, "udpin"))
        self.program = GroundStation(folder, vehicle.endpoint)
        stack.callback(self.program.end)
        self.before = termios.tcgetattr(self.program._terminal)
        self.program.wait_for(lambda: b"DISARMED" in self.program.screen, PATIENCE, "a vehicle")
        while not self.rover.armed:  # again, if a late machine makes two presses of one, of which the second disarms
            self.program.press_until("r", lambda: self.rover.armed)
            self.program.look(LET_GO)
        self.program.press_until("i", lambda: self.rover.moves)
        self.station = station_of(self.program)
        self.waits = Waits(self.program.process.pid, self.station)

    def stops_soon(self, since: float) -> None:
        self.program.wait_for(lambda: not self.rover.moves, PATIENCE, "the rover stops")
        assert self.rover.stopped_at - since < TAKES_OVER + 0.4 + self.waits.total() < LONG_LATCH


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    with ExitStack() as stack:
        yield Bench(tmp_path, stack)


def test_the_screen_says_what_becomes_of_an_ardurover(bench: Bench) -> None:
    at = time.monotonic()
    os.kill(bench.station, signal.SIGKILL)
    shows(bench.program, "station process ended: neutral is sent to ArduPilot rover 1")
    bench.stops_soon(at)
    shows(bench.program, "station process ended: ArduPilot rover 1 stands")
    bench.program.type("\x11")
    assert bench.program.ended() == 0


def test_the_screen_names_a_station_that_stands_still(bench: Bench) -> None:
    at = time.monotonic()
    os.kill(bench.station, signal.SIGSTOP)
    shows(bench.program, "station not responding: neutral is sent to ArduPilot rover 1")
    bench.stops_soon(at)
    os.kill(bench.station, signal.SIGCONT)
    shows(bench.program, "station stopped for")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_all_processes_of_the_terminal_killed_or_stopped_at_once(bench: Bench, number: signal.Signals) -> None:
    at = time.monotonic()
    os.killpg(bench.program.process.pid, number)
    bench.stops_soon(at)
    if number is signal.SIGKILL:
        assert_terminal_is_reset(bench)


def test_a_screen_that_quits_resets_the_terminal_itself(bench: Bench) -> None:
    bench.program.type("\x11")
    bench.program.type("\x11")
    assert bench.program.ended() == 0
    wait_until(lambda: not running(bench.station))
    bench.program.look(0.5)
    assert not modes(bench.program.screen)[1049]
    assert b"\x1b[=0;1u" not in bench.program.screen


def test_a_killed_screen_leaves_the_terminal_as_it_was(bench: Bench) -> None:
    drawn = modes(bench.program.screen)
    assert all(drawn[mode] for mode in (1049, 1000, 1004, 2004)), "what the screen has set"
    assert termios.tcgetattr(bench.program._terminal) != bench.before
    os.kill(bench.program.process.pid, signal.SIGKILL)
    assert_terminal_is_reset(bench)
    wait_until(lambda: not running(bench.station))


def assert_terminal_is_reset(bench: Bench) -> None:
    assert_reset(bench.program, bench.before)


def assert_reset(program: GroundStation, before: Sequence[object]) -> None:
    program.wait_for(lambda: not modes(program.screen)[1049], PATIENCE, "the main screen")
    left = [mode for mode, on in modes(program.screen).items() if on and mode not in (7, 25, 1007)]
    assert left == []
    assert program.screen.rfind(b"\x1b[<u") > program.screen.rfind(b"\x1b[>")
    wait_until(lambda: termios.tcgetattr(program._terminal) == before)


def test_a_killed_attached_screen_leaves_the_terminal_as_it_was(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "groundstation", "serve", "--headless", f"udpin:127.0.0.1:{free_port()}"]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as station:
        try:
            wait_until(lambda: station.pid in running_stations())
            program = GroundStation(tmp_path, "attach", str(station.pid))
            before = termios.tcgetattr(program._terminal)
            program.wait_for(lambda: bool(modes(program.screen).get(1000)), PATIENCE, "the screen")
            program.process.kill()
            assert_reset(program, before)
            program.end()
        finally:
            station.terminate()
