"""Bytes a second of all links together over the last minute, received and sent."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from link.core import LinkReport

POINTS = 60
"""Rates that are kept: links report once a second."""
LEAST_TIME = 0.2
"""s between two reports for a rate; those that come sooner count with the next."""


class ByteRates:
    """Follows the counters of the links."""

    def __init__(self) -> None:
        self._totals: dict[int, int] = {}
        self._at: float | None = None
        self._bytes = 0
        self._rates: deque[int] = deque(maxlen=POINTS)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Take the counters of all links; one that opens or closes makes no jump."""
        totals = {report.index: report.bytes_received + report.bytes_sent for report in reports}
        self._bytes += sum(max(0, total - self._totals.get(link, total)) for link, total in totals.items())
        self._totals = totals
        if self._at is None:
            self._at = now
        elif now - self._at >= LEAST_TIME:
            self._rates.append(round(self._bytes / (now - self._at)))
            self._bytes, self._at = 0, now

    @property
    def rates(self) -> tuple[int, ...]:
        """Bytes/s, the oldest first, one a second."""
        return tuple(self._rates)
