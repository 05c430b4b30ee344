"""ApiProcess: the process `mavhelm api` of one program, and its simulator.

It imports neither asyncio nor the protocol: those of the program are imported while the process starts.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from typing import IO, TYPE_CHECKING

from groundstation.config.defaults import ENDPOINT_VARIABLE
from groundstation.rover.errors import RoverError
from link.runtime.child_process import child_environment

if TYPE_CHECKING:
    from groundstation.sitl.sitl import SimulatorControl

TAIL_SIZE = 4000
"""Bytes of what it has printed to stderr that are read."""
SITL_WAIT = 10.0
"""s for a simulator to start."""


class ApiProcess:
    """What a Rover runs: see AsyncRover for the arguments. `simulated`: with a rover that ends with it."""

    def __init__(
        self,
        endpoints: Sequence[str] = (),
        vehicle: int | str | None = None,
        wait: float = SITL_WAIT,
        *,
        stay_armed: bool = False,
        simulated: bool = False,
    ) -> None:
        self._arguments = ["--wait", f"{wait:g}", *(word for each in endpoints for word in ("-e", each))]
        self._arguments += [] if vehicle is None else ["-v", str(vehicle)]
        self._arguments += ["--stay-armed"] if stay_armed else []
        self._simulated = simulated
        self._simulator: SimulatorControl | None = None
        self._errors: IO[bytes] | None = None
        self._last_error = "no error was printed"
        self.running: subprocess.Popen[bytes] | None = None
        """The process, from `start` on."""

    def start(self) -> subprocess.Popen[bytes]:
        """Start it, and its simulator. Raises RoverError."""
        environment, arguments = child_environment(), list(self._arguments)
        if self._simulated:
            environment[ENDPOINT_VARIABLE] = self._start_simulator()  # not -e, which is remembered as used last
            arguments += ["--station", "never"]
        self._errors = _open_unnamed()  # not a pipe, which the watchdog of a killed one keeps open
        # -P: a folder named like one of our packages in the current directory must not be imported instead of ours.
        self.running = subprocess.Popen(
            [sys.executable, "-P", "-m", "groundstation", "api", *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, bufsize=0, env=environment,
            process_group=0,  # a Ctrl-C is for the program, which ends it in order
        )  # fmt: skip
        return self.running

    def close(self) -> None:
        """End the simulator, if there is one, and keep no file open. The process has ended."""
        if self._simulator is not None:
            self._simulator.close()
        if self._errors is not None:
            self._last_error = self.last_error
            self._errors.close()
            self._errors = None

    @property
    def last_error(self) -> str:
        """The last line that it has printed to stderr."""
        if self._errors is None:
            return self._last_error
        size = os.fstat(self._errors.fileno()).st_size
        tail = os.pread(self._errors.fileno(), TAIL_SIZE, max(0, size - TAIL_SIZE)).decode(errors="replace")
        return tail.strip().rpartition("\n")[2].removeprefix("mavhelm: ") or "no error was printed"

    def _start_simulator(self) -> str:
        """Start it; return where it is heard. Raises RoverError."""
        from groundstation.sitl.sitl import SimulatorControl, free_port
        from link.endpoint import parse_endpoint

        self._simulator = SimulatorControl()
        endpoint = f"udpin:127.0.0.1:{free_port()}"
        if problem := self._simulator.start([parse_endpoint(endpoint)]):
            raise RoverError(problem)
        return endpoint


def _open_unnamed() -> IO[bytes]:
    """Open a file without a name."""
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("mavhelm-errors"), "w+b")
    import tempfile  # where it must be: the start of a program waits for it

    return tempfile.TemporaryFile()
