"""Marks under the time axis: changes of mode, arming, failsafes and link of the selected vehicle, and own keys."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator

import msgspec

from groundstation.intents.driving import PAD, STOP_KEY, DriveKeyDown, DrivePad, EmergencyStop, Stop
from groundstation.intents.union import AnyIntent
from groundstation.vehicles.state.vehicle_state import VehicleState
from groundstation.views.charts import Mark

MAX_MARKS = 500

REPEATS_WITHIN = 1.0
"""s in which the same key again is its auto-repeat: longer than the pause before the first repeat."""


class MarkList:
    """The newest MAX_MARKS marks. `count` gives the next number of a mark; numbers only grow."""

    def __init__(self, count: Callable[[], int]) -> None:
        self._count = count
        self._marks: deque[tuple[int, Mark]] = deque(maxlen=MAX_MARKS)

    def add(self, at: float, kind: str, text: str) -> None:
        """Add a mark."""
        self._marks.append((self._count(), Mark(at, kind, text)))

    def take(self, after: int, limit: int) -> tuple[Mark, ...]:
        """Return the marks with numbers above `after`, up to `limit`."""
        return tuple(mark for number, mark in self._marks if after < number <= limit)

    def new_marks(self, after: int, limit: int) -> int:
        """Return how many marks `take` would return."""
        return len(self.take(after, limit))


class _Seen(msgspec.Struct, frozen=True):
    """The state of a vehicle of which changes are marked."""

    system: int
    mode: str
    armed: bool
    alive: bool
    failsafes: tuple[str, ...]


class MarkWatcher:
    """Compares the selected vehicle with what it was, and the keys of the driver with those before."""

    def __init__(self, marks: MarkList) -> None:
        self._marks = marks
        self._before: _Seen | None = None
        self._pressed: dict[str, float] = {}

    def update(self, vehicle: VehicleState, now: float) -> None:
        """Mark what has changed in the selected vehicle; another one begins with its mode."""
        alive = vehicle.monitor.is_alive(now)
        seen = _Seen(vehicle.system, vehicle.mode, vehicle.armed, alive, vehicle.failsafes)
        before, self._before = self._before, seen
        if seen == before:
            return
        if before is None or before.system != seen.system:
            self._marks.add(now, "mode", seen.mode)
            return
        for kind, text in _changes(before, seen):
            self._marks.add(now, kind, text)

    def press(self, intent: AnyIntent, now: float) -> None:
        """Mark a key that drives or stops, once for each time that it is pressed."""
        if isinstance(intent, DriveKeyDown):
            self._mark_key(intent.key, now)
        elif isinstance(intent, DrivePad):
            self._mark_key(PAD, now)
        elif isinstance(intent, EmergencyStop):
            self._mark_key("e-stop", now)
        elif isinstance(intent, Stop) and intent.reason == STOP_KEY:
            self._mark_key("stop", now)

    def _mark_key(self, key: str, now: float) -> None:
        if now - self._pressed.get(key, float("-inf")) > REPEATS_WITHIN:
            self._marks.add(now, "key", key)
        self._pressed[key] = now


def _changes(before: _Seen, seen: _Seen) -> Iterator[tuple[str, str]]:
    """Yield kind and text of each change."""
    if seen.mode != before.mode:
        yield "mode", seen.mode
    if seen.armed != before.armed:
        kind = "armed" if seen.armed else "disarmed"
        yield kind, kind
    if seen.alive != before.alive:
        yield "link", "link back" if seen.alive else "link lost"
    for name in seen.failsafes:
        if name not in before.failsafes:
            yield "failsafe", name
