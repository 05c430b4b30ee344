"""The simulated rover as a child process: started on request, watched, and ended with us. It shares no code with us."""

from __future__ import annotations

import ctypes
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from groundstation.processes import end_process, start_module

PR_SET_PDEATHSIG = 1
"""prctl(2): the kernel sends a signal when the parent dies, even by kill -9."""

END_TIMEOUT = 1.0
"""s for the simulator to stop its motors and end, before it is killed."""


def free_port() -> int:
    """A UDP port of the loopback that nobody uses now. Should somebody take it first, the link says so."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Simulator:
    """One `vehicle --sim`. What it prints goes to a file; its last line is the reason when it ends."""

    def __init__(self, host: str, port: int) -> None:
        """Start it, sending to an address of this machine. Raises OSError."""
        with tempfile.NamedTemporaryFile(prefix="mavhelm-sim-", suffix=".log", delete=False) as output:
            self.output = Path(output.name)
            self._process: subprocess.Popen[bytes] = start_module(
                "vehicle",
                ["--sim", f"udpout:{host}:{port}"],
                output=output,
                new_session=True,  # Ctrl-C in the terminal is for the screen
                prepare=_die_with_parent(),
            )

    @property
    def running(self) -> bool:
        """It has not ended."""
        return self._process.poll() is None

    @property
    def state(self) -> str:
        """For the screen: "running", or how it ended."""
        code = self._process.poll()
        if code is None:
            return "running"
        how = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        last = _last_line(self.output)
        return f"{how}: {last}" if last else how

    def close(self) -> None:
        """End it; its output is kept only where it ended by itself."""
        if self.running:
            self._process.terminate()
            end_process(self._process, END_TIMEOUT)
            self.output.unlink(missing_ok=True)


def _die_with_parent() -> Callable[[], None] | None:
    """What the child does first: ask the kernel to be terminated with us. Only Linux has it."""
    if not sys.platform.startswith("linux"):
        return None
    prctl = ctypes.CDLL(None).prctl  # looked up before the fork: after it, as little as possible may run

    def prepare() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGTERM)

    return prepare


def _last_line(path: Path) -> str:
    try:
        lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    except OSError:
        return ""
    return next((line.strip() for line in reversed(lines) if line.strip()), "")
