"""Accounting of frames that the framer could not verify: complete foreign frames, or damage."""

from __future__ import annotations

import msgspec

from link.protocol.frame import FramerCounts, UnknownKey

MAX_MISMATCHES = 64
"""Message ids whose frames arrive complete but with the checksum of another definition, that are counted one by one."""


class _FailedFrame(msgspec.Struct):
    end: int
    """Position where it claims to end."""
    size: int
    message_id: int
    unknown: UnknownKey | None
    """Its source and id, if that is outside the dialect."""
    noise: int
    """`resync_bytes` before its first byte: the value to go back to if it was a complete frame of an unknown id."""
    crc_errors: int = 0
    """Frames inside it that failed the checksum."""
    refused: int = 0
    """Frames inside it that were refused."""


class FailedFrames:
    """Holds the newest failed frame until the next frame shows what it was.

    A frame that starts exactly at its claimed end proves that it was complete: an unknown id, or another definition of
    a known one. What seemed to be damage inside a complete frame of an unknown id was its payload, and is not counted.
    """

    __slots__ = ("_counts", "newest")

    def __init__(self, counts: FramerCounts) -> None:
        self._counts = counts
        self.newest: _FailedFrame | None = None
        """The failed frame that is not decided yet. No property, because the framer reads it for each frame."""

    def add_unknown(self, start: int, end: int, key: UnknownKey) -> None:
        """Add a frame with an id outside the dialect."""
        self._add(start, end, key[2], key)

    def add_bad_crc(self, start: int, end: int, message_id: int) -> None:
        """Add a frame of a known id with a wrong checksum."""
        outer = self._unknown_around(start)
        if outer is not None:
            outer.crc_errors += 1
            return
        self._counts.crc_errors += 1
        self._add(start, end, message_id, None)

    def add_refused(self, start: int) -> None:
        """Add a frame with unknown flags, or a MAVLink 1 frame of the wrong length."""
        outer = self._unknown_around(start)
        if outer is not None:
            outer.refused += 1
        else:
            self._counts.refused += 1

    def shift(self, used: int) -> None:
        """Follow a buffer from whose start `used` bytes were removed."""
        if self.newest is not None:
            self.newest.end -= used

    def drop(self) -> None:
        """Decide that the failed frame was none, and count what failed inside it."""
        failed, self.newest = self.newest, None
        if failed is not None:
            self._counts.crc_errors += failed.crc_errors
            self._counts.refused += failed.refused

    def settle(self, position: int) -> None:
        """Decide on the failed frame: a frame starts, or the data ends, at `position`."""
        failed = self.newest
        if failed is None or failed.end != position:
            self.drop()
            return
        self.newest = None
        counts = self._counts
        if failed.unknown is not None:
            counts.unknown += 1
            counts.add_unknown(failed.unknown, 1, failed.size)
            counts.resync_bytes = failed.noise
        elif failed.message_id in counts.mismatches or len(counts.mismatches) < MAX_MISMATCHES:
            counts.mismatches[failed.message_id] = counts.mismatches.get(failed.message_id, 0) + 1

    def _add(self, start: int, end: int, message_id: int, unknown: UnknownKey | None) -> None:
        """Keep a failed frame, unless it lies inside an earlier one that may still prove complete."""
        if self.newest is not None and self.newest.end <= start:
            self.settle(start)
        if self.newest is None:
            self.newest = _FailedFrame(end, end - start, message_id, unknown, self._counts.resync_bytes)

    def _unknown_around(self, start: int) -> _FailedFrame | None:
        """Return the frame of an unknown id that contains `start`, if it may still prove complete."""
        outer = self.newest
        return outer if outer is not None and outer.unknown is not None and start < outer.end else None
