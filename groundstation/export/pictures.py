"""Recorded pictures beside a log, for the formats that take them: in the order of their time, between the messages."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from groundstation.export.exporter import ExportError
from groundstation.stream.names import find_parts
from groundstation.stream.recorded_video import RecordedUnit, RecordedVideo

NAME = "CAMERA"
"""What stands for them among the names of messages."""


class PictureSource:
    """Pictures of a part of a log, us; it begins with one that needs no earlier one."""

    def __init__(self, log: Path, begin: int, end: int) -> None:
        """Look for them. Raises OSError, ExportError."""
        self._video = RecordedVideo(log)
        self._video.refresh()
        if not len(self._video) and find_parts(log):
            raise ExportError(f"{self._video.problem}: remove it, or give --messages without {NAME}")
        self._units = self._choose(begin, end)
        self._next = next(self._units, None)

    @property
    def damaged(self) -> int:
        """Bytes that belong to no whole picture, also at the end of a file that was cut."""
        return self._video.damaged + self._video.tail

    def pop(self, until: int) -> Iterator[RecordedUnit]:
        """Yield the next pictures, up to a time."""
        while self._next is not None and self._next.time <= until:
            yield self._next
            self._next = next(self._units, None)

    def close(self) -> None:
        """Close the files."""
        self._video.close()

    def _choose(self, begin: int, end: int) -> Iterator[RecordedUnit]:
        decodes = False
        for unit in self._video.units():
            if unit.time >= end:
                return
            decodes = (decodes or unit.key) and unit.time >= begin
            if decodes:
                yield unit
