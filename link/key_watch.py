"""KeyWatch: the key file of a program that runs. It notices changes in a thread of its own."""

from __future__ import annotations

import os
from pathlib import Path

from link.runtime.worker import Worker
from link.signing.key_file import KeyFileError, load_keys
from link.signing.keys import KeyRing

PERIOD = 1.0
"""s between two looks at the file: how long a revoked key may still be used."""
CLOSE_TIMEOUT = 2.0
"""s that the end of the program waits for the disk."""

FileVersion = tuple[int, int, int, int] | None
"""Inode, size, time of change in ns, mode; None without a file."""


class KeyWatch:
    """The newest keys of a file. Call `poll` at least once in PERIOD; it never blocks."""

    def __init__(self, path: Path) -> None:
        """Read the keys. Raises KeyFileError."""
        self.path = path
        self._version = _version_of(path)
        self.ring = load_keys(path)
        """The keys of now."""
        self.worker = Worker("keys", limit=4)
        """The thread, also for what else is done with the file."""
        self._found: KeyRing | KeyFileError | None = None
        """What the thread has read, until `poll` takes it."""
        self._due = 0.0

    def poll(self, now: float) -> KeyRing | None:
        """Return other keys than before, once, or None.

        Raises KeyFileError once if the file cannot be used any more; the keys of before stay in force.
        """
        if now >= self._due:
            self._due = now + PERIOD
            self.worker.submit(self.look)
        found, self._found = self._found, None
        if isinstance(found, KeyFileError):
            raise found
        if found is None or found == self.ring:
            return None
        self.ring = found
        return found

    def look(self) -> None:
        """Read the file if it has changed."""
        version = _version_of(self.path)
        if version == self._version:
            return
        self._version = version
        try:
            self._found = load_keys(self.path)
        except KeyFileError as error:
            self._found = error

    def close(self) -> None:
        """Wait for what the thread does."""
        self.worker.close(CLOSE_TIMEOUT)


def _version_of(path: Path) -> FileVersion:
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return found.st_ino, found.st_size, found.st_mtime_ns, found.st_mode
