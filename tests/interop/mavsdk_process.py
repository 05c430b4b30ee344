"""mavsdk_client.py with one of its scenarios, as a process that prints its steps."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import pytest

from tests.interop.conversation import end
from tests.waits import Waits

ROOT = Path(__file__).parents[2]
PATIENCE = 150.0
"""s for a step: longer than MAVSDK's own limits."""

needed = pytest.mark.skipif(
    importlib.util.find_spec("mavsdk") is None and "MAVHELM_CI" not in os.environ,
    reason='MAVSDK is not installed: pip install -e ".[interop]"',
)


class Step(NamedTuple):
    """The result of a step of the script."""

    name: str
    value: object
    error: str | None
    took: float


class Client:
    """The process. A thread reads its output, so that the process never blocks."""

    def __init__(self, port: int | str, scenario: str, folder: Path, system: int = 245) -> None:
        self._log = folder / f"mavsdk-{system}.log"
        with self._log.open("w") as log:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "tests.interop.mavsdk_client", str(port), scenario, str(folder), str(system)],
                cwd=folder,
                env={**os.environ, "PYTHONPATH": str(ROOT)},
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                text=True,
            )
        self.waits = Waits(self._process.pid)
        """How long the machine delays the script."""
        self.discovery = 0.0
        """s in which MAVSDK found the vehicle."""
        self._changed = threading.Condition()
        self._steps: list[Step] = []
        self._ended = False
        self._thread = threading.Thread(target=self._listen, name="mavsdk", daemon=True)
        self._thread.start()

    def step(self, name: str, value: str = "", within: float = PATIENCE) -> Step:
        """Wait for a step of that name with a value that matches; each step is returned once."""
        deadline = time.monotonic() + within
        with self._changed:
            while (found := self._find(name, value)) is None:
                left = deadline - time.monotonic()
                if left <= 0 or self._ended:
                    raise AssertionError(f"no {name!r} {value}\n{self._steps}\n{self._log.read_text()}")
                self._changed.wait(left)
            self._steps.remove(found)
            return found

    def good(self, name: str) -> Step:
        """Wait for a step that must succeed."""
        step = self.step(name)
        assert step.error is None, f"{name}: {step.error}\n{self._log.read_text()}"
        return step

    def say(self, line: str = "") -> None:
        """Send the line that the script waits for."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{line}\n")
        self._process.stdin.flush()

    def end(self) -> None:
        """End the process in any state."""
        end(self._process, self._thread)

    def _find(self, name: str, value: str) -> Step | None:
        return next((each for each in self._steps if each.name == name and re.search(value, str(each.value))), None)

    def _listen(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            told = json.loads(line)
            with self._changed:
                self._steps.append(Step(told["step"], told["value"], told["error"], told["took"]))
                self._changed.notify_all()
        with self._changed:
            self._ended = True
            self._changed.notify_all()


@contextmanager
def started(port: int, scenario: str, folder: Path, system: int = 245) -> Iterator[Client]:
    """Start the process and wait until it has found the vehicle."""
    client = Client(port, scenario, folder, system)
    try:
        client.good("discover")
        yield client
    finally:
        client.end()
