"""Motors that turn nothing and record when each control cycle reached them; and the two reference loops.

`mavhelm vehicle --config` accepts `Motors` as the driver "tests.benchmarks.ticking:Motors" with a file to append to.

Usage of the references: python -m tests.benchmarks.ticking asyncio|blocking FILE
"""

from __future__ import annotations

import asyncio
import os
import select
import struct
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from vehicle.motors import check_throttles

PERIOD = 0.02
"""s, as the vehicle's own control cycle."""

STAMP = struct.Struct("=q")
"""CLOCK_MONOTONIC, ns."""


class Stamps:
    """A file of timestamps: 8 bytes each, written at once."""

    def __init__(self, path: str) -> None:
        self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o644)

    def add(self) -> None:
        """Record the present time."""
        os.write(self._descriptor, STAMP.pack(time.monotonic_ns()))

    def close(self) -> None:
        """Close the file."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1


def read(path: Path) -> list[int]:
    """Return all timestamps of a file so far, ns."""
    data = path.read_bytes() if path.exists() else b""
    return [stamp for (stamp,) in STAMP.iter_unpack(data[: len(data) // STAMP.size * STAMP.size])]


class File(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The driver's settings."""

    stamps: str
    """File to append to."""


class Motors:
    """Fits `vehicle.motors.Motors`. While armed the vehicle sets its motors in every cycle, changed or not."""

    Settings = File

    def __init__(self, settings: File) -> None:
        self.count = 2
        self._stamps = Stamps(settings.stamps)
        self._enabled = False

    def enable(self) -> None:
        """Record the times of `set` from now on."""
        self._enabled = True

    def disable(self) -> None:
        """Stop recording the times of `set`."""
        self._enabled = False

    def set(self, throttles: Sequence[float]) -> None:
        """Record the time first."""
        if self._enabled:
            self._stamps.add()
        check_throttles(throttles, self.count)

    def close(self) -> None:
        """Close the file."""
        self.disable()
        self._stamps.close()


async def _in_asyncio(stamps: Stamps) -> None:
    """Run a loop with absolute deadlines in asyncio, which does nothing else."""
    loop = asyncio.get_running_loop()
    ended: asyncio.Future[None] = loop.create_future()

    def cycle(due: float) -> None:
        stamps.add()
        due = max(due + PERIOD, loop.time())
        loop.call_at(due, cycle, due)

    cycle(loop.time())
    await ended


def _blocking(stamps: Stamps) -> None:
    """Run a loop with absolute deadlines that blocks in the kernel."""
    due = time.monotonic()
    while True:
        stamps.add()
        due = max(due + PERIOD, time.monotonic())
        select.select([], [], [], max(0.0, due - time.monotonic()))


LOOPS: dict[str, Callable[[Stamps], None]] = {
    "asyncio": lambda stamps: asyncio.run(_in_asyncio(stamps)),
    "blocking": _blocking,
}

if __name__ == "__main__":
    LOOPS[sys.argv[1]](Stamps(sys.argv[2]))
