"""Escape sequences that a slow line splits, with the real programs: nothing but neutral, and stop keys still stop.

tests/groundstation/ui/terminal/test_escape_sequences.py splits every sequence at every byte.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

from dialects.modes import Mode
from tests.e2e.conftest import Rig
from tests.e2e.programs import LET_GO
from tests.waits import PATIENCE

pytestmark = pytest.mark.e2e

GAP = 0.25
"""s between the pieces: a slow SSH, and longer than the 0.1 s after which ESC counts as a key."""

KEYS = {
    "F2": "\x1bOQ",
    "F3": "\x1b[13~",
    "F6": "\x1b[17~",
    "Alt+2": "\x1b2",
    "up": "\x1b[A",
    "kitty 2": "\x1b[50;1:1;50u",
}
"""Sequences with the keys of HOLD, MANUAL, the next screen and driving in them, or of such a key itself."""


def send_in_two(world: Rig, sequence: str, cut: int) -> None:
    world.station.type(sequence[:cut])
    world.station.look(GAP)
    world.station.type(sequence[cut:])
    world.station.look(GAP)


def test_split_keys_change_no_mode_or_screen_and_drive_nothing(rig: Callable[..., Rig]) -> None:
    world = rig()
    world.drive()
    world.relay.wait(world.vehicle.stands, PATIENCE, "the wheels stop")
    world.station.look(LET_GO)
    since = time.monotonic()
    shown = len(world.station.screen)
    for sequence in KEYS.values():
        for cut in range(1, len(sequence)):
            send_in_two(world, sequence, cut)
    assert not world.vehicle.moved_since(since)
    assert world.relay.last_demand() < since
    assert world.relay.mode() == Mode.MANUAL
    assert world.relay.armed()
    assert b"F1 drives" not in world.station.screen[shown:]  # what every other screen shows in its top line
    assert b"live, newest below" not in world.station.screen[shown:]
    world.station.look(1.0)
    world.drive()


def test_a_split_key_or_a_stop_behind_one_stops_the_wheels(rig: Callable[..., Rig]) -> None:
    world = rig()
    for sequence in (KEYS["F3"], KEYS["up"]):
        world.drive()
        world.station.type("i" + sequence[:2])
        world.station.look(GAP)
        world.station.type(sequence[2:])
        world.relay.wait(world.relay.newest_demand_is_neutral, PATIENCE, "neutral")
        world.relay.wait(world.vehicle.stands, PATIENCE, "the wheels stop")
        assert world.relay.mode() == Mode.MANUAL
        world.station.look(LET_GO)
    world.drive()
    world.station.type("\x1b[1")
    world.station.look(GAP)
    world.station.type("!")
    world.relay.wait(world.vehicle.stands, PATIENCE, "the wheels stop")
    world.relay.wait(lambda: not world.relay.armed(), PATIENCE, "the motors are off")
