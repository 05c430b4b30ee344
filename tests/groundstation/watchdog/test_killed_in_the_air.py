"""Real programs and a copter on a real line: killed, stopped or ended in the air, it hovers until its own failsafe."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from dialects import messages as m
from dialects.axes import HOVER
from dialects.enums import Command
from groundstation.intents.driving import DriveKeyUp
from groundstation.intents.session import Quit, ReportKeyReleases
from groundstation.intents.vehicle import Arm, SetMode, TakeOff
from tests.fakes.flying import FlyingVehicle
from tests.fakes.lines import on_line
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.groundstation.screen import FORWARD, Screen, running
from tests.waits import PATIENCE, wait_until

pytestmark = pytest.mark.e2e

HEIGHT = 5.0
LOSS = 0.5
"""m of altitude that no way to die may cost."""
HOVERS_FOR = 2.0
"""s that are watched: less than any failsafe of its own takes to land it."""


class Flight:
    """A station process whose operator has taken off a copter and flies it ahead."""

    def __init__(
        self, copter: FlyingVehicle, line: str, stack: ExitStack, join: Callable[[str], str] = lambda endpoint: endpoint
    ) -> None:
        """`join`: takes the endpoint of the copter, and returns that of the station, with what is between them."""
        self.copter = stack.enter_context(on_line(copter, line))
        self.screen = stack.enter_context(Screen(join(copter.endpoint)))
        self.station = self.screen.client.pid
        send, insist = self.screen.client.send, self.screen.insist
        self.screen.see(lambda seen: seen.vehicle is not None)
        send(ReportKeyReleases())
        insist(lambda: send(Arm(held=1.0)), lambda seen: seen.vehicle is not None and seen.vehicle.armed)
        insist(lambda: send(TakeOff(altitude=HEIGHT, held=1.0)), lambda _: copter.flies)
        wait_until(lambda: copter.altitude > HEIGHT - 0.3)
        insist(lambda: send(SetMode("MANUAL")), lambda seen: seen.operator.gate_open)
        insist(lambda: send(DriveKeyUp(key="i"), FORWARD), lambda _: copter.speed > 2.0)

    def assert_hovers(self) -> None:
        """It brakes at its altitude, and nothing but neutral arrives."""
        altitude, began = self.copter.altitude, time.monotonic()
        wait_until(lambda: self.last().z == HOVER and self.last().x == 0)
        lowest = [self.copter.altitude]

        def watched() -> bool:
            lowest.append(self.copter.altitude)
            return time.monotonic() > began + HOVERS_FOR

        wait_until(watched)
        assert min(lowest) > altitude - LOSS
        assert self.copter.lowest_z >= HOVER
        assert (self.last().x, self.last().z) == (0, HOVER)
        assert self.copter.armed

    def last(self) -> m.ManualControl:
        """The newest demand."""
        return self.copter.all(m.ManualControl)[-1][1]


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as opened:
        yield opened


def kill(flight: Flight) -> None:
    os.kill(flight.station, signal.SIGKILL)


def stop(flight: Flight) -> None:
    os.kill(flight.station, signal.SIGSTOP)


def end(flight: Flight) -> None:
    flight.screen.client.send(Quit(disarm=True))


def freeze(flight: Flight) -> None:
    flight.screen.freeze()


ROWS: list[tuple[Callable[[], FlyingVehicle], str, Callable[[Flight], None]]] = [
    (ArduCopter, "udpin", kill),
    (Px4Quad, "serial", kill),
    (ArduCopter, "serial", stop),
    (Px4Quad, "udpin", stop),
    (ArduCopter, "tcpout", end),
    (Px4Quad, "udpin", freeze),
]


@pytest.mark.parametrize(("build", "line", "way"), ROWS, ids=[f"{row[2].__name__}-{row[1]}" for row in ROWS])
def test_no_way_to_die_lets_it_fall_or_fly_on(
    build: Callable[[], FlyingVehicle], line: str, way: Callable[[Flight], None], stack: ExitStack
) -> None:
    flight = Flight(build(), line, stack)
    way(flight)
    flight.assert_hovers()
    if way is stop:
        os.kill(flight.station, signal.SIGCONT)
    if way is kill:
        wait_until(lambda: not running(flight.station))


@pytest.mark.parametrize("build", [ArduCopter, Px4Quad])
def test_the_verb_for_the_emergency_stop_lands_it(build: Callable[[], FlyingVehicle], stack: ExitStack) -> None:
    copter = build()
    stack.enter_context(on_line(copter, "udpin"))
    copter.lift(HEIGHT)
    verb = [sys.executable, "-m", "groundstation", "estop", "-e", copter.endpoint]
    ended = subprocess.run(verb, check=False, capture_output=True, text=True, timeout=PATIENCE)
    assert "it lands" in ended.stdout + ended.stderr, ended
    wait_until(lambda: not copter.armed)
    assert copter.hit_ground_at < 1.0


@pytest.mark.parametrize(("build", "options"), [(ArduCopter, ()), (Px4Quad, ("-v", "1")), (ArduCopter, ("--all",))])
def test_the_verb_lands_one_that_is_not_heard(
    build: Callable[[], FlyingVehicle], options: tuple[str, ...], stack: ExitStack
) -> None:
    copter = build()
    copter.mute = True
    stack.enter_context(on_line(copter, "udpout"))
    copter.lift(2.0)
    verb = [sys.executable, "-m", "groundstation", "estop", "-e", copter.endpoint, "--wait", "4", *options]
    ended = subprocess.run(verb, check=False, capture_output=True, text=True, timeout=PATIENCE)
    assert ended.returncode != 0, ended
    wait_until(lambda: not copter.armed)
    assert copter.hit_ground_at < 1.0
    assert [each for each in copter.commands(Command.COMPONENT_ARM_DISARM) if each.param2] == []


def test_only_the_option_that_says_so_lets_it_fall(stack: ExitStack) -> None:
    copter = ArduCopter()
    stack.enter_context(on_line(copter, "udpin"))
    copter.lift(HEIGHT)
    verb = [sys.executable, "-m", "groundstation", "estop", "--cut", "-e", copter.endpoint]
    ended = subprocess.run(verb, check=False, capture_output=True, text=True, timeout=PATIENCE)
    assert ended.returncode == 0, ended
    wait_until(lambda: not copter.flies)
    assert copter.hit_ground_at > 5.0
