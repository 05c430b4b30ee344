"""What stops the vehicle, as the Drive screen shows it: the bounds of this program, then those of the vehicle."""

from __future__ import annotations

import math
from collections.abc import Iterator

from groundstation.intents.driving import PAD
from groundstation.snapshot.drive import StopBound
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.terminal.tty_ping import SILENT_AFTER

NEAR = 0.5
"""Share of a bound from which on it is shown with each snapshot; below, twice a second is enough."""


def all_stops(now: DisplayState) -> tuple[StopBound, ...]:
    """Return all bounds, those of this program first. Without a vehicle there are none."""
    vehicle = now.snapshot.vehicle
    return () if vehicle is None else (_key(now), *_terminal(now), *vehicle.stops)


def is_near(now: DisplayState) -> bool:
    """Return whether the vehicle may stop soon."""
    return any((stop.share or 0.0) >= NEAR for stop in all_stops(now) if stop.unit == "s")


def _key(now: DisplayState) -> StopBound:
    operator = now.snapshot.operator
    if PAD in operator.held:
        return StopBound("pad let go", "neutral", "gamepad", 0.0)
    source = "releases reported" if operator.reports_releases else "timer"
    if not math.isfinite(operator.stop_bound):
        return StopBound("key let go", "nothing", operator.style, never=True)
    return StopBound("key let go", "neutral", source, round(operator.stop_bound, 2))


def _terminal(now: DisplayState) -> Iterator[StopBound]:
    """Yield the bound of a terminal that answers pings; of another one nothing is known."""
    if now.terminal_silence is not None:
        yield StopBound("terminal", "neutral", "ping", SILENT_AFTER, now.terminal_silence)
