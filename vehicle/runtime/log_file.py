"""The log file of `--log-file`: at most SIZE_MAX bytes, and the file before it as NAME.1."""

from __future__ import annotations

import os
import stat
from pathlib import Path

from link.runtime.whole_file import PRIVATE

SIZE_MAX = 10_000_000
"""Bytes of one file: some weeks of a quiet vehicle, and little for the card of a Raspberry Pi. Strangers may cause up
to 100 MB of texts a day."""
# Non-blocking: opening a pipe without a reader would block.
_FLAGS = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | os.O_NONBLOCK


class LogFile:
    """Appends lines. A pipe or a device has no size and is never replaced."""

    def __init__(self, path: str) -> None:
        """Open or create the file. Raises OSError."""
        self._path = Path(path).absolute()
        self._descriptor = os.open(self._path, _FLAGS, PRIVATE)
        self._is_file = stat.S_ISREG(os.fstat(self._descriptor).st_mode)

    def write(self, line: bytes) -> None:
        """Append a line, in a new file if this one is full. Raises OSError."""
        if self._is_file and os.fstat(self._descriptor).st_size + len(line) > SIZE_MAX:
            self._replace()
        os.write(self._descriptor, line)

    def close(self) -> None:
        """Close the file."""
        os.close(self._descriptor)

    def _replace(self) -> None:
        """Keep the full file as NAME.1 and begin a new one; where the folder forbids it, empty the file."""
        try:
            os.replace(self._path, f"{self._path}.1")
            descriptor = os.open(self._path, _FLAGS, PRIVATE)
        except OSError:
            os.ftruncate(self._descriptor, 0)
            return
        os.close(self._descriptor)
        self._descriptor = descriptor
