"""The programs of a soak, each of which can be killed with -9 and started again: vehicle, bridge, two stations."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol

from tests.benchmarks.procfs import family
from tests.e2e.programs import Output, Vehicle
from tests.soak.drivers import Driver, KeyDriver, SnapshotDriver
from tests.soak.rules import Stretch, stretches
from tests.waits import PATIENCE


class Member(Protocol):
    """A program of the soak."""

    name: str

    @property
    def pid(self) -> int:
        """Process id, or 0 while it does not run."""

    def start(self) -> None:
        """Start it, again if it has been killed."""

    def kill(self) -> None:
        """Kill it and its children with -9."""


class VehicleMember:
    """The simulated rover, with a motor log for each life."""

    name = "vehicle"

    def __init__(self, folder: Path, port: int, options: tuple[str, ...] = ()) -> None:
        self._folder, self._port, self._options = folder, port, options
        self._vehicle: Vehicle | None = None
        self._lives = 0
        self._read = 0
        self._last: Output | None = None
        self.killed_at: float | None = None
        """When it was killed last, while it does not run; monotonic, s."""

    @property
    def pid(self) -> int:
        return self._vehicle.process.pid if self._vehicle and self.killed_at is None else 0

    def start(self) -> None:
        self._lives += 1
        folder = self._folder / f"vehicle-{self._lives}"
        folder.mkdir()
        self._vehicle = Vehicle(folder, self._port, *self._options)
        self._read, self._last, self.killed_at = 0, None, None

    def kill(self) -> None:
        if self._vehicle and self.killed_at is None:
            self._vehicle.end()
            self.killed_at = time.monotonic()

    def complaints(self) -> str:
        """Return what the running life has printed that is more than its usual lines."""
        text = self._vehicle.errors.read_text() if self._vehicle else ""
        return text if "Traceback" in text else ""

    def new_stretches(self, now: float) -> list[Stretch]:
        """Return where motors had power since the last call; a stretch that goes on is told again, longer."""
        if self._vehicle is None:
            return []
        end = self.killed_at or now
        new = self._new_outputs()
        found = list(stretches(new, self._last, end))
        self._last = new[-1] if new else self._last
        return found

    def _new_outputs(self) -> list[Output]:
        log = self._vehicle.motor_log if self._vehicle else None
        if log is None or not log.exists():
            return []
        with log.open("rb") as file:
            file.seek(self._read)
            whole = file.read().rpartition(b"\n")[0]
        self._read += len(whole) + bool(whole)
        rows = (line.split() for line in whole.decode().splitlines())
        return [Output(int(at) / 1e9, tuple(map(float, values))) for at, *values in rows]


class BridgeMember:
    """The bridge between the leg of the vehicle and those of the stations."""

    name = "bridge"

    def __init__(self, *ports: int) -> None:
        self._endpoints = [f"udpin:127.0.0.1:{port}" for port in ports]
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int:
        return self._process.pid if self._process and self._process.returncode is None else 0

    def start(self) -> None:
        self._process = subprocess.Popen([sys.executable, "-m", "link.bridge", *self._endpoints, "--quiet"])

    def kill(self) -> None:
        if self._process and self._process.returncode is None:
            self._process.kill()
            self._process.wait(PATIENCE)


class StationMember:
    """A ground station and who drives it."""

    def __init__(self, name: str, driver: Driver) -> None:
        self.name = name
        self.driver = driver
        self._acts: Iterator[float] | None = None
        self._due = 0.0

    @property
    def pid(self) -> int:
        return self.driver.pid

    def start(self) -> None:
        self.driver.start()
        self._acts = self.driver.acts()
        self._due = 0.0

    def kill(self) -> None:
        self.driver.kill()
        self._acts = None

    def step(self, now: float) -> None:
        """Let the driver act if it is time."""
        if self._acts is not None and now >= self._due:
            wait = next(self._acts, None)
            if wait is None:  # it did not start, on a busy machine
                self.start()
            self._due = now + (wait or 0.0)


def stations(
    folder: Path, ports: tuple[int, int], seed: int, *, keys: bool, signing: bool
) -> tuple[StationMember, StationMember]:
    """Return two ground stations on two ports; the first in a terminal if `keys`."""
    (first, second), chance, other = ports, f"{seed} one", f"{seed} two"
    one: Driver = (
        KeyDriver(folder, first, 255, chance, signing) if keys else SnapshotDriver(first, 255, chance, signing)
    )
    two = SnapshotDriver(second, 254, other, signing)
    return StationMember("station one", one), StationMember("station two", two)


def processes(member: Member) -> dict[str, int]:
    """Return the processes of a member: role -> process id."""
    if not member.pid:
        return {}
    return {
        member.name if not number else f"{member.name}, child {number}": pid
        for number, pid in enumerate(family(member.pid))
    }
