"""What the interpreter lets a thread that reads keys wait for, beside one that draws."""

from __future__ import annotations

import gc
import sys
import time
from collections import deque
from collections.abc import Iterator
from threading import Thread

import pytest

from groundstation.ui.terminal import interpreter
from groundstation.ui.terminal.interpreter import favour_input

PYTHONS_OWN = 0.005
"""s, the switch interval without a setting."""


OBJECTS = 20
"""Of a line, with its segments and caches."""
SHOWN = 150
"""Lines that are kept at a time."""


@pytest.fixture(autouse=True)
def _settings() -> Iterator[None]:
    before, thresholds = sys.getswitchinterval(), gc.get_threshold()
    sys.setswitchinterval(PYTHONS_OWN)
    yield
    sys.setswitchinterval(before)
    gc.set_threshold(*thresholds)
    gc.unfreeze()


class DrawnLine:
    """Refers to itself, as a Strip of Textual does that was cropped to its own size."""

    def __init__(self) -> None:
        self.cropped = [self]
        self.segments = [[number] for number in range(OBJECTS - 2)]


def most_kept(drawn: int) -> int:
    """Return the most objects that exist at a time while so many lines are drawn."""
    shown, before, most = deque[DrawnLine](maxlen=SHOWN), sys.getallocatedblocks(), 0
    for number in range(drawn):
        shown.append(DrawnLine())
        if number % 100 == 0:
            most = max(most, sys.getallocatedblocks() - before)
    return most


def waits_for_a_busy_thread(times: int) -> list[float]:
    """Return the s for which a thread that wakes up waits for this one, which is busy."""
    waits: list[float] = []

    def wait() -> None:
        for _ in range(times):
            due = time.monotonic() + 0.005
            time.sleep(0.005)
            waits.append(time.monotonic() - due)

    thread = Thread(target=wait)
    thread.start()
    while thread.is_alive():
        pass
    return waits


def test_a_key_does_not_wait_until_something_is_drawn() -> None:
    assert max(waits_for_a_busy_thread(10)) >= 0.8 * PYTHONS_OWN  # what a drawing takes from a key without the setting
    favour_input(True)
    assert min(waits_for_a_busy_thread(60)) < 0.5 * PYTHONS_OWN  # the least: other programs take time, too


def test_a_screen_that_does_not_drive_draws_uninterrupted() -> None:
    favour_input(True)
    favour_input(False)
    assert sys.getswitchinterval() == pytest.approx(PYTHONS_OWN)


def test_lines_that_are_no_longer_shown_are_soon_freed() -> None:
    interpreter.freeze()
    gc.set_threshold(10_000, 20, 20)
    assert most_kept(30_000) > 40 * SHOWN * OBJECTS, "of all lines that outlived a collection"
    interpreter.freeze()
    assert most_kept(30_000) < 30 * SHOWN * OBJECTS
