"""Bytes a second of pictures on the line to the terminal: frames are dropped first, then they become coarser.

What is in the buffers of a slow line delays the answer to a key. So there is one frame on the line at most: a ping
behind it says when the terminal has read it, and how long the line took.
"""

from __future__ import annotations

from groundstation.pictures.painters import MAX_LEVEL

LOCAL_BYTES, REMOTE_BYTES = 8_000_000, 250_000
"""Bytes a second in a terminal of this machine, and over SSH."""
MIN_RATE = 4.0
"""Frames a second below which they become coarser."""
FINER_AFTER = 2.0
"""s of frames that take less than a quarter of the time at MIN_RATE, after which they become finer."""
PONG_PATIENCE = 3.0
"""s after which the next frame goes out without an answer: some terminals answer none."""


class ByteBudget:
    """When the next frame may go out, and how coarse it is. Times are of one clock that never goes back.

    `round_trip`: s of an answer to a few bytes, which is not for the size of a frame; None: nothing is answered.
    """

    def __init__(self, limit: int, coarsest: int = MAX_LEVEL, *, round_trip: float | None = 0.0) -> None:
        self._limit, self._coarsest = limit, coarsest
        self._answers = round_trip is not None
        self._round_trip = round_trip or 0.0
        self.level = 0
        """0 is fine."""
        self._free_at = 0.0
        self._sent_at: float | None = None
        """When the frame that is on the line went out."""
        self._size = 0
        self._quick_since: float | None = None

    def may_draw(self, now: float) -> bool:
        """Return whether a frame may go out."""
        on_line = self._sent_at is not None and self._answers and now - self._sent_at < PONG_PATIENCE
        return now >= self._free_at and not on_line

    def note_frame(self, size: int, now: float) -> None:
        """Note that a frame of so many bytes goes out, with a ping behind it."""
        if self._sent_at is not None:  # nothing was answered
            self._adapt(self._size / self._limit, now)
        self._free_at, self._sent_at, self._size = now + size / self._limit, now, size

    def handle_pong(self, now: float) -> None:
        """Note that the terminal has read the frame."""
        if self._sent_at is not None:
            took, self._sent_at = now - self._sent_at, None
            self._round_trip = min(self._round_trip, took)
            self._adapt(max(took - self._round_trip, self._size / self._limit), now)

    def _adapt(self, took: float, now: float) -> None:
        """Become coarser at once, and finer after a while. `took`: s of one frame."""
        if took > 1 / MIN_RATE:
            self.level, self._quick_since = min(self.level + 1, self._coarsest), None
        elif took > 0.25 / MIN_RATE:
            self._quick_since = None
        elif self._quick_since is None:
            self._quick_since = now
        elif self.level and now - self._quick_since > FINER_AFTER:
            self.level, self._quick_since = self.level - 1, None
