"""The vehicle's motor log, read as it is written: when the outputs changed, by the vehicle's own timestamp."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import NamedTuple

from tests.benchmarks.watch import Watch


class Change(NamedTuple):
    """One line of a motor log."""

    at: int
    """CLOCK_MONOTONIC, ns: one clock for all processes of the machine."""
    throttles: tuple[float, ...]


class MotorFeed:
    """A named pipe in place of the vehicle's motor log, so that no file needs to be polled."""

    def __init__(self, watch: Watch, folder: Path) -> None:
        self.path = folder / "motors"
        os.mkfifo(self.path)
        # For writing too: a pipe without a writer counts as ended, and the vehicle opens its end later.
        self._descriptor = os.open(self.path, os.O_RDWR | os.O_NONBLOCK)
        self._watch = watch
        self._rest = b""
        self.changes: list[Change] = []
        watch.add(self._descriptor, self._read)

    @property
    def moving(self) -> bool:
        """Return whether the motors get any power now."""
        return bool(self.changes) and any(self.changes[-1].throttles)

    def after(self, stamp: int, within: float) -> Change | None:
        """Return the first change later than `stamp`; None if there is none within `within` s."""
        seen = len(self.changes)
        while seen and self.changes[seen - 1].at > stamp:
            seen -= 1
        self._watch.until(lambda: len(self.changes) > seen, within)
        return self.changes[seen] if len(self.changes) > seen else None

    def quiet_for(self, seconds: float, within: float) -> bool:
        """Wait until nothing has changed for `seconds`."""
        deadline = time.monotonic() + within
        while time.monotonic() < deadline:
            if not self._changes_within(seconds):
                return True
        return False

    def _changes_within(self, seconds: float) -> bool:
        before = len(self.changes)
        return self._watch.until(lambda: len(self.changes) > before, seconds)

    def close(self) -> None:
        """Stop reading."""
        self._watch.remove(self._descriptor)
        os.close(self._descriptor)

    def _read(self) -> bool:
        *lines, self._rest = (self._rest + os.read(self._descriptor, 65536)).split(b"\n")
        for line in lines:
            stamp, *throttles = line.split()
            self.changes.append(Change(int(stamp), tuple(map(float, throttles))))
        return True
