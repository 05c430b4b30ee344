"""DiskFolder: serves the regular files of one folder, read piece by piece in a thread of its own.

Rules: a name refers to a file in this folder or to nothing (no link is followed: a file is opened by its name within
the folder, and must be a regular file); nothing is written; at most PIECE bytes of a file are in memory.
"""

from __future__ import annotations

import os
import stat
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from link.runtime.worker import Worker
from link.services.ftp.files import Content, DirectoryEntry, NotReadyError, Query, ReadOnlyFolder
from link.services.ftp.protocol import FtpError

PIECE = 256 * 1024
"""Bytes read at once: a tenth of a second of the fastest download, two thirds of a second on a network."""
MAX_ENTRIES = 1000
"""Number of files in a listing: the last ones by name."""
MAX_NAME = 100
"""Characters in a name: several lines of a listing fit into one message."""
MAX_PENDING = 32
"""Concurrent requests to the disk: one for each client of FTP (16) and of the log protocol (8)."""
MAX_SIZE = 2**32 - 1
"""Bytes: sizes in FTP and in the log protocol have 32 bits. A longer file is not served."""
RESULT_TIMEOUT = 1.0
"""s after which a result is dropped: its client no longer waits."""
CLOSE_TIMEOUT = 1.0
"""s that closing waits for the thread."""


class DiskFolder(ReadOnlyFolder):
    """Files of `path` whose names end in `suffix`, as a `link.services.ftp.files.Folder`.

    Methods never block: they raise NotReadyError until the thread has the result. `removable` is called in the thread
    and returns whether a file may be removed now; access control is up to the caller.
    """

    def __init__(self, path: Path, *, suffix: str, removable: Callable[[str], bool]) -> None:
        self._path = path
        self._suffix = suffix
        self._removable = removable
        self._worker = Worker("files", 2 * MAX_PENDING)
        self._lock = threading.Lock()
        self._pending: set[tuple[str, str]] = set()
        self._results: dict[tuple[str, str], tuple[float, Any]] = {}

    def entries(self) -> list[DirectoryEntry]:
        """Return the files by name; empty if the folder cannot be read. Raises NotReadyError."""
        entries: list[DirectoryEntry] = self._request(("list", ""), self._scan)
        return entries

    def open(self, name: str, query: Query) -> Content | None:
        """Return a file with its present size, which stays while it is open. Raises NotReadyError."""
        if query or not self._serves(name):
            return None
        content: Content | None = self._request(("open", name), lambda: self._find(name))
        return content

    def remove(self, name: str) -> FtpError | None:
        """Remove a file. Raises NotReadyError."""
        if not self._serves(name):
            return FtpError.NOT_FOUND
        error: FtpError | None = self._request(("remove", name), lambda: self._remove(name))
        return error

    def clear(self) -> None:
        """Queue the removal of all removable files."""
        self._worker.submit(self._clear)

    def close(self) -> None:
        """Stop the thread."""
        self._worker.close(CLOSE_TIMEOUT)

    def fetch(self, name: str, offset: int, size: int, receive: Callable[[bytes], None]) -> bool:
        """Queue a read; the thread calls `receive`, without bytes on an error. Returns False if the queue is full."""
        return self._worker.submit(lambda: receive(self._read(name, offset, size)))

    def _serves(self, name: str) -> bool:
        """Return whether a file here may have this name: no path, not hidden, printable ASCII."""
        plain = name.isascii() and name.isprintable() and "/" not in name and not name.startswith(".")
        return plain and name.endswith(self._suffix) and len(name) <= MAX_NAME

    def _request(self, key: tuple[str, str], job: Callable[[], Any]) -> Any:
        """Return a result once, if the thread has it; otherwise queue `job` for it. Raises NotReadyError."""
        now = time.monotonic()
        with self._lock:
            self._results = {each: result for each, result in self._results.items() if now - result[0] < RESULT_TIMEOUT}
            if key in self._results:
                return self._results.pop(key)[1]
            room = key not in self._pending and len(self._pending) < MAX_PENDING
            if room and self._worker.submit(lambda: self._run(key, job)):
                self._pending.add(key)
        raise NotReadyError

    # ---- in the thread ----

    def _run(self, key: tuple[str, str], job: Callable[[], Any]) -> None:
        result = job()
        with self._lock:
            self._pending.discard(key)
            self._results[key] = (time.monotonic(), result)

    def _scan(self) -> list[DirectoryEntry]:
        try:
            with os.scandir(self._path) as listing:
                names = sorted(each.name for each in listing if self._serves(each.name))
        except OSError:
            return []
        found = ((name, self._find(name)) for name in names[-MAX_ENTRIES:])
        return [DirectoryEntry(name, content.size) for name, content in found if content is not None]

    def _find(self, name: str) -> Content | None:
        try:
            status = os.stat(self._path / name, follow_symlinks=False)
        except OSError:
            return None
        served = stat.S_ISREG(status.st_mode) and status.st_size <= MAX_SIZE
        return _DiskContent(self, name, status.st_size) if served else None

    def _read(self, name: str, offset: int, size: int) -> bytes:
        try:
            # Non-blocking: the file may have been replaced by a pipe.
            descriptor = os.open(self._path / name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        except OSError:
            return b""
        try:
            regular = stat.S_ISREG(os.fstat(descriptor).st_mode)
            return os.pread(descriptor, size, offset) if regular else b""
        except OSError:
            return b""
        finally:
            os.close(descriptor)

    def _remove(self, name: str) -> FtpError | None:
        if self._find(name) is None:
            return FtpError.NOT_FOUND
        if not self._removable(name):
            return FtpError.PROTECTED
        try:
            os.unlink(self._path / name)
        except OSError:
            return FtpError.FAIL
        return None

    def _clear(self) -> None:
        for entry in self._scan():
            self._remove(entry.name)


class _Piece(NamedTuple):
    """A part of a file in memory."""

    start: int
    requested: int
    """Number of bytes requested; `data` is shorter at the end of the file."""
    data: bytes


class _DiskContent:
    """An open file, with one piece of it in memory."""

    def __init__(self, folder: DiskFolder, name: str, size: int) -> None:
        self._folder = folder
        self._name = name
        self._size = size
        self._piece = _Piece(0, 0, b"")
        self._fetching = False

    @property
    def size(self) -> int:
        """Size in bytes."""
        return self._size

    def read(self, offset: int, size: int) -> bytes | None:
        """Return bytes from memory; None while they are being fetched. A truncated or removed file gives fewer."""
        size = min(size, self._size - offset)
        if size <= 0:
            return b""
        start, requested, data = self._piece
        if start <= offset and offset + size <= start + requested:
            return data[offset - start : offset - start + size]
        if not self._fetching:
            self._fetch(offset, max(size, PIECE))
        return None

    def _fetch(self, offset: int, size: int) -> None:
        def receive(data: bytes) -> None:
            self._piece = _Piece(offset, size, data)
            self._fetching = False

        self._fetching = True  # before the job is queued: the thread may finish before fetch() returns
        if not self._folder.fetch(self._name, offset, size, receive):
            self._fetching = False
