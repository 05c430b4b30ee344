"""Times at which different parts of a program, and different programs, wake together."""

from __future__ import annotations


def next_multiple(period: float, now: float) -> float:
    """Return the next time that is a multiple of a period: what is done at the same rate is then done at one waking.

    A timer may be a moment early: then it is the one after that.
    """
    return ((now + period / 100) // period + 1) * period
