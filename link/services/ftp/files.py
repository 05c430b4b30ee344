"""The served files: a tree of folders, each with its own provider, apart from the real file system.

Paths are parsed only here: at most one folder and one file, printable characters only, no `..`, no `.`. Providers get a
name without any slash, so that no path can leave the tree, and there are no links to follow.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

import msgspec

from link.services.ftp.protocol import FtpError

Query = Mapping[str, str]
"""The part of a path behind `?`."""


class DirectoryEntry(NamedTuple):
    """A line of a listing."""

    name: str
    size: int | None
    """Bytes; None: a folder."""


class Content(Protocol):
    """An open file."""

    @property
    def size(self) -> int:
        """Bytes; constant while the file is open."""

    def read(self, offset: int, size: int) -> bytes | None:
        """Return up to `size` bytes, fewer only at the end; None: not read yet, try again at the next tick."""


class NotReadyError(Exception):
    """The disk has not answered; the same call at a later tick returns the result."""


class Folder(Protocol):
    """A provider of files.

    It is called inside the control loop and must not wait for a disk: all methods but `writable` may raise
    NotReadyError.
    """

    def entries(self) -> Sequence[DirectoryEntry]:
        """Return the files, in a stable order."""

    def open(self, name: str, query: Query) -> Content | None:
        """Open a file; None if it does not exist."""

    def writable(self, name: str) -> bool:
        """Return whether a file of this name may be written at all."""

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Write a whole file; return an error or None."""

    def remove(self, name: str) -> FtpError | None:
        """Remove a file; return an error or None."""


class BytesContent(msgspec.Struct, frozen=True):
    """Content in memory."""

    data: bytes

    @property
    def size(self) -> int:
        """Bytes."""
        return len(self.data)

    def read(self, offset: int, size: int) -> bytes:
        """Return up to `size` bytes."""
        return self.data[offset : offset + size]


class ReadOnlyFolder:
    """The writing half of a Folder, for a read-only one."""

    def writable(self, name: str) -> bool:
        """Return False."""
        return False

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Return PROTECTED."""
        return FtpError.PROTECTED

    def remove(self, name: str) -> FtpError | None:
        """Return PROTECTED."""
        return FtpError.PROTECTED


class GeneratedFolder(ReadOnlyFolder):
    """Files that are generated when they are opened, e.g. `param.pck`."""

    def __init__(self, makers: Mapping[str, Callable[[Query], bytes | None]]) -> None:
        self._makers = makers

    def entries(self) -> list[DirectoryEntry]:
        """Return the files with their sizes without a query."""
        made = ((name, make({})) for name, make in self._makers.items())
        return [DirectoryEntry(name, len(data)) for name, data in made if data is not None]

    def open(self, name: str, query: Query) -> Content | None:
        """Generate the file; None also for an invalid query."""
        make = self._makers.get(name)
        data = make(query) if make else None
        return None if data is None else BytesContent(data)


class MemoryFolder(msgspec.Struct):
    """Files in memory: a simulated vehicle's disk, and small files of a real one (missions)."""

    files: dict[str, bytes] = msgspec.field(default_factory=dict)
    accept: Callable[[str, bytes], FtpError | None] | None = None
    """Returns why a file may not be written, or None. Without it the folder is read-only."""
    changed: Callable[[str, bytes | None], None] = lambda name, data: None
    """Gets the data that was written, or None for a removed file, to save it."""
    capacity: int = 64

    def entries(self) -> list[DirectoryEntry]:
        """Return the files by name."""
        return [DirectoryEntry(name, len(self.files[name])) for name in sorted(self.files)]

    def open(self, name: str, query: Query) -> Content | None:
        """Open the file as it is now: a later store does not change what is open."""
        return BytesContent(self.files[name]) if name in self.files and not query else None

    def writable(self, name: str) -> bool:
        """Return whether the folder can be written."""
        return self.accept is not None

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Write or replace a file."""
        if self.accept is None:
            return FtpError.PROTECTED
        if name not in self.files and len(self.files) >= self.capacity:
            return FtpError.FAIL
        refused = self.accept(name, data)
        if refused is None:
            self.files[name] = data
            self.changed(name, data)
        return refused

    def remove(self, name: str) -> FtpError | None:
        """Remove a file, where files may be written."""
        if self.accept is None:
            return FtpError.PROTECTED
        if self.files.pop(name, None) is None:
            return FtpError.NOT_FOUND
        self.changed(name, None)
        return None


class Location(NamedTuple):
    """Where a path leads: a folder, and the name of a file in it (empty: the folder itself)."""

    folder: Folder
    name: str
    query: Query


class FileTree:
    """All served files: `root` at the top, `folders` by name below it, e.g. "logs" or "@PARAM"."""

    def __init__(self, root: Folder, folders: Mapping[str, Folder]) -> None:
        self._root = root
        self._folders = folders

    def find(self, raw: bytes) -> Location | None:
        """Return where the path `raw` (as received) leads, or None."""
        text = _text(raw)
        if text is None:
            return None
        path, _, query = text.partition("?")
        parts = _parts(path)
        if parts is None or not all(map(_plain, parts)):
            return None
        match parts:
            case []:
                return Location(self._root, "", {})
            case [name] if name in self._folders:
                return Location(self._folders[name], "", {})
            case [name]:
                return Location(self._root, name, _query(query))
            case [folder, name] if folder in self._folders:
                return Location(self._folders[folder], name, _query(query))
        return None

    def listing(self, folder: Folder) -> list[DirectoryEntry]:
        """Return the entries of a folder; in the root the other folders come first."""
        folders = [DirectoryEntry(name, None) for name in sorted(self._folders)] if folder is self._root else []
        return folders + list(folder.entries())


def _text(raw: bytes) -> str | None:
    """Return the path as text; None unless it is printable ASCII with NUL only at the end."""
    ended, _, rest = raw.partition(b"\0")
    if rest.strip(b"\0") or not ended.isascii():
        return None
    text = ended.decode("ascii")
    return text if text.isprintable() else None


def _parts(path: str) -> list[str] | None:
    """Split `path` at its slashes, without one at either end."""
    path = path.removeprefix("/").removesuffix("/")
    return path.split("/") if path else []


def _plain(part: str) -> bool:
    return part not in ("", ".", "..") and "\\" not in part


def _query(text: str) -> Query:
    pairs = (pair.partition("=") for pair in text.split("&") if pair)
    return {key: value for key, _, value in pairs}
