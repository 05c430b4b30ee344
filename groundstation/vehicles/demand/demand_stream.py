"""When to send a demand: at once on change, steadily while driving, several neutrals at the end, else never.

A demand is state: only the newest is ever sent, nothing is queued and nothing is made up for.
"""

from __future__ import annotations

import math

from dialects.axes import NEUTRAL, Axes
from groundstation.vehicles.demand.demand_copies import DemandCopies

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
"""Least s between two changed demands. The vehicle takes 200 demands/s; hands make fewer. Neutral is exempt, and copies
(demand_copies.py) have a limit of their own."""


class DemandStream:
    """Decides whether a demand goes out at a given moment. Times in s."""

    def __init__(self, copies: DemandCopies | None = None) -> None:
        """Let `copies` follow each change; None: nothing follows until the demand is due again."""
        self._copies = copies
        self.copying = False
        """What `next_due` has returned is a copy."""
        self._waits = False
        """A changed demand waits until CLOSEST has passed."""
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
        elif streaming and not self._streaming:
            self.resume(now)
        self._streaming = streaming
        self.copying = self._waits = False
        if not streaming:
            return self._final_neutral(now) or self._copy(NEUTRAL, now)
        self._neutrals_left = 0
        if demand != self._sent and (demand.neutral or now - self._changed_at >= CLOSEST):
            return self._send(demand, now, now)
        self._waits = demand != self._sent and now < self._due
        return self._send(demand, now, self._due) if now >= self._due else self._copy(demand, now)

    @property
    def due_at(self) -> float | None:
        """When to call `next_due` even if nothing happens before; None: there is nothing to send."""
        waits = self._changed_at + CLOSEST if self._waits else None
        copy = self._copies.due_at if self._copies is not None else None
        steady = None if self.finished else self._due
        return min((at for at in (waits, copy, steady) if at is not None), default=None)

    def adapt(self, loss: float | None, capacity: float | None) -> None:
        """Set what is known of the link to the vehicle, see DemandCopies."""
        if self._copies is not None:
            self._copies.adapt(loss, capacity)

    def resume(self, now: float) -> None:
        """Go on at the driving rate, starting now."""
        self._moved_at = self._due = now

    def _final_neutral(self, now: float) -> Axes | None:
        if not self._neutrals_left or now < self._due:
            return None
        self._neutrals_left -= 1
        self._moved_at = now
        return self._send(NEUTRAL, now, self._due)

    def _copy(self, demand: Axes, now: float) -> Axes | None:
        """Return the demand that was sent last if a copy of it is due and it still holds."""
        due = self._copies is not None and self._copies.take(now, neutral=demand.neutral)
        self.copying = due and demand == self._sent
        return demand if self.copying else None

    def _send(self, demand: Axes, now: float, due: float) -> Axes:
        """Send, and count the period from when the demand was `due`: a late call must not lower the rate."""
        if not demand.neutral or not self._sent.neutral:
            self._moved_at = now
        period = DRIVING_PERIOD if now - self._moved_at < SETTLE else NEUTRAL_PERIOD
        if demand != self._sent:
            self._sent, self._changed_at = demand, now
            if self._copies is not None:
                self._copies.plan(now)
        self._due = due + period if due + period > now else now + period
        return demand
