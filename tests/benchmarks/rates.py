"""Operations a second of CPU: contenders in turn, each round, on warm code. Not an end-to-end figure."""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from statistics import median

from tests.benchmarks.figures import ROUNDS

Work = Callable[[], None]
"""One pass over the whole input."""


def rates(contenders: Mapping[str, Work], items: int, *, quick: bool) -> dict[str, float]:
    """Return the items a second of each contender, median of the rounds. `items` are those of one pass."""
    least = 0.1 if quick else 0.6
    seen: dict[str, list[float]] = {name: [] for name in contenders}
    for _ in range(ROUNDS):
        for name, work in contenders.items():
            with _no_collections():
                seen[name].append(items * _passes_per_second(work, least))
    return {name: median(values) for name, values in seen.items()}


def _passes_per_second(work: Work, least: float) -> float:
    work()
    passes, start = 0, time.process_time()
    while (spent := time.process_time() - start) < least:
        work()
        passes += 1
    return passes / spent


@contextmanager
def _no_collections() -> Iterator[None]:
    """Collect garbage first: a full collection in the middle of one contender would be charged to it."""
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
