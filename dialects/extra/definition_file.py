"""Parses one definition file. Nothing of it is executed, and no other file is opened.

pymavlink's own parser (mavparse.py) evaluates the values of enum entries as Python, and has no protection against
entities that expand without end. Documents with a DOCTYPE, and so with entities of their own, are refused here.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from xml.parsers import expat

from dialects.extra.attributes import Attributes, read_entry, read_field, read_id, read_name
from dialects.extra.definitions import DefinitionFile, Entry, EnumDefinition, ExtraDefinition, Field, FilePosition
from dialects.extra.errors import DialectError
from dialects.printable import printable

FILE_MAX = 4 << 20
"""Bytes of a file; common.xml has 0.6 MB."""
DEPTH_MAX = 32
"""Elements inside each other; MAVLink's definitions have 6."""
PAYLOAD_MAX = 255
FIELDS_MAX = 64
"""Fields of a message (mavparse.py)."""

_ROOT = ""
_TEXTS = frozenset({"description", "deprecated", "superseded", "wip"})
_CHILDREN: dict[str, frozenset[str]] = {
    _ROOT: frozenset({"mavlink"}),
    "mavlink": frozenset({"include", "version", "dialect", "enums", "messages"}),
    "enums": frozenset({"enum"}),
    "enum": _TEXTS | {"entry"},
    "messages": frozenset({"message"}),
    "message": _TEXTS | {"field", "extensions"},
}
"""Element -> those that may stand in it (mavschema.xsd). What stands in others is documentation and not read."""


def read_definitions(path: Path, name: str) -> DefinitionFile:
    """Parse a file that error messages call `name`. Raises DialectError."""
    if not path.is_file():  # reading a pipe or a device might never end
        raise DialectError(f"{name}: not a file: name the XML file of the dialect")
    try:
        with path.open("rb") as file:
            data = file.read(FILE_MAX + 1)
    except OSError as error:
        raise DialectError(f"{name}: {error.strerror}") from error
    if len(data) > FILE_MAX:
        raise DialectError(f"{name}: larger than {FILE_MAX >> 20} MiB: this is not a MAVLink definition")
    return _Parser(name).parse(data)


