"""Waits of tests of real programs: until a condition holds, and no less patient on a busy machine than on an idle one.

`wait_until` is the one way to wait for a program, a thread or a socket. What has an event (a condition variable, a
readable file) waits for that, for at most PATIENCE. What is in virtual time waits in tests/world.py.

`Waits` measures how long a busy machine kept programs waiting for a processor (Linux schedstat). A bound on a time is
the programs' own; the delays of a shared machine are added to it, and no more.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

Value = TypeVar("Value")

PATIENCE = 120.0
"""s until a test gives up on what must come. Nothing may be asserted by it: it only ends a test that has failed.

An agent and its server start in 5 s of CPU, which take a minute where ten others want each processor, too."""
MOST_DELAYS = 3.0
"""Times the patience that delays may add: threads that wait at the same time are late by more than passes."""
POLL = 0.01
"""s between two looks."""
SHORT_POLL = 0.001
"""The least s between two looks in a loop that runs the program, too."""
SECOND = 1e-9
"""The kernel counts ns here (/proc/PID/task/TID/schedstat, the second number)."""


def wait_until(
    condition: Callable[[], Value],
    what: str | Callable[[], str] = "it",
    within: float = PATIENCE,
    *,
    each: Callable[[], object] | None = None,
) -> Value:
    """Look until `condition` returns something true, and return that.

    `each` is called between two looks in place of a pause, as to read a socket or to renew a lease; it must take a
    little time itself. Raises AssertionError with `what` after `within` s, to which the delays of this process by a
    busy machine are added.
    """
    patience, pause = Patience(within), threading.Event()
    while not (value := condition()):
        if patience.ended:
            raise AssertionError(f"not within {within:g} s: {what if isinstance(what, str) else what()}")
        if each is None:
            pause.wait(POLL)
        else:
            each()
    return value


async def until(condition: Callable[[], Value], within: float = PATIENCE) -> Value:
    """Let the event loop run until `condition` returns something true, and return that; else TimeoutError.

    The delays of this process are added to `within`, as by `wait_until`.
    """
    patience, began = Patience(within), time.monotonic()
    while not (value := condition()):
        if patience.ended:
            raise TimeoutError(f"not within {within:g} s")
        looked = time.monotonic() - began
        await asyncio.sleep(max(SHORT_POLL, 2 * looked))  # a condition that draws a screen takes 10 ms
        began = time.monotonic()
    return value


def wait_for_end(process: subprocess.Popen[Any], within: float = PATIENCE) -> int:
    """Wait until a program has ended, and return its exit code; its delays are added to `within`."""
    patience, pause = Patience(within, process.pid), threading.Event()
    while (code := process.poll()) is None:
        assert not patience.ended, f"not ended within {within:g} s: {process.args!r}"
        pause.wait(POLL)
    return int(code)


class Patience:
    """A wait of at most `within` s, to which the delays of this process and of those that are waited for are added.

    A program that starts in 2 s of CPU takes a minute where thirty others want the processor too.
    """

    def __init__(self, within: float = PATIENCE, *processes: int) -> None:
        self._within, self._began, self._waits = within, time.monotonic(), Waits(*processes)

    @property
    def ended(self) -> bool:
        """Return whether the time is over."""
        took = time.monotonic() - self._began
        return took > self._within and took > self._within + min(self._waits.total(), MOST_DELAYS * self._within)


class Waits:
    """The delays of processes, of what they have started, and of this process: all their threads, from now on.

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
            for child in _descendants(process) if process != os.getpid() else ():
                self._look(child)
        self._now["stolen"] = _stolen()
        return sum(waited - self._begun.get(thread, 0.0) for thread, waited in self._now.items())

    def _look(self, process: int) -> None:
        with suppress(OSError):
            for task in Path(f"/proc/{process}/task").iterdir():
                with suppress(OSError):
                    self._now[task.name] = int((task / "schedstat").read_text().split()[1]) * SECOND


def _descendants(process: int) -> list[int]:
    found: list[int] = []
    with suppress(OSError):
        for task in Path(f"/proc/{process}/task").iterdir():
            with suppress(OSError):
                for child in map(int, (task / "children").read_text().split()):
                    found += [child, *_descendants(child)]
    return found


def _stolen() -> float:
    """Return the stolen s of all processors together (/proc/stat, the eighth number of its first line)."""
    return int(Path("/proc/stat").read_text().split(maxsplit=9)[8]) / os.sysconf("SC_CLK_TCK")
