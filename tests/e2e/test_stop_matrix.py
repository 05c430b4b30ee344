"""The stop matrix: real programs, and every way in which a driver can vanish. Wheels turn first, then they stop.

tests/test_stops.py checks the bounds of docs/safety.md to the millisecond in virtual time (outputs begin to fall within
0.5 s of the last valid demand, and are neutral within 1 s). Here a shared machine with two cores may be late itself:
the delays that the kernel counted are added to the bounds (waits.py), and NOISE for what is not counted.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from dialects.modes import Mode
from groundstation.input.key_repeat import PRESS_WINDOW
from tests.e2e.conftest import Rig
from tests.e2e.programs import LET_GO, drive_on
from tests.waits import PATIENCE, Waits

pytestmark = pytest.mark.e2e

FALLS_WITHIN = 0.5
NEUTRAL_WITHIN = 1.0
NOISE = 0.4
HOLD_TIMEOUT = 0.25
"""s after the last auto-repeat at which a held key counts as released (groundstation/input/sticks.py, over ssh)."""

Build = Callable[..., Rig]


def assert_stops(rig: Rig) -> None:
    """Check that the wheels stop in time after the last demand that the vehicle got, and stay stopped."""
    rig.relay.wait(rig.vehicle.stands, PATIENCE, "the wheels stop")
    noise = NOISE + rig.obeying.total()
    falls, stops = rig.vehicle.falls_and_stops_after(rig.relay.last_demand())
    assert falls <= FALLS_WITHIN + noise
    assert stops <= NEUTRAL_WITHIN + noise
    stopped = rig.vehicle.outputs()[-1].at
    rig.relay.wait(lambda: time.monotonic() > stopped + 1.5, PATIENCE, "a while passes")
    assert not rig.vehicle.moved_since(stopped)


def assert_stood(rig: Rig, since: float, within: float) -> None:
    """Check that the wheels stopped in time after `since`, when the driver did what stops them."""
    assert rig.vehicle.outputs()[-1].at - since <= within + NOISE + rig.asking.total()


def assert_said_neutral(rig: Rig, since: float) -> None:
    """Check that the ground station sent neutral frames before its end."""
    rig.relay.wait(lambda: rig.relay.neutral_since(since) >= 3, PATIENCE, "three neutral demands")


def test_key_released(rig: Build) -> None:
    world = rig()
    world.drive()
    released = time.monotonic()
    assert_stops(world)
    assert_stood(world, released, HOLD_TIMEOUT + NEUTRAL_WITHIN)
    assert world.relay.armed()


def test_a_stop_key_in_a_burst_wins(rig: Build) -> None:
    world = rig()
    for burst in ("ik", "ki", "iiiii ", " i", "lk", "ik\x1b[A"):
        world.drive()
        pressed = time.monotonic()
        world.station.type(burst)
        assert_stops(world)
        assert_stood(world, pressed, NEUTRAL_WITHIN)
        world.station.look(LET_GO)


TRIES = 5
"""Times that a key is held over another screen, until no pause between its repeats was that of a new press."""


@pytest.mark.parametrize("opener", ["\x1b[17~", "\x07"], ids=["log", "go-to menu"])
def test_a_key_held_over_another_screen_does_not_drive(rig: Build, opener: str) -> None:
    """F6 and the go-to menu, while the key repeats all the time, as from a second keyboard."""
    world = rig()
    for _ in range(TRIES):
        if stands_with_the_key_held(world, opener):
            break
        world.station.look(LET_GO)
    else:
        pytest.fail(f"no {TRIES} times without a pause of {PRESS_WINDOW} s in the repeats of the key")
    drive_on(world.station, world.vehicle)


def stands_with_the_key_held(world: Rig, opener: str) -> bool:
    """Drive, hold the key over another screen and back; the wheels must not turn there.

    Return False if this process paused for so long between two repeats that they are two presses: then they may turn.
    """
    world.drive()
    pressed, drawn = time.monotonic(), len(world.station.screen)
    world.station.longest_pause = 0.0
    world.station.type("i" + opener)
    world.station.hold("i", world.vehicle.stands)
    assert_stood(world, pressed, NEUTRAL_WITHIN)
    back = time.monotonic()
    world.station.type("i\x1bOP")  # F1

    def told() -> bool:
        return b"held from before" in world.station.screen[drawn:]

    world.station.hold("i", lambda: told() or world.vehicle.moved_since(back))
    world.station.hold("i", lambda: time.monotonic() > back + 3.0)
    pause, moved = world.station.longest_pause, world.vehicle.moved_since(back)
    assert not moved or pause + world.asking.total() >= PRESS_WINDOW, f"it drives after pauses of {pause:.2f} s at most"
    return pause < PRESS_WINDOW and not moved


def test_terminal_closed(rig: Build) -> None:
    world = rig()
    world.drive()
    closed = time.monotonic()
    world.station.close_terminal()
    assert_stops(world)
    assert world.station.process.wait(PATIENCE) is not None
    assert_said_neutral(world, closed)


def test_ground_station_killed(rig: Build) -> None:
    world = rig()
    world.drive()
    os.kill(world.station.process.pid, signal.SIGKILL)
    assert_stops(world)


def test_ground_station_and_its_children_killed(rig: Build) -> None:
    world = rig()
    world.drive()
    os.killpg(world.station.process.pid, signal.SIGKILL)
    assert_stops(world)


def test_ground_station_frozen(rig: Build) -> None:
    """Only the screen's process hangs: the station notices that its lease is not renewed."""
    world = rig()
    world.drive()
    os.kill(world.station.process.pid, signal.SIGSTOP)
    assert_stops(world)
    assert world.relay.newest_demand_is_neutral()


