"""A real folder, served: its own regular files and nothing else, read piece by piece in a thread of its own.

Rules: a name leads to a file of this folder or nowhere (no link is followed, at no point: a file is opened by its name
beside the folder, and must be a regular one); nothing is written; a file in memory is never more than PIECE.
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
from link.services.ftp.files import Content, Entry, NotReadyError, Query, ReadOnlyFolder
from link.services.ftp.protocol import FtpError

PIECE = 64 * 1024
"""Bytes that are read at once: a sixth of a second of the fastest download."""
MAX_ENTRIES = 1000
"""Files that are listed: the last ones by name."""
MAX_NAME = 100
"""Characters: several lines of a listing fit into one message."""
MAX_ASKED = 32
"""Questions to the disk at once: one each for all clients of files (16) and logs (8)."""
MAX_SIZE = 2**32 - 1
"""Bytes: FTP and the log protocol say no more. A longer file, which is none of ours, is not served."""
FRESH = 1.0
"""s in which an answer of the disk must be fetched; a client that no longer waits left it."""
CLOSE_TIMEOUT = 1.0


class DiskFolder(ReadOnlyFolder):
    """Files of `path` whose names end in `suffix`. Fits `ftp_files.Folder`; see `NotReadyError` for how it never waits.

    `removable` says in the thread whether a file may be removed now; who may ask for it at all is not decided here.
    """

    def __init__(self, path: Path, *, suffix: str, removable: Callable[[str], bool]) -> None:
        self._path = path
        self._suffix = suffix
        self._removable = removable
        self._worker = Worker("files", 2 * MAX_ASKED)
        self._lock = threading.Lock()
        self._asked: set[tuple[str, str]] = set()
        self._answers: dict[tuple[str, str], tuple[float, Any]] = {}

    def entries(self) -> list[Entry]:
        """As they are now, by name; none where the folder cannot be read. Raises NotYetError."""
        entries: list[Entry] = self._ask(("list", ""), self._scan)
        return entries

    def open(self, name: str, query: Query) -> Content | None:
        """The file as long as it is now: one that grows does not, for who has it open. Raises NotYetError."""
        if query or not self._serves(name):
            return None
        content: Content | None = self._ask(("open", name), lambda: self._found(name))
        return content

    def remove(self, name: str) -> FtpError | None:
        """Remove a file. Raises NotYetError."""
        if not self._serves(name):
            return FtpError.NOT_FOUND
        error: FtpError | None = self._ask(("remove", name), lambda: self._remove(name))
        return error

    def clear(self) -> None:
        """Remove all files that may be removed, soon."""
        self._worker.submit(self._clear)

    def close(self) -> None:
        """End the thread."""
        self._worker.close(CLOSE_TIMEOUT)

    def fetch(self, name: str, offset: int, size: int, take: Callable[[bytes], None]) -> bool:
        """Have `take` called in the thread with a part of a file, empty where there is none; False: try again later."""
        return self._worker.submit(lambda: take(self._read(name, offset, size)))

    def _serves(self, name: str) -> bool:
        """Is this a name that a file here could have? No path, nothing hidden, nothing that a listing cannot say."""
        plain = name.isascii() and name.isprintable() and "/" not in name and not name.startswith(".")
        return plain and name.endswith(self._suffix) and len(name) <= MAX_NAME

    def _ask(self, key: tuple[str, str], job: Callable[[], Any]) -> Any:
        """The disk's answer, once, where it is there and fresh; otherwise it is asked for. Raises NotYetError."""
        now = time.monotonic()
        with self._lock:
            self._answers = {each: answer for each, answer in self._answers.items() if now - answer[0] < FRESH}
            if key in self._answers:
                return self._answers.pop(key)[1]
            if (
                key not in self._asked
                and len(self._asked) < MAX_ASKED
                and self._worker.submit(lambda: self._do(key, job))
            ):
                self._asked.add(key)
        raise NotReadyError

    # ---- in the thread ----

    def _do(self, key: tuple[str, str], job: Callable[[], Any]) -> None:
        answer = job()
        with self._lock:
            self._asked.discard(key)
            self._answers[key] = (time.monotonic(), answer)

    def _scan(self) -> list[Entry]:
        try:
            with os.scandir(self._path) as listing:
                names = sorted(each.name for each in listing if self._serves(each.name))
        except OSError:
            return []
        found = ((name, self._found(name)) for name in names[-MAX_ENTRIES:])
        return [Entry(name, content.size) for name, content in found if content is not None]

    def _found(self, name: str) -> Content | None:
        try:
            status = os.stat(self._path / name, follow_symlinks=False)
        except OSError:
            return None
        served = stat.S_ISREG(status.st_mode) and status.st_size <= MAX_SIZE
        return _DiskContent(self, name, status.st_size) if served else None

    def _read(self, name: str, offset: int, size: int) -> bytes:
        try:
            # Not blocking: somebody may have put a pipe in place of the file.
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
        if self._found(name) is None:
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
    """A part of a file, in memory."""

    start: int
    asked: int
    """Bytes that were asked for; fewer are here where the file ends before."""
    data: bytes


class _DiskContent:
    """A file by its name, with one piece of it in memory."""

    def __init__(self, folder: DiskFolder, name: str, size: int) -> None:
        self._folder = folder
        self._name = name
        self._size = size
        self._piece = _Piece(0, 0, b"")
        self._coming = False

    @property
    def size(self) -> int:
        """Bytes."""
        return self._size

    def read(self, offset: int, size: int) -> bytes | None:
        """From memory, or None and soon there. Fewer also where somebody cut the file, none where it is gone."""
        size = min(size, self._size - offset)
        if size <= 0:
            return b""
        start, asked, data = self._piece
        if start <= offset and offset + size <= start + asked:
            return data[offset - start : offset - start + size]
        if not self._coming:
            self._fetch(offset, max(size, PIECE))
        return None

    def _fetch(self, offset: int, size: int) -> None:
        def take(data: bytes) -> None:
            self._piece = _Piece(offset, size, data)
            self._coming = False

        self._coming = True  # before the thread hears of it: it may be done before fetch() returns
        if not self._folder.fetch(self._name, offset, size, take):
            self._coming = False
