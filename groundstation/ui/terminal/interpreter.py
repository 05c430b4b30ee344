"""Settings of the interpreter for the screen's process: what may hold the input thread back."""

from __future__ import annotations

import gc
import sys

from link.runtime import startup_gc

SWITCH_INTERVAL, PYTHONS_OWN = 0.0005, 0.005
"""s for which drawing may keep the interpreter from the input thread, while the operator drives and else.

Python's own are longer than most drawings take: a key that came during one waited for its end. The short one costs a
quarter of the process's time at 1000 messages/s, because the threads of the terminal interrupt each other.
"""

NEW_OBJECTS = 2_000
"""New objects after which they are collected. No thread runs meanwhile: 10,000 took 3 to 4 ms, these take 1."""
OLDER_AFTER, OLDEST_AFTER = 5, 8
"""Collections after which objects that have outlived one are collected as well (3 ms), and all others.

After 20 collections of 10,000, all that was on the screen in 20 minutes of driving was still in memory.
"""


def favour_input(wanted: bool) -> None:
    """Let a thread that waits for a key have the interpreter soon after the key has arrived; else as Python does."""
    interval = SWITCH_INTERVAL if wanted else PYTHONS_OWN
    if sys.getswitchinterval() != interval:
        sys.setswitchinterval(interval)


def freeze() -> None:
    """Exempt the objects that exist now from garbage collection: a pass over them took 28-61 ms."""
    gc.collect()
    startup_gc.resume()
    gc.set_threshold(NEW_OBJECTS, OLDER_AFTER, OLDEST_AFTER)


def free_closed_screens() -> None:
    """Collect all garbage now, after freeze(): called on a screen that has just opened, where no key drives.

    A closed screen is 20,000 objects that refer to each other. Those of two or three would be a pass of 0.1 s at any
    time, and on a slower machine a third of the screen's lease.
    """
    if gc.get_threshold()[0] == NEW_OBJECTS:
        gc.collect()