def test_ground_station_frozen_with_its_children(rig: Build) -> None:
    world = rig()
    world.drive()
    os.killpg(world.station.process.pid, signal.SIGSTOP)
    assert_stops(world)
    os.killpg(world.station.process.pid, signal.SIGCONT)
    back = time.monotonic()
    world.relay.wait(lambda: time.monotonic() > back + 1.0, PATIENCE, "a while passes")
    assert not world.vehicle.moved_since(back)


def test_ground_station_told_to_end(rig: Build) -> None:
    """tests/groundstation/ui/app/test_exit.py has the other signals, which have the same handler."""
    world = rig()
    world.drive()
    told = time.monotonic()
    os.kill(world.station.process.pid, signal.SIGTERM)
    assert_stops(world)
    assert world.station.ended() == 128 + signal.SIGTERM  # as in a shell
    assert_said_neutral(world, told)


def test_quit_by_key(rig: Build) -> None:
    world = rig()
    world.drive()
    told = time.monotonic()
    world.station.type("\x03")
    assert_stops(world)
    assert world.station.ended() == 0
    assert_said_neutral(world, told)


@pytest.mark.slow
def test_link_cut_and_back_with_the_key_held_all_along(rig: Build) -> None:
    """After 10 s without a link nothing moves by itself, neither by the old demand nor by the held key."""
    world = rig()
    world.drive()
    world.relay.cut()
    cut = time.monotonic()
    world.station.hold("i", lambda: time.monotonic() > cut + 10.0)
    noise = NOISE + world.obeying.total()
    falls, stops = world.vehicle.falls_and_stops_after(world.relay.last_demand())
    assert falls <= FALLS_WITHIN + noise
    assert stops <= NEUTRAL_WITHIN + noise
    stopped = time.monotonic()
    world.relay.cut(False)
    back = time.monotonic()

    def heard_again() -> bool:  # and requests nothing old
        return time.monotonic() > back + 3.0 and bool(world.relay.demands_since(back + 1.0))

    world.station.hold("i", heard_again)
    assert not world.vehicle.moved_since(stopped)
    drive_on(world.station, world.vehicle)


HOLDS, MORE_HOLDS = 4, 16
"""Key presses on a lossy link; with little loss all but one of 4 must drive, or 3 of 16 on a machine that is late."""
LATE = 0.5
"""s of delays of the programs by which a machine counts as late."""


@pytest.mark.parametrize(("loss", "keeps_driving"), [(0.10, True), (0.30, False)])
@pytest.mark.slow
def test_a_lossy_link(rig: Build, loss: float, keeps_driving: bool) -> None:
    """Hold and release the key some times. Motion follows the key or ends; it never comes late."""
    world = rig(loss=loss, delay=0.010)
    world.drive()
    waits = Waits(world.vehicle.process.pid, world.station.process.pid)
    held = drove = 0
    while held < HOLDS or (keeps_driving and drove < HOLDS - 1 and held < MORE_HOLDS and waits.total() > LATE):
        held, drove = held + 1, drove + drives_for_5_s(world)
    if keeps_driving:
        assert drove >= HOLDS - 1


def drives_for_5_s(rig: Rig) -> bool:
    """Hold the key and release it; what moves then must stop in time. Return whether it drove."""
    if rig.relay.mode() != Mode.MANUAL:
        rig.station.type("1")
        rig.station.soon(lambda: rig.relay.mode() == Mode.MANUAL, 2.0)
    rig.watch()
    pressed, full = time.monotonic(), False

    def over() -> bool:
        nonlocal full
        full = full or rig.vehicle.at_full()
        return time.monotonic() > pressed + 5.0

    rig.station.hold("i", over)
    released = time.monotonic()
    rig.station.look(HOLD_TIMEOUT + NEUTRAL_WITHIN + NOISE)
    rig.station.wait_for(rig.vehicle.stands, PATIENCE, "the wheels stop")
    assert_stood(rig, released, HOLD_TIMEOUT + NEUTRAL_WITHIN)
    return full


def test_vehicle_told_to_end(rig: Build) -> None:
    world = rig()
    world.drive()
    world.vehicle.process.send_signal(signal.SIGTERM)
    assert world.vehicle.process.wait(PATIENCE) == 0
    assert not world.vehicle.turning()
    lines = world.vehicle.errors.read_text().splitlines()
    assert lines[-1] == "vehicle: stopped by SIGTERM, motors neutral"
    assert all(line.startswith("vehicle: ") for line in lines)
