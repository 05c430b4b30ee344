"""A verb that drives, as a process: it leaves no demand when it is interrupted, killed or stopped."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from tests.fakes.lines import on_line
from tests.fakes.rover import LONG_LATCH, FakeArduPilot
from tests.ports import free_port
from tests.waits import PATIENCE, wait_until


@contextmanager
def driving(*words: str) -> Iterator[tuple[FakeArduPilot, subprocess.Popen[str]]]:
    """An armed vehicle that holds a demand for LONG_LATCH as ArduPilot does, driven by the real program."""
    core = FakeArduPilot(station=254, latch=LONG_LATCH)
    core.armed = True
    endpoint = f"udpin:127.0.0.1:{free_port()}"
    command = [sys.executable, "-m", "groundstation", *words, "-e", endpoint]
    with on_line(core, endpoint=endpoint), subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        try:
            wait_until(lambda: core.moves, "the wheels do not turn")
            yield core, process
        finally:
            process.kill()


def check_signal(number: signal.Signals, *words: str) -> None:
    """Let the wheels turn, send a signal that ends the process, see them stop before the vehicle's own time."""
    with driving(*words) as (core, process):
        _stop(core, process, number)
        assert process.wait(PATIENCE) == (-9 if number == signal.SIGKILL else 128 + number)
        assert "Traceback" not in _errors(process)


def check_standstill(*words: str) -> None:
    """Let the wheels turn and stop the process: the wheels stop, and do not turn when it goes on."""
    with driving(*words) as (core, process):
        _stop(core, process, signal.SIGSTOP)
        changes = len(core.turning)
        process.send_signal(signal.SIGCONT)
        assert process.wait(PATIENCE) == 1
        assert len(core.turning) == changes, core.turning
        assert "stood still" in _errors(process)


def _stop(core: FakeArduPilot, process: subprocess.Popen[str], number: signal.Signals) -> None:
    process.send_signal(number)
    at = time.monotonic()
    wait_until(lambda: not core.moves, "the wheels turn on")
    assert core.stopped_at - at < LONG_LATCH / 2


def _errors(process: subprocess.Popen[str]) -> str:
    return process.stderr.read() if process.stderr else ""
