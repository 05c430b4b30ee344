"""RawFile: an unbuffered file."""

from __future__ import annotations

import os


class RawFile:
    """An unbuffered file: written data survives a kill of the program."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def write(self, data: bytes) -> None:
        """Write all of `data`. Raises OSError; on a full disk a part may be written."""
        rest = memoryview(data)
        while rest:
            rest = rest[os.write(self._descriptor, rest) :]

    def sync(self) -> None:
        """Write the file's data to the disk, against a power cut. Raises OSError."""
        getattr(os, "fdatasync", os.fsync)(self._descriptor)  # macOS has no fdatasync

    def duplicate(self) -> RawFile:
        """Return the same file with a descriptor of its own. Raises OSError."""
        return RawFile(os.dup(self._descriptor))

    def is_removed(self) -> bool:
        """Return whether the file was removed from its directory."""
        return os.fstat(self._descriptor).st_nlink == 0

    def close(self) -> None:
        """Close the file. Raises OSError."""
        os.close(self._descriptor)
