"""How long a busy machine delayed programs: the time that they were ready to run without a processor (Linux schedstat).

A bound on a time is the programs' own; the delays of a shared machine are added to it, and no more.
"""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

SECOND = 1e-9
"""The kernel counts ns here (/proc/PID/task/TID/schedstat, the second number)."""


class Waits:
    """The delays of processes, their children and this process: all their threads, from now on.

    Call `total` now and then: of a thread that has ended, only what was read before is known. Without CONFIG_SCHED_INFO
    in the kernel, it is 0.
    """

    def __init__(self, *processes: int) -> None:
        self._processes = (os.getpid(), *processes)
        self._begun: dict[str, float] = {}
        self._now: dict[str, float] = {}
        self.total()
        self._begun = dict(self._now)

    def total(self) -> float:
        """Return the s so far, of all threads together, and the time that other guests of the machine took."""
        for process in self._processes:
            self._look(process)
            for child in _children(process) if process != os.getpid() else ():
                self._look(child)
        self._now["stolen"] = _stolen()
        return sum(waited - self._begun.get(thread, 0.0) for thread, waited in self._now.items())

    def _look(self, process: int) -> None:
        with suppress(OSError):
            for task in Path(f"/proc/{process}/task").iterdir():
                with suppress(OSError):
                    self._now[task.name] = int((task / "schedstat").read_text().split()[1]) * SECOND


def _children(process: int) -> list[int]:
    with suppress(OSError):
        return [int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    return []


def _stolen() -> float:
    """Return the stolen s of all processors together (/proc/stat, the eighth number of its first line)."""
    return int(Path("/proc/stat").read_text().split(maxsplit=9)[8]) / os.sysconf("SC_CLK_TCK")
