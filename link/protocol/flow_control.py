"""Flow control of telemetry radios: how much of a link may be used, by RADIO_STATUS.txbuf."""

from __future__ import annotations

import math

from dialects import codec
from dialects.messages import RadioStatus

DELAY_STEPS: tuple[tuple[int, int, float], ...] = ((0, 19, 0.060), (20, 49, 0.020), (91, 95, -0.020), (96, 100, -0.040))
"""Free buffer in %, from and to -> change in s of the delay between messages, as in ArduPilot's GCS_MAVLINK."""
MAX_DELAY = 2.0
"""s, as in ArduPilot."""
NOMINAL_INTERVAL = 0.2
"""s between two messages of a kind in usual telemetry, against which the delay is measured."""
FORGET_AFTER = 5.0
"""s after which the last report no longer counts; a radio reports once a second."""


class FlowControl:
    """Turns the radio's reports into the share of the link that telemetry may use."""

    def __init__(self) -> None:
        self._delay = 0.0
        self._last_seen = -math.inf

    def handle_frame(self, raw: bytes, now: float) -> None:
        """Handle a frame of RADIO_STATUS."""
        status = codec.decode_frame(RadioStatus.id, raw)
        assert isinstance(status, RadioStatus)
        self.handle_radio_status(status.txbuf, now)

    def handle_radio_status(self, txbuf: int, now: float) -> None:
        """Handle a report: the radio's transmit buffer is `txbuf` % free; 255 is "unknown"."""
        self._last_seen = now
        for low, high, step in DELAY_STEPS:
            if low <= txbuf <= high:
                self._delay = min(MAX_DELAY, max(0.0, self._delay + step))

    def headroom(self, now: float) -> float:
        """Return the share of the capacity that may be used, above 0 and up to 1."""
        if now - self._last_seen > FORGET_AFTER:
            self._delay = 0.0
        return NOMINAL_INTERVAL / (NOMINAL_INTERVAL + self._delay)
