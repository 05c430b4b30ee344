"""Memory and CPU time of a program and all its children, from /proc. Linux only."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

PAGE = os.sysconf("SC_PAGE_SIZE")
CPU_CLOCK = 2
"""Kind of the clock in the id of a process's clock, as clock_getcpuclockid() builds it: exact time of all threads."""


class Memory(NamedTuple):
    """MiB of all processes together."""

    rss: float
    """Resident; pages shared by processes are counted for each."""
    pss: float
    """The same, each shared page divided by the number of processes that share it."""


def family(pid: int) -> list[int]:
    """Return a process and all its descendants."""
    children: dict[int, list[int]] = {}
    for each in _all():
        parent = _parent(each)
        if parent is not None:
            children.setdefault(parent, []).append(each)
    found = [pid]
    for each in found:
        found += children.get(each, [])
    return found


def memory(pids: list[int]) -> Memory:
    """Return the memory of all `pids` together."""
    return Memory(sum(_rss(pid) for pid in pids), sum(_pss(pid) for pid in pids))


def cpu_seconds(pids: list[int]) -> float:
    """Return the user and system time that `pids` have used so far, s, with that of threads that have ended."""
    return sum(time.clock_gettime(~pid << 3 | CPU_CLOCK) for pid in pids)


def _all() -> Iterator[int]:
    return (int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdecimal())


def _fields(pid: int) -> list[str]:
    """Return /proc/PID/stat from its third field on; the second may contain anything."""
    return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()


def _parent(pid: int) -> int | None:
    try:
        return int(_fields(pid)[1])
    except OSError:
        return None  # the process has ended


def _rss(pid: int) -> float:
    return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * PAGE / 2**20


def _pss(pid: int) -> float:
    for line in Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines():
        if line.startswith("Pss:"):
            return int(line.split()[1]) / 1024
    return 0.0