class _Parser:
    """Collects the elements of one document."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._open: list[str] = [_ROOT]
        self._text: list[str] = []
        """Of the include that is open."""
        self._includes: list[tuple[str, FilePosition]] = []
        self._messages: list[ExtraDefinition] = []
        self._enums: list[EnumDefinition] = []
        self._head: tuple[str, int, bool, FilePosition] = ("", 0, False, FilePosition(name, 0))
        """Of the message or enum that is open: name, id, whether it is a bitmask, place."""
        self._fields: list[Field] = []
        self._base_fields: int | None = None
        """Number of fields before the extensions, once those begin."""
        self._entries: list[Entry] = []
        self._highest = 0
        """Highest value of those entries, at least 0."""
        self._xml = expat.ParserCreate()
        self._xml.StartElementHandler = self._start
        self._xml.EndElementHandler = self._end
        self._xml.StartDoctypeDeclHandler = self._refuse_doctype
        self._begin: dict[str, Callable[[Attributes, FilePosition], None]] = {
            "include": self._begin_include,
            "enum": self._begin_enum,
            "entry": self._add_entry,
            "message": self._begin_message,
            "field": self._add_field,
            "extensions": self._begin_extensions,
        }
        self._finish = {"include": self._end_include, "enum": self._end_enum, "message": self._end_message}

    def parse(self, data: bytes) -> DefinitionFile:
        """Return the content. Raises DialectError."""
        try:
            self._xml.Parse(data, True)
        except expat.ExpatError as error:
            what = expat.ErrorString(error.code)
            raise DialectError(
                f"{self._name}:{error.lineno}: not XML ({what}): correct it or name another file"
            ) from error
        except (LookupError, ValueError) as error:
            raise DialectError(f"{self._name}:1: unknown encoding: save the file as UTF-8") from error
        return DefinitionFile(tuple(self._includes), tuple(self._messages), tuple(self._enums))

    @property
    def _place(self) -> FilePosition:
        return FilePosition(self._name, self._xml.CurrentLineNumber)

    # ---- expat's handlers ----

    def _start(self, element: str, attributes: Attributes) -> None:
        parent, place = self._open[-1], self._place
        allowed = _CHILDREN.get(parent)
        if len(self._open) > DEPTH_MAX:
            raise DialectError(f"{place}: more than {DEPTH_MAX} elements inside each other: no MAVLink definition")
        if allowed is not None and element not in allowed:
            raise DialectError(f"{place}: <{printable(element[:40])}> is not known here: {_expected(parent, allowed)}")
        self._open.append(element if allowed is not None else "documentation")
        if allowed is not None and element in self._begin:
            self._begin[element](attributes, place)

    def _end(self, _: str) -> None:
        element = self._open.pop()
        if element in self._finish:
            self._finish[element]()

    def _refuse_doctype(self, *_: object) -> None:
        raise DialectError(f"{self._place}: a DOCTYPE, which MAVLink definitions do not have: delete it")

    # ---- elements ----

    def _begin_include(self, _: Attributes, place: FilePosition) -> None:
        self._text = []
        self._xml.CharacterDataHandler = self._text.append
        self._head = ("", 0, False, place)

    def _end_include(self) -> None:
        self._xml.CharacterDataHandler = None
        self._includes.append(("".join(self._text).strip(), self._head[3]))

    def _begin_enum(self, attributes: Attributes, place: FilePosition) -> None:
        self._head = (read_name(attributes, "enum", place), 0, attributes.get("bitmask") == "true", place)
        self._entries, self._highest = [], 0

    def _add_entry(self, attributes: Attributes, place: FilePosition) -> None:
        entry = read_entry(attributes, self._highest, place)
        self._highest = max(self._highest, entry.value)
        self._entries.append(entry)

    def _end_enum(self) -> None:
        name, _, bitmask, place = self._head
        self._enums.append(EnumDefinition(name, bitmask, tuple(self._entries), place))

    def _begin_message(self, attributes: Attributes, place: FilePosition) -> None:
        self._head = (read_name(attributes, "message", place), read_id(attributes, place), False, place)
        self._fields, self._base_fields = [], None

    def _begin_extensions(self, _: Attributes, place: FilePosition) -> None:
        if self._base_fields is not None:
            raise DialectError(f"{place}: {self._head[0]} has <extensions> twice: keep the first")
        self._base_fields = len(self._fields)

    def _add_field(self, attributes: Attributes, place: FilePosition) -> None:
        field = read_field(attributes, place)
        if any(each.name == field.name for each in self._fields):
            raise DialectError(f"{place}: {self._head[0]} has a field {field.name} already: rename one of them")
        if len(self._fields) >= FIELDS_MAX:
            raise DialectError(f"{place}: {self._head[0]} has more than {FIELDS_MAX} fields: MAVLink allows no more")
        self._fields.append(field)

    def _end_message(self) -> None:
        name, number, _, place = self._head
        base = len(self._fields) if self._base_fields is None else self._base_fields
        message = ExtraDefinition(number, name, tuple(self._fields[:base]), tuple(self._fields[base:]), place)
        if not base:
            raise DialectError(f"{place}: {name} has no fields: add one, at least one before the extensions")
        if message.size > PAYLOAD_MAX:
            raise DialectError(
                f"{place}: {name} has {message.size} bytes of payload: MAVLink carries {PAYLOAD_MAX}, shorten an array"
            )
        self._messages.append(message)


def _expected(parent: str, allowed: frozenset[str]) -> str:
    if parent == _ROOT:
        return "a MAVLink definition begins with <mavlink>"
    return f"<{parent}> has {', '.join(sorted(allowed))}"
