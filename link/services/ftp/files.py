"""The files that are served: a tree of folders, each from its own provider, and nothing of the real file system.

A path is taken apart here and nowhere else: at most one folder and one file, plain characters only, no `..`, no `.`.
Providers see a name without any slash, so that no path can leave the tree, and there are no links to follow.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

from link.services.ftp.protocol import FtpError

Query = Mapping[str, str]
"""What stands behind the `?` of a path."""


class Entry(NamedTuple):
    """A line of a listing."""

    name: str
    size: int | None
    """Bytes; None: a folder."""


class Content(Protocol):
    """A file that was opened."""

    @property
    def size(self) -> int:
        """Bytes. It does not change while the file is open."""

    def read(self, offset: int, size: int) -> bytes | None:
        """Up to `size` bytes, fewer only at the end; None: not here yet, ask again at the next tick."""


class NotReadyError(Exception):
    """The disk has not answered; the same question at a later tick gets its answer."""


class Folder(Protocol):
    """A provider of files. It is called inside the control loop and must not wait for a disk: all but `writable` may
    raise NotYetError.
    """

    def entries(self) -> Sequence[Entry]:
        """The files, in an order that stays."""

    def open(self, name: str, query: Query) -> Content | None:
        """The file, or None where there is none."""

    def writable(self, name: str) -> bool:
        """May a file of this name be written at all?"""

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Write a whole file; returns why not."""

    def remove(self, name: str) -> FtpError | None:
        """Remove a file; returns why not."""


@dataclass(frozen=True, slots=True)
class BytesContent:
    """Content that is in memory."""

    data: bytes

    @property
    def size(self) -> int:
        """Bytes."""
        return len(self.data)

    def read(self, offset: int, size: int) -> bytes:
        """Up to `size` bytes."""
        return self.data[offset : offset + size]


class ReadOnlyFolder:
    """The half of a Folder that writes, for one that does not."""

    def writable(self, name: str) -> bool:
        """Never."""
        return False

    def store(self, name: str, data: bytes) -> FtpError | None:
        """Never."""
        return FtpError.PROTECTED

    def remove(self, name: str) -> FtpError | None:
        """Never."""
        return FtpError.PROTECTED


class GeneratedFolder(ReadOnlyFolder):
    """Files that are made when somebody opens them, e.g. `param.pck`."""

    def __init__(self, makers: Mapping[str, Callable[[Query], bytes | None]]) -> None:
        self._makers = makers

    def entries(self) -> list[Entry]:
        """Their sizes are those without a query."""
        made = ((name, make({})) for name, make in self._makers.items())
        return [Entry(name, len(data)) for name, data in made if data is not None]

    def open(self, name: str, query: Query) -> Content | None:
        """None also for a query that its maker refuses."""
        make = self._makers.get(name)
        data = make(query) if make else None
        return None if data is None else BytesContent(data)


@dataclass(slots=True)
class MemoryFolder:
    """Files in memory: the whole of a simulated vehicle's disk, and what a real one keeps small enough (missions)."""

    files: dict[str, bytes] = field(default_factory=dict)
    accept: Callable[[str, bytes], FtpError | None] | None = None
    """Says why a file may not be written, or None: it may. Without it the folder is only read."""
    changed: Callable[[str, bytes | None], None] = lambda name, data: None
    """Is told what was written, or None for what was removed: the shell saves it."""
    capacity: int = 64

    def entries(self) -> list[Entry]:
        """By name."""
        return [Entry(name, len(self.files[name])) for name in sorted(self.files)]

    def open(self, name: str, query: Query) -> Content | None:
        """As it is now: a later store does not change what is open."""
        return BytesContent(self.files[name]) if name in self.files and not query else None

    def writable(self, name: str) -> bool:
        """Is there anybody who accepts?"""
        return self.accept is not None

    def store(self, name: str, data: bytes) -> FtpError | None:
        """In place of what had the name."""
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
        """Where files may be written they may be removed."""
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
    """All that is served. `root` has the files at the top, `folders` the others by name, e.g. "logs" or "@PARAM"."""

    def __init__(self, root: Folder, folders: Mapping[str, Folder]) -> None:
        self._root = root
        self._folders = folders

    def find(self, raw: bytes) -> Location | None:
        """Where the path `raw` (as it came) leads, or None where it leads nowhere or is none."""
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

    def listing(self, folder: Folder) -> list[Entry]:
        """What is in a folder; in the root the other folders come first."""
        folders = [Entry(name, None) for name in sorted(self._folders)] if folder is self._root else []
        return folders + list(folder.entries())


def _text(raw: bytes) -> str | None:
    """A path is ASCII; a NUL may end it but not stand inside."""
    ended, _, rest = raw.partition(b"\0")
    if rest.strip(b"\0") or not ended.isascii():
        return None
    text = ended.decode("ascii")
    return text if text.isprintable() else None


def _parts(path: str) -> list[str] | None:
    """`path` without one slash in front and one behind, at its slashes."""
    path = path.removeprefix("/").removesuffix("/")
    return path.split("/") if path else []


def _plain(part: str) -> bool:
    return part not in ("", ".", "..") and "\\" not in part


def _query(text: str) -> Query:
    pairs = (pair.partition("=") for pair in text.split("&") if pair)
    return {key: value for key, _, value in pairs}
