"""The watchdog for real: the station process killed with -9 or stopped, on each kind of line."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack

import pytest

from groundstation.intents.driving import DriveKeyDown, DriveKeyUp
from groundstation.intents.session import Quit, RenewLease
from tests.fakes.lines import LINES, on_line
from tests.fakes.rover import LATCH, LONG_LATCH, FakeArduPilot
from tests.groundstation.screen import FORWARD, Screen, children, running
from tests.waits import Waits, wait_until

pytestmark = pytest.mark.e2e

REPEAT = DriveKeyDown(key="i", throttle=1, steering=0, repeat=True)
NOISE = 0.4
"""s of a busy machine that the kernel does not count as waiting."""


class Drive:
    """A station process that drives an ArduRover, which keeps a demand for `latch` s."""

    def __init__(self, line: str, stack: ExitStack, latch: float = LONG_LATCH) -> None:
        self.rover = FakeArduPilot(latch=latch)
        vehicle = stack.enter_context(on_line(self.rover, line))
        self.screen = stack.enter_context(Screen(vehicle.endpoint))
        self.station = self.screen.client.pid
        self.screen.hold_forward()
        self.screen.turn_wheels(lambda: self.rover.moves)
        (self.watchdog,) = children(self.station)
        self.waits = Waits(self.station, self.watchdog)

    def signal(self, number: signal.Signals) -> float:
        """Send a signal to the station; return when."""
        os.kill(self.station, number)
        return time.monotonic()

    def stops_within(self, seconds: float, since: float) -> None:
        """Check that the wheels stop, in less than the time that the rover takes by itself."""
        wait_until(lambda: not self.rover.moves)
        assert self.rover.stopped_at - since < seconds + NOISE + self.waits.total() < LONG_LATCH

    def outage(self) -> str:
        self.screen.client.receive()
        return self.screen.client.outage.text


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    with ExitStack() as opened:
        yield opened


@pytest.mark.parametrize("line", LINES)
def test_a_killed_station_stops_the_rover_and_the_screen_tells(line: str, stack: ExitStack) -> None:
    drive = Drive(line, stack)
    killed = drive.signal(signal.SIGKILL)
    wait_until(lambda: "neutral is sent to ArduPilot rover 1" in drive.outage())
    drive.stops_within(0.2, killed)
    wait_until(lambda: drive.outage() == "station process ended: ArduPilot rover 1 stands")
    assert drive.screen.client.left_armed == (
        "station process ended: ArduPilot rover 1 stands",
        "last known before: ArduPilot rover 1 is left ARMED in MANUAL",
    )
    assert not drive.screen.client.alive
    wait_until(lambda: not running(drive.watchdog))
    assert not [at for at, *outputs in drive.rover.turning if any(outputs) and at > drive.rover.stopped_at]


@pytest.mark.parametrize("line", LINES)
def test_stopped_stations_held_key_moves_nothing_when_it_goes_on(line: str, stack: ExitStack) -> None:
    drive = Drive(line, stack)
    send = drive.screen.client.send
    stopped = drive.signal(signal.SIGSTOP)
    drive.stops_within(0.3, stopped)
    wait_until(lambda: "not responding: neutral is sent to ArduPilot rover 1" in drive.outage())
    drive.signal(signal.SIGCONT)
    back = time.monotonic()
    wait_until(lambda: send(REPEAT) is None and time.monotonic() > back + 1.5)
    assert not drive.rover.moves, "the key was held all along"
    assert drive.rover.stopped_at < back, [(at - back, *outputs) for at, *outputs in drive.rover.turning]
    wait_until(lambda: drive.outage() == "")
    drive.screen.see(lambda seen: any("station stopped for" in line.text for line in seen.texts))
    drive.screen.insist(lambda: send(DriveKeyUp(key="i"), FORWARD), lambda seen: seen.operator.throttle > 0)
    wait_until(lambda: drive.rover.moves)


def test_stopped_station_that_is_then_killed_gets_no_new_neutral(stack: ExitStack) -> None:
    drive = Drive("udpin", stack)
    drive.stops_within(0.3, drive.signal(signal.SIGSTOP))
    wait_until(lambda: "may still move" in drive.outage())
    drive.signal(signal.SIGKILL)
    wait_until(lambda: not running(drive.watchdog))
    wait_until(lambda: drive.outage().startswith("station process ended: ArduPilot rover 1 may still move"))


def test_the_port_is_free_when_a_station_has_ended_in_order(stack: ExitStack) -> None:
    drive = Drive("udpin", stack)
    drive.screen.client.send(Quit())
    wait_until(lambda: not running(drive.station))
    assert not running(drive.watchdog)
    wait_until(lambda: not drive.rover.moves)
    assert drive.outage() == ""


def test_a_station_that_drives_nothing_leaves_nothing_behind() -> None:
    with Screen() as screen:
        screen.see(lambda seen: seen.number > 2)
        (watchdog,) = children(screen.client.pid)
        os.kill(screen.client.pid, signal.SIGKILL)
        wait_until(lambda: not running(watchdog))
        screen.client.receive()
        assert screen.client.outage.text == "station process ended: nothing is sent"


def test_the_report_is_read_behind_intents_not_yet_read() -> None:
    with Screen() as screen:
        screen.see(lambda seen: seen.number > 2)
        (watchdog,) = children(screen.client.pid)
        os.kill(screen.client.pid, signal.SIGSTOP)
        screen.client.send(RenewLease())
        os.kill(screen.client.pid, signal.SIGKILL)
        wait_until(lambda: not running(watchdog))
        screen.client.receive()
        assert screen.client.outage.text == "station process ended: nothing is sent"


def test_station_whose_watchdog_is_killed_says_so_and_drives_on(stack: ExitStack) -> None:
    drive = Drive("udpin", stack)
    os.kill(drive.watchdog, signal.SIGKILL)
    text = "the watchdog has ended: if this process is killed, nothing sends neutral"
    drive.screen.see(lambda seen: any(line.text == text for line in seen.texts))
    seen = drive.screen.snapshot.number
    drive.screen.see(lambda snapshot: snapshot.number > seen + 10)
    drive.screen.turn_wheels(lambda: drive.rover.moves)  # a late machine may have released the key
    assert sum(line.count for line in drive.screen.snapshot.texts if line.text == text) == 1


def test_stopped_watchdog_does_not_take_the_station_for_stopped(stack: ExitStack) -> None:
    drive = Drive("udpin", stack)
    os.kill(drive.watchdog, signal.SIGSTOP)
    at = time.monotonic()
    wait_until(lambda: time.monotonic() > at + 1.5)
    os.kill(drive.watchdog, signal.SIGCONT)
    wait_until(lambda: time.monotonic() > at + 3.0)
    if drive.waits.total() < 0.2:
        assert drive.rover.moves
    assert drive.outage() == ""


def test_without_the_watchdog_the_rover_drives_on_for_3_s(stack: ExitStack) -> None:
    """The fault that the watchdog cures: what the other tests measure is not the rover's own doing."""
    drive = Drive("udpin", stack, LATCH)
    os.kill(drive.watchdog, signal.SIGKILL)
    wait_until(lambda: not running(drive.watchdog))
    killed = drive.signal(signal.SIGKILL)
    wait_until(lambda: not drive.rover.moves)
    assert drive.rover.stopped_at - killed > LATCH - 0.3 - drive.waits.total()
