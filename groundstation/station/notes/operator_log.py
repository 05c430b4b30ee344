"""What the operator did, as lines of the message log: commands at once, driving when it ends."""

from __future__ import annotations

from dialects.axes import Axes
from groundstation.intents.base import Intent
from groundstation.intents.driving import PAD, DriveKeyDown, DrivePad
from groundstation.vehicles.readings.latency import LatencyMeter
from groundstation.vehicles.state.message_log import OPERATOR, MessageLog

REPORT_WITHIN = 0.5
"""s after the return to neutral within which the vehicle's report of it belongs to the line. Our vehicle reports each
change at once; a report that comes later was lost or waits on a slow line."""

MAX_KEYS = 8
"""Keys named in one line; all ten drive keys would fill it."""


class OperatorLog:
    """Follows the keys of one operator."""

    def __init__(self, log: MessageLog) -> None:
        self._log = log
        self._keys: dict[str, None] = {}
        """Drive keys since the last return to neutral, in their order."""
        self._began: float | None = None
        self._ended: tuple[float, float, int] | None = None
        """Start and end of the driving that has ended, and LatencyMeter.reports at its end."""

    def handle(self, intent: Intent, now: float) -> None:
        """Log a command; remember a drive key."""
        if isinstance(intent, DriveKeyDown):
            if len(self._keys) < MAX_KEYS:
                self._keys[intent.key] = None
            return
        if isinstance(intent, DrivePad) and len(self._keys) < MAX_KEYS:
            self._keys[PAD] = None
        if text := intent.describe():
            self._log.add(now, OPERATOR, text)

    def tick(self, demand: Axes, latency: LatencyMeter | None, now: float) -> None:
        """Store the demand that was sent last; `latency` is that of the selected vehicle."""
        if not demand.neutral:
            self._finish(None, now)
            self._began = now if self._began is None else self._began
        elif self._began is not None:
            self._ended, self._began = (self._began, now, latency.reports if latency else 0), None
        elif self._ended is None:
            self._keys.clear()  # a key that did not count
        if self._ended is None:
            return
        reported = latency is not None and latency.reports > self._ended[2]
        if reported or now - self._ended[1] > REPORT_WITHIN:
            self._finish(latency.latest if reported and latency is not None else None, now)

    def _finish(self, delay: float | None, now: float) -> None:
        if self._ended is None:
            return
        began, ended, _ = self._ended
        text = f"{' '.join(self._keys)} drove for {ended - began:.2f} s"
        if delay is not None:
            text += f", neutral applied after {delay * 1000:.0f} ms"
        self._log.add(now, OPERATOR, text)
        self._ended = None
        self._keys.clear()
