"""The frames that a program sent last, over all its links: a frame with its own ids may be one that came back.

A ground station with two links to one vehicle forwards what arrives on one of them to the other, until it has seen the
vehicle there as well. A loop of bridges, or a cable plugged into itself, returns frames as well.
"""

from __future__ import annotations

FRAMES_MAX = 1024
"""Frames that are remembered: some seconds of telemetry to two ground stations."""


class SentFrames:
    """Remembers frames; one for all channels of a program."""

    def __init__(self) -> None:
        self._frames: dict[bytes, None] = {}

    def add(self, frame: bytes) -> None:
        """Remember a frame, and forget the oldest if there are too many."""
        self._frames[frame] = None
        if len(self._frames) > FRAMES_MAX:
            del self._frames[next(iter(self._frames))]

    def __contains__(self, frame: bytes) -> bool:
        return frame in self._frames
