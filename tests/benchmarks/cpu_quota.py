"""Give a running process a tenth of a core: by a quota of the kernel, or by stopping and continuing it.

The kernel's quota (cgroup) is 1 ms in 10 ms: it accepts no quota below 1 ms, and enforces one at the ticks of its
clock (4 ms), so that a longer piece of work goes through and is paid back afterwards. Stopping and continuing
(SIGSTOP, SIGCONT) lets the process run 0.5 ms of each 5 ms whether it has work or not, as a core would that is shared
in fixed slices. It asks more of the process: what happens outside the slice waits for the next one.

Usage of the second one: python -m tests.benchmarks.cpu_quota PID
"""

from __future__ import annotations

import ctypes
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from pathlib import Path

from tests.benchmarks.figures import BenchmarkSkippedError
from tests.benchmarks.programs import python

RUN, PERIOD = 0.0005, 0.005
"""s of each period in which a stopped and continued process runs."""
QUOTA_US, PERIOD_US = 1000, 10_000
"""The smallest quota that the kernel accepts, and the period of which it is a tenth."""
CGROUPS = (Path("/sys/fs/cgroup/cpu"), Path("/sys/fs/cgroup"))
"""Version 1 has a tree for each controller, version 2 one for all."""
PRIORITY = 20
NICENESS = -20
"""Of the limited process, so that the load of the machine takes none of its tenth."""
PR_SET_TIMERSLACK = 29

Begin = Callable[[], object]
Limit = Callable[[int], AbstractContextManager[Begin]]
"""Given the id of a process, yields what limits it from then on, at once, as long as the context lasts."""


def favour(pid: int) -> None:
    """Let the process run before others where that is allowed (root)."""
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, pid, NICENESS)


@contextmanager
def whole_core(pid: int) -> Iterator[Begin]:
    """Limit nothing."""
    yield lambda: None


@contextmanager
def kernel_quota(pid: int) -> Iterator[Begin]:
    """Move the process into a group with a quota. Raises BenchmarkSkippedError where that is not allowed."""
    parent = next((each for each in CGROUPS if (each / "cgroup.procs").exists()), None)
    if parent is None:
        raise BenchmarkSkippedError("no control groups for CPU under /sys/fs/cgroup")
    group = parent / f"mavhelm-bench-{pid}"
    try:
        group.mkdir()
        (group / "cgroup.procs").write_text(str(pid))
    except OSError as error:
        with suppress(OSError):
            group.rmdir()
        raise BenchmarkSkippedError(f"{group}: {error.strerror}; a CPU quota needs root") from error
    try:
        yield partial(_set_quota, group)
    finally:
        with suppress(OSError):  # the process has ended
            (parent / "cgroup.procs").write_text(str(pid))
        group.rmdir()


def _set_quota(group: Path) -> None:
    if (group / "cpu.max").exists():
        (group / "cpu.max").write_text(f"{QUOTA_US} {PERIOD_US}")
    else:
        (group / "cpu.cfs_period_us").write_text(str(PERIOD_US))
        (group / "cpu.cfs_quota_us").write_text(str(QUOTA_US))


@contextmanager
def slices(pid: int) -> Iterator[Begin]:
    """Stop and continue the process from another one. Raises BenchmarkSkippedError if that did not begin."""
    with subprocess.Popen(
        python("tests.benchmarks.cpu_quota", str(pid)), stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0
    ) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        try:
            if not child.stdout.readline():
                raise BenchmarkSkippedError(
                    "the process that stops and continues the vehicle did not begin; it needs root"
                )
            yield partial(child.stdin.write, b"\n")
        finally:
            child.terminate()
            child.wait()
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)


def _run_slices(pid: int) -> None:
    """Stop and continue, from the first line on standard input until SIGTERM or the end of the process."""
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    ctypes.CDLL(None).prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0)
    print("ready", flush=True)
    if not sys.stdin.readline():
        return
    due = time.monotonic()
    with suppress(ProcessLookupError):
        while True:
            os.kill(pid, signal.SIGCONT)
            _sleep_until(due + RUN)
            os.kill(pid, signal.SIGSTOP)
            due = max(due + PERIOD, time.monotonic())
            _sleep_until(due)


def _sleep_until(due: float) -> None:
    select.select([], [], [], max(0.0, due - time.monotonic()))


if __name__ == "__main__":
    _run_slices(int(sys.argv[1]))
