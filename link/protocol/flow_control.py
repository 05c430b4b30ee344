"""How much of a link may be filled: what a telemetry radio says of its own buffer, in RADIO_STATUS.txbuf."""

from __future__ import annotations

import math

DELAY_STEPS: tuple[tuple[int, int, float], ...] = ((0, 19, 0.060), (20, 49, 0.020), (91, 95, -0.020), (96, 100, -0.040))
"""Free buffer in %, from and to -> s more (or less) between two messages: the table that ArduPilot lives by."""
MAX_DELAY = 2.0
"""s: as ArduPilot's."""
NOMINAL_INTERVAL = 0.2
"""s between two messages of a kind in usual telemetry: what the delay is measured against."""
FORGET_AFTER = 5.0
"""s: a radio reports once a second; one that is gone limits nothing."""


class FlowControl:
    """Turns the radio's reports into the share of the link that telemetry may use."""

    def __init__(self) -> None:
        self._delay = 0.0
        self._heard = -math.inf

    def handle_radio_status(self, txbuf: int, now: float) -> None:
        """The radio's transmit buffer is `txbuf` % free; 255 is "unknown"."""
        self._heard = now
        for low, high, step in DELAY_STEPS:
            if low <= txbuf <= high:
                self._delay = min(MAX_DELAY, max(0.0, self._delay + step))

    def headroom(self, now: float) -> float:
        """Share of the capacity that may be filled, above 0 and up to 1."""
        if now - self._heard > FORGET_AFTER:
            self._delay = 0.0
        return NOMINAL_INTERVAL / (NOMINAL_INTERVAL + self._delay)
