"""Keep every core busy: a process for each that computes and never waits."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

BURN = "import os, sys\nwhile os.getppid() == int(sys.argv[1]):\n    sum(range(100_000))\n"
"""Ends by itself soon after its parent, whose id it gets, also after a kill -9 of it."""


@contextmanager
def busy_cores(count: int | None = None) -> Iterator[list[subprocess.Popen[bytes]]]:
    """Run `count` burners, one for each core by default, and end them."""
    count = len(os.sched_getaffinity(0)) if count is None else count
    burners = [subprocess.Popen([sys.executable, "-S", "-c", BURN, str(os.getpid())]) for _ in range(count)]
    try:
        yield burners
    finally:
        for burner in burners:
            burner.kill()
        for burner in burners:
            burner.wait()
