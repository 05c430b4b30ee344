"""The folder that keeps things over a restart: written by a thread, whole or not at all; the loop never waits.

A new file is written beside the old one, brought to the disk, and takes its name in one step: a power cut leaves the
old file or the new one. A file that is damaged nevertheless is kept aside, and counts until a good one is written.
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

CLOSE_TIMEOUT = 2.0
"""s that the end of the program waits for the last write; a disk that takes longer is broken."""

T = TypeVar("T")


def read_file(path: Path, parse: Callable[[bytes], T]) -> T | None:
    """What a file holds; None where there is none. `parse` raises DamagedError.

    Raises DamagedError, in words to be put behind the name of what is missing, also where a damaged file was found and
    put aside before and no good one was written since.
    """
    aside = path.with_name(f"{path.name}.damaged")
    try:
        return parse(_bytes(path))
    except FileNotFoundError:
        if aside.exists():
            raise CorruptFileError("damaged") from None
        return None
    except CorruptFileError:
        with contextlib.suppress(OSError):  # read-only: then it stays where it is
            path.replace(aside)
        raise CorruptFileError("damaged") from None
    except OSError as error:
        raise CorruptFileError(f"cannot be read, {error.strerror}") from error


def _bytes(path: Path) -> bytes:
    """Of a regular file: a pipe in its place would be waited for, and a device may have no end. Raises OSError."""
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "no regular file", str(path))
        return file.read()


class PendingWrite:
    """One wish to write a file, and how it went."""

    def __init__(self) -> None:
        self.done = False
        """The file is on the disk, or a newer one of its name is, or there is a problem."""
        self.problem: str | None = None


class FileWriter:
    """Writes files into one folder, one after the other, in a thread of its own."""

    def __init__(self, folder: Path) -> None:
        self.problem: str | None = None
        """Why the last file was not written; the one before is still there."""
        self._folder = folder
        self._lock = threading.Lock()
        self._newest: dict[str, tuple[Callable[[], bytes], list[PendingWrite]]] = {}
        """What waits to be written: of each file what was wanted last, however slow the disk is, and whose wish it was
        or would have been."""
        self._unwritten = 0
        """Files that wait, or are being written."""
        self._worker = Worker("scribe", limit=0)  # a file waits once, so that there are no more jobs than files

    @property
    def idle(self) -> bool:
        """Everything that was wanted is written, or failed."""
        return not self._unwritten

    def write(self, name: str, make: Callable[[], bytes]) -> PendingWrite:
        """Have a file written. Returns at once; `make` gives its bytes, in the thread, unless a newer wish for the same
        file comes before its turn.
        """
        wish = PendingWrite()
        with self._lock:
            _, wishes = self._newest.get(name, (make, []))
            if not wishes:
                self._unwritten += 1
                self._worker.submit(partial(self._write_newest, name))
            self._newest[name] = make, [*wishes, wish]
        return wish

    def close(self) -> None:
        """Wait for what is being written."""
        self._worker.close(CLOSE_TIMEOUT)

    def _write_newest(self, name: str) -> None:
        with self._lock:
            make, wishes = self._newest.pop(name)
        try:
            self._write(self._folder / name, make())
            self.problem = None
        except OSError as error:
            self.problem = str(error.strerror)
        for wish in wishes:
            wish.problem, wish.done = self.problem, True
        with self._lock:
            self._unwritten -= 1

    def _write(self, path: Path, data: bytes) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
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
        self._bring_names_to_disk()

    def _bring_names_to_disk(self) -> None:
        """Without it the new file may be there after a power cut, and its name not."""
        folder = os.open(self._folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
