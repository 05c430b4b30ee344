"""When to send a demand: at once on change, steadily while driving, several neutrals at the end, else never.

A demand is state: only the newest is ever sent, nothing is queued and nothing is made up for.
"""

from __future__ import annotations

import math

from dialects.axes import NEUTRAL, Axes

DRIVING_PERIOD = 0.05
"""s between demands while driving and just after: nine of them in the vehicle's MAN_TIMEOUT of 0.45 s."""

NEUTRAL_PERIOD = 0.2
"""s between neutral demands while no key is held: they show the vehicle that its driver is there, and keep ArduPilot,
which holds a demand for 3 s, neutral."""

SETTLE = 1.0
"""s for which neutral is sent at the driving rate after the last movement: a stop must get through a bad link."""

FINAL_NEUTRALS = 5
"""Neutral frames at the end of a drive, DRIVING_PERIOD apart: all five are lost once in 400 at 30 % loss."""

CLOSEST = 0.008
"""Least s between two changed demands. The vehicle takes 200 demands/s; hands make fewer. Neutral is exempt."""


class DemandStream:
    """Decides whether a demand goes out at a given moment. Times in s."""

    def __init__(self) -> None:
        self._sent = NEUTRAL
        self._changed_at = -math.inf
        self._due = -math.inf
        self._moved_at = -math.inf
        self._streaming = False
        self._neutrals_left = 0

    @property
    def streaming(self) -> bool:
        """Demands are being sent."""
        return self._streaming

    @property
    def finished(self) -> bool:
        """No demand is being sent and no final neutral is left to send."""
        return not self._streaming and not self._neutrals_left

    def next_due(self, demand: Axes, streaming: bool, now: float) -> Axes | None:
        """Return the demand to send now, or None. `streaming`: demands may be sent; when it ends, neutrals follow."""
        if self._streaming and not streaming:
            self._neutrals_left, self._due = FINAL_NEUTRALS, now
        self._streaming = streaming
        if not streaming:
            return self._final_neutral(now)
        self._neutrals_left = 0
        if demand != self._sent and (demand.neutral or now - self._changed_at >= CLOSEST):
            return self._send(demand, now, now)
        return self._send(demand, now, self._due) if now >= self._due else None

    def resume(self, now: float) -> None:
        """Go on at the driving rate, starting now."""
        self._moved_at = self._due = now

    def _final_neutral(self, now: float) -> Axes | None:
        if not self._neutrals_left or now < self._due:
            return None
        self._neutrals_left -= 1
        self._moved_at = now
        return self._send(NEUTRAL, now, self._due)

    def _send(self, demand: Axes, now: float, due: float) -> Axes:
        """Send, and count the period from when the demand was `due`: a late tick must not lower the rate."""
        if not demand.neutral or not self._sent.neutral:
            self._moved_at = now
        period = DRIVING_PERIOD if now - self._moved_at < SETTLE else NEUTRAL_PERIOD
        if demand != self._sent:
            self._sent, self._changed_at = demand, now
        self._due = max(due + period, now)
        return demand
