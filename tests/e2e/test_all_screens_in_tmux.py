"""All screens in a real terminal, one after the other, while a drive key is held: the wheels turn on Drive only."""

from __future__ import annotations

import select
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import pytest

from groundstation.input.key_repeat import PRESS_WINDOW
from groundstation.screens import SCREENS
from tests.benchmarks.screens import TITLES
from tests.e2e.programs import LET_GO, Vehicle
from tests.e2e.test_in_tmux import Tmux, tmux
from tests.e2e.tmux_marks import IN_TMUX
from tests.ports import free_port
from tests.waits import PATIENCE

__all__ = ["tmux"]

pytestmark = IN_TMUX

OTHERS = [row for row in SCREENS if row.in_tabs and row.id != "drive"]
NARROW_TITLES = TITLES | {"charts": "─ 1 speed"}
"""Id of a screen -> what its first picture has at 80x24."""
HELD = "i"
TRIES = 5
"""Rounds through all screens, until no pause between the repeats of the key was that of a new press."""


@pytest.fixture
def rover(tmp_path: Path) -> Iterator[Callable[[int], Vehicle]]:
    """Return a function that starts the simulated rover, with a log of its motors."""
    started: list[Vehicle] = []

    def start(port: int) -> Vehicle:
        started.append(Vehicle(tmp_path, port))
        return started[-1]

    yield start
    for each in started:
        each.end()


def drive(terminal: Tmux, vehicle: Vehicle) -> None:
    """Release the key, show Drive, choose MANUAL, hold the key until the wheels turn."""
    terminal.press_until("F1", lambda screen: "HOLD to drive" in screen)
    select.select([], [], [], LET_GO)
    terminal.press("1")
    terminal.drive_until(lambda _: vehicle.at_full())


def shows_or_holds(words: Sequence[str], screen: str) -> bool:
    """Return whether all words are on a screen, or its title shows HOLD."""
    return all(each in screen for each in words) or in_hold(screen)


def in_hold(screen: str) -> bool:
    """Return whether the title shows HOLD."""
    return " HOLD " in screen.partition("\n")[0]


def stands_on_all_screens(terminal: Tmux, vehicle: Vehicle) -> bool:
    """Show each screen with the key held, then Drive; the wheels must not turn there.

    Return False if there was a pause between two repeats as before a new press: then they may turn. Return False, too,
    if the vehicle has changed to HOLD: a late station was lost to it.
    """
    stood, terminal.longest_pause = 0.0, 0.0
    for row in OTHERS:
        terminal.press("C-g", row.digit)  # in one read, as a fast typist's
        words = (NARROW_TITLES[row.id], "neutral", "! ", " ARMED")
        if in_hold(terminal.until(partial(shows_or_holds, words), PATIENCE, holding=HELD)):
            return False
        terminal.until(lambda _: vehicle.stands(), PATIENCE, holding=HELD)
        stood = stood or time.monotonic()
    terminal.press("C-g", "1")
    terminal.until(
        lambda screen: "one is held from before" in screen or vehicle.moved_since(stood), PATIENCE, holding=HELD
    )
    pause = terminal.longest_pause
    assert not vehicle.moved_since(stood) or pause >= PRESS_WINDOW, f"it drives after pauses of {pause:.2f} s at most"
    return pause < PRESS_WINDOW and not vehicle.moved_since(stood)


def test_a_key_held_over_all_screens_drives_on_drive_only(
    tmux: Callable[..., Tmux], rover: Callable[[int], Vehicle]
) -> None:
    port = free_port()
    terminal = tmux(80, 24, f"udpin:127.0.0.1:{port}")
    vehicle = rover(port)
    terminal.until(lambda screen: "hold r to arm" in screen, PATIENCE)
    terminal.hold_until("r", lambda screen: "hold i to drive" in screen, PATIENCE)
    for _ in range(TRIES):
        drive(terminal, vehicle)
        if stands_on_all_screens(terminal, vehicle):
            break
    else:
        pytest.fail(f"no {TRIES} times without a pause of {PRESS_WINDOW} s in the repeats of the key")
    drive(terminal, vehicle)

    terminal.press("C-g", OTHERS[-1].digit)
    terminal.until(lambda screen: NARROW_TITLES[OTHERS[-1].id] in screen, PATIENCE)
    terminal.press("!")
    terminal.until(lambda screen: "EMERGENCY STOP" in screen and vehicle.stands(), PATIENCE)
    terminal.press("C-g", "1")
    stood = time.monotonic()
    terminal.until(lambda screen: "Hold t to release it" in screen, PATIENCE, holding=HELD)
    assert not vehicle.moved_since(stood)
    terminal.press("C-q")
    assert "Traceback" not in terminal.until(lambda screen: "EXIT CODE" in screen, PATIENCE)
