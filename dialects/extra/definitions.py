"""Messages and enums as a definition file has them, and what follows from them: order on the wire, checksum.

Format: https://mavlink.io/en/guide/xml_schema.html; order and CRC_EXTRA: https://mavlink.io/en/guide/serialization.html.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import msgspec
from fastcrc.crc16 import mcrf4xx

TYPES: dict[str, str] = {
    "char": "c", "int8_t": "b", "uint8_t": "B", "int16_t": "h", "uint16_t": "H", "int32_t": "i", "uint32_t": "I",
    "int64_t": "q", "uint64_t": "Q", "float": "f", "double": "d",
}  # fmt: skip
"""Type of a field -> its code in a struct format."""

SIZES: dict[str, int] = {name: struct.calcsize("<" + code) for name, code in TYPES.items()}
"""Type of a field -> bytes."""


class FilePosition(msgspec.Struct, frozen=True):
    """Where in a definition file something stands."""

    file: str
    """As the user wrote it, or as the file is found."""
    line: int

    def __str__(self) -> str:
        return f"{self.file}:{self.line}"


class Field(msgspec.Struct, frozen=True):
    """One field of a message."""

    name: str
    type: str
    """One of TYPES."""
    length: int
    """Items of an array, 1..255; 0: no array."""
    units: str
    enum: str
    bitmask: bool
    """The field itself says that its bits are flags; its enum may say so as well."""
    place: FilePosition

    @property
    def size(self) -> int:
        """Bytes on the wire."""
        return SIZES[self.type] * (self.length or 1)

    @property
    def format(self) -> str:
        """Its part of the struct format: a text is one item, another array has one item per element."""
        if self.type == "char" and self.length:
            return f"{self.length}s"
        return f"{self.length or ''}{TYPES[self.type]}"


class ExtraDefinition(msgspec.Struct, frozen=True):
    """One message. `fields` and `extensions` are in the order of the file."""

    id: int
    name: str
    fields: tuple[Field, ...]
    extensions: tuple[Field, ...]
    place: FilePosition

    @property
    def wire_order(self) -> tuple[Field, ...]:
        """The fields as they are sent: those before the extensions by falling size of their type."""
        return (*sorted(self.fields, key=lambda each: -SIZES[each.type]), *self.extensions)

    @property
    def base_size(self) -> int:
        """Bytes of the payload without extensions."""
        return sum(each.size for each in self.fields)

    @property
    def size(self) -> int:
        """Bytes of the whole payload."""
        return self.base_size + sum(each.size for each in self.extensions)

    @property
    def crc_extra(self) -> int:
        """Last byte of the checksum, which differs where name, types, names or order of the fields differ."""
        crc = mcrf4xx(b"".join(self._signed_parts()))
        return int(crc & 0xFF ^ crc >> 8)

    def _signed_parts(self) -> Iterator[bytes]:
        yield f"{self.name} ".encode()
        for each in self.wire_order[: len(self.fields)]:
            yield f"{each.type} {each.name} ".encode()
            if each.length:
                yield bytes([each.length])


class Entry(msgspec.Struct, frozen=True):
    """One value of an enum."""

    name: str
    value: int
    automatic: bool
    """The file names no value: it is the one above the highest."""
    place: FilePosition


class EnumDefinition(msgspec.Struct, frozen=True):
    """An enum, or the part of it that one file defines."""

    name: str
    bitmask: bool
    entries: tuple[Entry, ...]
    place: FilePosition


class DefinitionFile(msgspec.Struct, frozen=True):
    """The content of one file."""

    includes: tuple[tuple[str, FilePosition], ...]
    messages: tuple[ExtraDefinition, ...]
    enums: tuple[EnumDefinition, ...]
