"""Store: saves named files for the next start without blocking; NullStore saves nothing. No thread and no disk here."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

import msgspec

T = TypeVar("T")


class PendingWrite(msgspec.Struct):
    """One request to write a file, and its result."""

    done: bool = False
    """The file, or a newer one of the same name, is on the disk, or the write failed."""
    problem: str | None = None
    """Why the write failed, one line."""


class Store(Protocol):
    """Saves named files. FileWriter writes them to a folder; NullStore forgets them."""

    @property
    def problem(self) -> str | None:
        """Why the last file was not written, one line."""

    @property
    def idle(self) -> bool:
        """Every requested write is complete or has failed."""

    def read(self, name: str, parse: Callable[[bytes], T]) -> T | None:
        """Return the parsed content of a file, None if the file does not exist. Raises CorruptFileError."""

    def write(self, name: str, make: Callable[[], bytes]) -> PendingWrite:
        """Queue a file for writing; `make` builds its bytes. Never blocks and never raises."""

    def close(self) -> None:
        """Wait until the queued files are written."""


class NullStore:
    """A store that saves nothing: parameters and plans end with the program, as in the simulator."""

    problem: str | None = None
    idle = True

    def read(self, name: str, parse: Callable[[bytes], T]) -> T | None:
        """Return None: there are no files."""
        return None

    def write(self, name: str, make: Callable[[], bytes]) -> PendingWrite:
        """Return a completed write."""
        return PendingWrite(done=True)

    def close(self) -> None:
        """Return: nothing is queued."""
