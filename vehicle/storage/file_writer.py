"""FileWriter: saves files in a folder, each completely or not at all, from a thread; the control loop never waits.

A new file is written beside the old one, synced to the disk, and renamed over the old one in one step: after a power
cut either the old or the new file exists. A file that is damaged all the same is renamed to `NAME.damaged`, and
reported until a good one is written.
"""

from __future__ import annotations

import contextlib
import errno
import os
import stat
import threading
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

from link.runtime.worker import Worker
from vehicle.storage.checksummed_file import CorruptFileError
from vehicle.storage.store import PendingWrite

CLOSE_TIMEOUT = 2.0
"""s that the end of the program waits for the last write; a disk that takes longer is broken."""

T = TypeVar("T")


def read_file(path: Path, parse: Callable[[bytes], T]) -> T | None:
    """Return the parsed content of a file, None if it does not exist. `parse` raises CorruptFileError.

    Raises CorruptFileError, with a text that follows the name of the file, also if a damaged file was set aside earlier
    and no good one has been written since.
    """
    aside = path.with_name(f"{path.name}.damaged")
    try:
        return parse(_read_bytes(path))
    except FileNotFoundError:
        if aside.exists():
            raise CorruptFileError("damaged") from None
        return None
    except CorruptFileError:
        with contextlib.suppress(OSError):  # on a read-only disk the file stays where it is
            path.replace(aside)
        raise CorruptFileError("damaged") from None
    except OSError as error:
        raise CorruptFileError(f"cannot be read, {error.strerror}") from error


def _read_bytes(path: Path) -> bytes:
    """Read a regular file: opening a pipe would block, and a device may have no end. Raises OSError."""
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "not a regular file", str(path))
        return file.read()


class FileWriter:
    """Writes files into one folder, one after the other, in a thread of its own. A vehicle.storage.store.Store."""

    def __init__(self, folder: Path) -> None:
        self.problem: str | None = None
        """Why the last file was not written; the previous one is still there."""
        self._folder = folder
        self._lock = threading.Lock()
        self._newest: dict[str, tuple[Callable[[], bytes], list[PendingWrite]]] = {}
        """Name -> the newest content that waits to be written, however slow the disk is, and all requests that it
        completes."""
        self._unwritten = 0
        """Number of files that wait or are being written."""
        self._worker = Worker("file writer", limit=0)  # unlimited: a file waits once, so jobs are at most the files

    @property
    def idle(self) -> bool:
        """Every requested write is complete or has failed."""
        return not self._unwritten

    def read(self, name: str, parse: Callable[[bytes], T]) -> T | None:
        """Return the parsed content of a file, None if it does not exist. Blocks. Raises CorruptFileError."""
        return read_file(self._folder / name, parse)

    def write(self, name: str, make: Callable[[], bytes]) -> PendingWrite:
        """Queue a file for writing and return at once.

        `make` builds the bytes, in the thread, unless a newer request for the same file replaces this one first.
        """
        request = PendingWrite()
        with self._lock:
            _, requests = self._newest.get(name, (make, []))
            if not requests:
                self._unwritten += 1
                self._worker.submit(partial(self._write_newest, name))
            self._newest[name] = make, [*requests, request]
        return request

    def close(self) -> None:
        """Wait until the queued files are written, at most CLOSE_TIMEOUT s."""
        self._worker.close(CLOSE_TIMEOUT)

    def _write_newest(self, name: str) -> None:
        with self._lock:
            make, requests = self._newest.pop(name)
        try:
            self._write(self._folder / name, make())
            self.problem = None
        except OSError as error:
            self.problem = str(error.strerror)
        for request in requests:
            request.problem, request.done = self.problem, True
        with self._lock:
            self._unwritten -= 1

    def _write(self, path: Path, data: bytes) -> None:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        new = path.with_name(f"{path.name}.new")
        descriptor = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC, 0o600)
        try:
            written = os.write(descriptor, data)
            if written != len(data):
                raise OSError(0, "No space left on device")
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
        new.replace(path)
        self._sync_folder()

    def _sync_folder(self) -> None:
        """Sync the folder: after a power cut the new file could exist without its name otherwise."""
        folder = os.open(self._folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
