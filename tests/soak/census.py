"""What each process of a soak uses: memory, descriptors, threads, over time."""

from __future__ import annotations

import os
from bisect import bisect_left
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from statistics import linear_regression, median

from tests.benchmarks.procfs import cpu_seconds, memory

WARM_UPS = (180.0, 600.0, 1200.0, 1800.0)
"""s of the life of a process that a slope does not count: histories fill up to their bound at the start. All slopes are
reported; the last one that has LEAST is judged, and what goes on growing grows there, too. The slowest is the log of a
station: in the weather of a soak 69 lines of 350 bytes come in a minute, 1.4 MB/h, 2000 of them in 29 min."""
LEAST = 300.0
"""s behind the warm-up that a slope needs."""
MAX_GROWTH = 1.0
"""MB in an hour."""
HOUR = 3600.0


@dataclass
class Life:
    """One process from its start to its end."""

    role: str
    pid: int
    began: float
    times: list[float] = field(default_factory=list)
    """s since `began`."""
    rss: list[float] = field(default_factory=list)
    """MiB."""
    pss: list[float] = field(default_factory=list)
    descriptors: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)
    cpu: float = 0.0
    """s so far."""

    def look(self, now: float) -> None:
        """Add a sample; none if the process has just ended."""
        with suppress(OSError, IndexError):
            used = memory([self.pid])
            descriptors = len(os.listdir(f"/proc/{self.pid}/fd"))
            threads = len(os.listdir(f"/proc/{self.pid}/task"))
            self.cpu = cpu_seconds([self.pid])
            self.times.append(now - self.began)
            self.rss.append(used.rss)
            self.pss.append(used.pss)
            self.descriptors.append(descriptors)
            self.threads.append(threads)

    def behind(self, warm_up: float) -> slice:
        """Return which samples are behind a warm-up."""
        return slice(bisect_left(self.times, warm_up), None)

    def growth(self, of: Sequence[float]) -> list[float]:
        """Return the slopes behind the warm-ups, MB/h, without those that are too short."""
        found = []
        for kept in map(self.behind, WARM_UPS):
            times = self.times[kept]
            if times and times[-1] - times[0] >= LEAST:
                found.append(linear_regression(times, of[kept]).slope * HOUR)
        return found

    def report(self) -> dict[str, object]:
        """Return its figures for the report."""
        kept = self.behind(WARM_UPS[0]) if self.growth(self.rss) else slice(None)
        return {
            "role": self.role,
            "seconds": round(self.times[-1], 1),
            "cpu %": round(100 * self.cpu / max(1.0, self.times[-1]), 2),
            "rss MB": [round(self.rss[kept][at], 2) for at in (0, -1)],
            "pss MB": [round(self.pss[kept][at], 2) for at in (0, -1)],
            "rss MB/h": _rounded(self.growth(self.rss)),
            "pss MB/h": _rounded(self.growth(self.pss)),
            "descriptors": [self.descriptors[kept][0], self.descriptors[-1], max(self.descriptors[kept])],
            "threads": [self.threads[kept][0], self.threads[-1], max(self.threads[kept])],
        }

    def faults(self) -> list[str]:
        """Return what grows, of a life that is long enough to tell.

        Memory grows if RSS and PSS do: RSS alone grows when a process touches pages that it shares with its parent,
        PSS alone when a process that shared them has ended.
        """
        slopes = [min(both) for both in zip(self.growth(self.rss), self.growth(self.pss), strict=True)]
        if not slopes:
            return []
        found = [f"{self.role} grows by {slopes[-1]:.2f} MB/h"] if slopes[-1] > MAX_GROWTH else []
        for name, values in (("descriptors", self.descriptors), ("threads", self.threads)):
            kept = values[self.behind(WARM_UPS[0])]
            half = len(kept) // 2  # one that is open for a moment is not a leak
            if median(kept[half:]) > median(kept[:half]):
                found.append(f"{self.role}: {name} grew from {kept[0]} to {kept[-1]}")
        return found


class Census:
    """All lives so far."""

    def __init__(self) -> None:
        self.lives: dict[int, Life] = {}

    def look(self, processes: dict[str, int], now: float) -> None:
        """Add a sample of each process that runs."""
        for role, pid in processes.items():
            life = self.lives.get(pid)
            if life is None and Path(f"/proc/{pid}").exists():
                life = self.lives[pid] = Life(role, pid, now)
            if life is not None:
                life.look(now)

    def report(self) -> list[dict[str, object]]:
        """Return the longest life of each role."""
        longest: dict[str, Life] = {}
        for life in self.lives.values():
            if life.times and life.times[-1] >= (longest[life.role].times[-1] if life.role in longest else 0.0):
                longest[life.role] = life
        return [life.report() for life in longest.values()]

    def faults(self) -> list[str]:
        """Return what grows."""
        return [fault for life in self.lives.values() if life.times for fault in life.faults()]

    def cpu(self) -> float:
        """Return the CPU time of all of them, s."""
        return sum(life.cpu for life in self.lives.values())


def _rounded(values: list[float]) -> list[float]:
    return [round(each, 3) for each in values]
