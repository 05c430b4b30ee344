"""Settings of the interpreter for the screen's process: what may hold the input thread back."""

from __future__ import annotations

import gc
import sys
import time

SWITCH_INTERVAL, PYTHONS_OWN = 0.0005, 0.005
"""s for which drawing may keep the interpreter from the input thread, while the operator drives and else.

Python's own are longer than most drawings take: a key that came during one waited for its end. The short one costs a
quarter of the process's time at 1000 messages/s, because the threads of the terminal interrupt each other.
"""

NEW_OBJECTS = 2_000
"""New objects after which they are collected. No thread runs meanwhile: 10,000 took 3 to 4 ms, these take 1."""
OLDER_AFTER, OLDEST_AFTER = 5, 8
"""Collections after which objects that have outlived one are collected as well (3 ms), and all others (20 ms, at most
every 30 s).

Textual's lines refer to themselves, so that only a collection frees them. After 20 collections of 10,000, all that was
on the screen in 20 minutes of driving was still in memory.
"""

LONG_PASS, NEVER = 0.05, 1_000_000
"""s of a pass over all objects, after which there is none while the operator drives: many screens that were visited
made it 0.6 s, and the lease of the screen is 0.3 s."""


class FullPasses:
    """How long the last pass over all objects took."""

    def __init__(self) -> None:
        self.took = 0.0
        self._began = 0.0

    def note(self, phase: str, info: dict[str, int]) -> None:
        """Handle a call of gc.callbacks."""
        if info["generation"] == 2:
            if phase == "start":
                self._began = time.monotonic()
            else:
                self.took = time.monotonic() - self._began


_PASSES = FullPasses()


def favour_input(wanted: bool) -> None:
    """Let a thread that waits for a key have the interpreter soon after the key has arrived; else as Python does."""
    interval = SWITCH_INTERVAL if wanted else PYTHONS_OWN
    if sys.getswitchinterval() != interval:
        sys.setswitchinterval(interval)
    new, older, oldest = gc.get_threshold()
    if new == NEW_OBJECTS:  # after freeze()
        after = NEVER if wanted and _PASSES.took > LONG_PASS else OLDEST_AFTER
        if after != oldest:
            gc.set_threshold(new, older, after)


def freeze() -> None:
    """Exempt the objects that exist now from garbage collection: a pass over them took 28-61 ms."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(NEW_OBJECTS, OLDER_AFTER, OLDEST_AFTER)
    if _PASSES.note not in gc.callbacks:
        gc.callbacks.append(_PASSES.note)
