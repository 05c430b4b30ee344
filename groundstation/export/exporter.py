"""What all exporters have in common."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import msgspec

from groundstation.export.sample import Sample
from groundstation.stream.recorded_video import RecordedUnit


class ExportError(Exception):
    """An export that cannot be made; the message is one line for the user."""


class NothingToExportError(Exception):
    """The chosen part of a log has nothing for any of the formats."""


class Target(Protocol):
    """A file or folder that is complete or not there (groundstation/disk/new_file.py)."""

    path: str

    def commit(self) -> None:
        """Move it to its place. Raises OSError."""


class Exporter(Protocol):
    """Writes samples into a target. Its constructor raises ExportError and OSError."""

    learns: bool
    """`add` gets all samples of the log and looks at `chosen` itself; else it gets those that are chosen."""

    @property
    def target(self) -> Target:
        """Where it writes."""

    @property
    def count(self) -> int:
        """What was written: messages, or points."""

    def add(self, sample: Sample) -> None:
        """Write a sample, if it is one for this format. Raises OSError."""

    def finish(self) -> None:
        """Write what follows the last sample. Raises OSError."""

    def discard(self) -> None:
        """Close everything, and remove what is not in its place."""


@runtime_checkable
class PictureExporter(Exporter, Protocol):
    """One with a place for recorded pictures."""

    def add_picture(self, unit: RecordedUnit) -> None:
        """Write a picture. Raises OSError."""


class LogInfo(msgspec.Struct, frozen=True):
    """What an exporter knows of the log."""

    name: str
    begin: int
    """Unix time of the first record, us."""
    only: str = ""
    """The message that is exported, if it is only one; else ""."""
