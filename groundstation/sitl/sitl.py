"""Runs the simulated rover (`mavhelm vehicle --sim`) as a child process that ends with it. Imports nothing of it."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import tempfile
from collections.abc import Sequence

from groundstation.sitl.simulators import find_simulator, find_system
from link.endpoint import Endpoint
from link.runtime.child_process import end_process, start_module

END_TIMEOUT = 1.0
"""s for the simulator to stop its motors and exit before it is killed."""

WILDCARD_HOSTS = ("0.0.0.0", "::")
"""Hosts that mean "all addresses of this machine"; nothing can be sent to them."""

TAIL_SIZE = 4000
"""Bytes of its output that are read: the last lines, with a traceback."""


def free_port() -> int:
    """Return a free UDP port of the loopback. If another program takes it first, opening the link fails."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


class Simulator:
    """One `mavhelm vehicle --sim`. Its output is kept; the last line is the reason when it exits.

    It records its drives, as a real rover does, so that they can be listed and downloaded until it ends.
    """

    def __init__(self, host: str, port: int, options: Sequence[str] = ()) -> None:
        """Start the simulator, sending to an address of this machine. Raises OSError."""
        self.system = find_system(options)
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  # it has no name, so nothing is left behind even after a kill
        self._logs = tempfile.TemporaryDirectory(prefix="mavhelm-simulator-", ignore_cleanup_errors=True)
        self._process: subprocess.Popen[bytes] = start_module(
            "vehicle",
            ["--sim", f"udpout:{host}:{port}", "--tlog", self._logs.name, *options],
            output=self._output,
            new_session=True,  # Ctrl-C in the terminal is for the screen only
            ends_with_us=True,
        )

    @property
    def running(self) -> bool:
        """The process has not exited."""
        return self._process.poll() is None

    @property
    def state(self) -> str:
        """Status for the screen: "running", or how the process ended."""
        code = self._process.poll()
        if code is None:
            return "running"
        how = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        lines = self.output_tail.strip().split("\n")
        return f"{how}: {lines[-1]}" if lines[-1] else how

    @property
    def output_tail(self) -> str:
        """The end of its output."""
        size = os.fstat(self._output.fileno()).st_size
        return os.pread(self._output.fileno(), TAIL_SIZE, max(0, size - TAIL_SIZE)).decode("utf-8", "replace")

    def close(self) -> None:
        """Stop the simulator."""
        if self.running:
            self._process.terminate()
            end_process(self._process, END_TIMEOUT)
        self._output.close()
        self._logs.cleanup()


class SimulatorControl:
    """Starts the simulators of one row at a time and reports once when one of them exits."""

    def __init__(self) -> None:
        self._simulators: list[Simulator] = []
        self._reported: list[Simulator] = []

    def start(
        self, endpoints: Sequence[Endpoint], kind: str = "rover", options: Sequence[Sequence[str]] = ()
    ) -> str | None:
        """Start simulators that send to the first endpoint that listens. Returns an error text, or None.

        While one of ours runs, nothing is started. `options`: one rover with each of them, in place of those of `kind`.
        """
        if self.running:
            return None
        endpoint = next((each for each in endpoints if each.scheme == "udpin"), None)
        if endpoint is None:
            return "the simulator needs a link that listens, e.g. udpin:127.0.0.1:14550"
        host = "127.0.0.1" if endpoint.host in WILDCARD_HOSTS else endpoint.host
        self.close()
        try:
            for each in options or find_simulator(kind).options:
                self._simulators.append(Simulator(host, endpoint.port, each))
        except OSError as error:
            return f"simulator did not start: {error.strerror}"
        return None

    @property
    def running(self) -> bool:
        """Any simulator of ours runs."""
        return any(each.running for each in self._simulators)

    @property
    def systems(self) -> frozenset[int]:
        """System ids of those that run."""
        return frozenset(each.system for each in self._simulators if each.running)

    @property
    def state(self) -> str | None:
        """Status for the screen: of one that has exited, else "running"; None if no simulator was started."""
        states = [each.state for each in self._simulators]
        return next((state for state in states if state != "running"), states[0]) if states else None

    def pop_exit(self) -> tuple[str, str] | None:
        """Return how a simulator exited and the end of its output, once; None while they run."""
        for each in self._simulators:
            if not each.running and each not in self._reported:
                self._reported.append(each)
                return f"simulator {each.state}", each.output_tail
        return None

    def close(self) -> None:
        """Stop the simulators."""
        for each in self._simulators:
            each.close()
        self._simulators, self._reported = [], []
