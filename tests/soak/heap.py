"""What this process keeps, over virtual time: bytes that Python has allocated, blocks, and memory of the process."""

from __future__ import annotations

import gc
import os
import sys
import tracemalloc
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import linear_regression

from tests.benchmarks.procfs import memory

HOUR = 3600.0
MEGABYTE = 1 << 20


@dataclass(frozen=True, slots=True)
class Sample:
    """What is kept after `seconds` of virtual time."""

    seconds: float
    traced: int
    """Bytes by tracemalloc; 0 if it does not trace."""
    blocks: int
    rss: float
    """MB."""

    def row(self) -> tuple[float, float, int, float]:
        """Return its figures for the report: hours, MB, blocks, MB."""
        return round(self.seconds / HOUR, 2), round(self.traced / MEGABYTE, 3), self.blocks, round(self.rss, 1)


class Heap:
    """Samples of one run; bytes are traced from `start` to `stop`."""

    def __init__(self, *, trace: bool) -> None:
        self._trace = trace
        self.samples: list[Sample] = []

    def start(self) -> None:
        """Begin to trace."""
        if self._trace:
            tracemalloc.start()

    def stop(self) -> None:
        """End it."""
        tracemalloc.stop()

    def look(self, seconds: float) -> None:
        """Add a sample."""
        gc.collect()
        traced, _ = tracemalloc.get_traced_memory()
        self.samples.append(Sample(seconds, traced, sys.getallocatedblocks(), memory([os.getpid()]).rss))

    def growth(self) -> tuple[float, float, float] | None:
        """Return MB by tracemalloc, blocks, and MB of the process more in an hour, over the second half."""
        kept = self.samples[len(self.samples) // 2 :]
        if len(kept) < 3:
            return None
        times = [each.seconds for each in kept]
        traced = _slope(times, [each.traced / MEGABYTE for each in kept])
        return traced, _slope(times, [each.blocks for each in kept]), _slope(times, [each.rss for each in kept])


def _slope(times: Sequence[float], values: Sequence[float]) -> float:
    return linear_regression(times, values).slope * HOUR
