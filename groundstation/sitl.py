"""The simulated rover as a child process: started on request, watched, and ended with us. It shares no code with us."""

from __future__ import annotations

import ctypes
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Callable

from groundstation.processes import end_process, start_module

PR_SET_PDEATHSIG = 1
"""prctl(2): the kernel sends a signal when the parent dies, even by kill -9."""

END_TIMEOUT = 1.0
"""s for the simulator to stop its motors and end, before it is killed."""

KEPT = 4000
"""Bytes of its output that are looked at: the last words, with a traceback."""


def free_port() -> int:
    """A UDP port of the loopback that nobody uses now. Should somebody take it first, the link says so."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Simulator:
    """One `vehicle --sim`. What it prints is kept; the last line is the reason when it ends."""

    def __init__(self, host: str, port: int) -> None:
        """Start it, sending to an address of this machine. Raises OSError."""
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  # it has no name: nothing is left behind, come what may
        self._process: subprocess.Popen[bytes] = start_module(
            "vehicle",
            ["--sim", f"udpout:{host}:{port}"],
            output=self._output,
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
        lines = self.output_tail.strip().split("\n")
        return f"{how}: {lines[-1]}" if lines[-1] else how

    @property
    def output_tail(self) -> str:
        """The end of what it printed."""
        size = os.fstat(self._output.fileno()).st_size
        return os.pread(self._output.fileno(), KEPT, max(0, size - KEPT)).decode("utf-8", "replace")

    def close(self) -> None:
        """End it."""
        if self.running:
            self._process.terminate()
            end_process(self._process, END_TIMEOUT)
        self._output.close()


def _die_with_parent() -> Callable[[], None] | None:
    """What the child does first: ask the kernel to be terminated with us. Only Linux has it."""
    if not sys.platform.startswith("linux"):
        return None
    prctl = ctypes.CDLL(None).prctl  # looked up before the fork: after it, as little as possible may run

    def prepare() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGTERM)

    return prepare
