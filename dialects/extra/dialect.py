"""Reads a definition file with its includes, and joins them to one dialect."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec
import pymavlink
from msgspec.structs import replace

from dialects.extra.definition_file import read_definitions
from dialects.extra.definitions import DefinitionFile, Entry, EnumDefinition, ExtraDefinition, FilePosition
from dialects.extra.errors import DialectError
from dialects.printable import printable

SHIPPED = Path(pymavlink.__file__).resolve().parent / "dialects" / "v20"
"""The definitions of the installed pymavlink, such as common.xml and ardupilotmega.xml."""
FILES_MAX = 64
"""Files of one dialect; all.xml of pymavlink has 18."""


class Enum(msgspec.Struct, frozen=True):
    """An enum of all files."""

    name: str
    bitmask: bool
    names: Mapping[int, str]
    """Value -> name of the entry."""


class Dialect(msgspec.Struct, frozen=True):
    """The messages and enums of a file and of those that it includes."""

    messages: tuple[ExtraDefinition, ...]
    enums: Mapping[str, Enum]


def load(text: str) -> Dialect:
    """Read the file that the user named, and its includes. Raises DialectError.

    Files are looked for in the folder of the file that includes them, beside the user's file, then among the
    definitions of pymavlink. A file of pymavlink includes those beside the user's file first, so that of two files
    with one name only one is read.
    """
    files = _Files(Path(text).parent)
    files.read(text, None)
    parts = tuple(files.parts.values())
    return Dialect(_join_messages(parts), _join_enums(parts))


class _Files(msgspec.Struct):
    """The files read so far. `home`: the folder of the user's file."""

    home: Path
    parts: dict[Path, DefinitionFile] = msgspec.field(default_factory=dict)
    """In the order in which they were found: a file goes before those that it includes."""
    _open: list[Path] = msgspec.field(default_factory=list)
    """The files that include each other, down to the one that is read."""

    def read(self, text: str, place: FilePosition | None) -> None:
        """Read a file, unless it was read, and those that it includes. `place`: the include, None for the first."""
        path, name = self._find(text, place)
        if path in self._open:
            raise DialectError(
                f"{place}: {printable(text)} includes itself, over {len(self._open)} files: delete one <include>"
            )
        if path in self.parts:
            return
        if len(self.parts) >= FILES_MAX:
            raise DialectError(f"{place}: more than {FILES_MAX} files in one dialect: delete some <include>")
        part = self.parts[path] = read_definitions(path, name)
        self._open.append(path)
        for include, where in part.includes:
            self.read(include, where)
        self._open.pop()

    def _find(self, text: str, place: FilePosition | None) -> tuple[Path, str]:
        """Return the path of a file, and its name for error messages."""
        for folder in self._folders(place):
            if text and os.path.exists(folder / text):  # Path.exists raises for a long name
                return (folder / text).resolve(), printable(text if place is None else str(folder / text))
        raise DialectError(_missing(text, place))

    def _folders(self, place: FilePosition | None) -> tuple[Path, ...]:
        if place is None:
            return (Path(), SHIPPED)
        beside = self._open[-1].parent
        return (self.home, SHIPPED) if beside == SHIPPED else (beside, self.home, SHIPPED)


def _missing(text: str, place: FilePosition | None) -> str:
    if place is None:
        shipped = bool(text) and os.path.exists(SHIPPED / f"{text}.xml")
        what = f"did you mean {text}.xml?" if shipped else "name the XML file of the dialect"
        return f"{printable(text)}: no such file: {what}"
    return f"{place}: include {text[:80]!a} is neither beside this file nor among pymavlink's: copy it there"


def _join_messages(parts: Iterable[DefinitionFile]) -> tuple[ExtraDefinition, ...]:
    ids: dict[int, ExtraDefinition] = {}
    names: dict[str, ExtraDefinition] = {}
    for message in (each for part in parts for each in part.messages):
        twin = ids.setdefault(message.id, message)
        if twin is not message:
            raise DialectError(f"{message.place}: {message.name} has the id {message.id} of {_at(twin)}: change one")
        twin = names.setdefault(message.name, message)
        if twin is not message:
            raise DialectError(f"{message.place}: the name of {_at(twin)} again: rename one")
    return tuple(ids.values())


def _at(message: ExtraDefinition) -> str:
    return f"{message.name} ({message.place})"


def _join_enums(parts: Iterable[DefinitionFile]) -> dict[str, Enum]:
    joined: dict[str, EnumDefinition] = {}
    for more in (each for part in parts for each in part.enums):
        before = joined.get(more.name)
        joined[more.name] = more if before is None else _extend(before, more)
    return {name: Enum(name, each.bitmask, _names(each)) for name, each in joined.items()}


def _extend(enum: EnumDefinition, more: EnumDefinition) -> EnumDefinition:
    """Return an enum with the entries of a further file.

    Where their ranges overlap, values that were given automatically move above the further ones, as mavgen moves them
    (mavparse.merge_enums), because vehicles are built with those numbers.
    """
    entries = list(enum.entries)
    highest = max((each.value for each in more.entries), default=0)
    lowest = min((each.value for each in more.entries), default=0)
    overlap = bool(entries) and min(e.value for e in entries) <= highest and max(e.value for e in entries) >= lowest
    for at, each in enumerate(entries if overlap else ()):
        if each.automatic and each.value <= highest:
            highest += 1
            entries[at] = replace(each, value=highest)
    return replace(enum, bitmask=enum.bitmask or more.bitmask, entries=(*entries, *more.entries))


def _names(enum: EnumDefinition) -> dict[int, str]:
    values: dict[int, Entry] = {}
    names: dict[str, Entry] = {}
    for entry in enum.entries:
        twin = values.setdefault(entry.value, entry)
        if twin is not entry:
            raise DialectError(
                f"{entry.place}: {entry.name} has the value {entry.value} of {twin.name} ({twin.place}): change one"
            )
        twin = names.setdefault(entry.name, entry)
        if twin is not entry:
            raise DialectError(f"{entry.place}: {entry.name} is in {enum.name} already ({twin.place}): rename one")
    return {value: entry.name for value, entry in sorted(values.items())}
