"""Makes the class of a message, with its decoder and encoder, from its definition: tables only, no generated code.

The class has what build.py's generated classes have for those who read any message: id, names, types, units, enums.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

from dialects.extra.definitions import TYPES, ExtraDefinition, Field
from dialects.extra.dialect import Enum
from dialects.messages import ExtraMessage, Message


def make_class(definition: ExtraDefinition, enums: Mapping[str, Enum]) -> type[ExtraMessage]:
    """Return the class of a message."""
    fields, order = (*definition.fields, *definition.extensions), definition.wire_order
    return type(
        f"MAVLink_{definition.name.lower()}_message",
        (ExtraMessage,),
        {
            "id": definition.id,
            "msgname": definition.name,
            "fieldnames": [each.name for each in fields],
            "ordered_fieldnames": [each.name for each in order],
            "fieldtypes": [each.type for each in fields],
            "fieldunits_by_name": {each.name: each.units for each in fields if each.units},
            "fieldenums_by_name": {each.name: each.enum for each in fields if each.enum},
            "fielddisplays_by_name": {each.name: "bitmask" for each in fields if _is_bitmask(each, enums)},
            "native_format": bytearray(b"<" + "".join(TYPES[each.type] for each in order).encode()),
            "array_lengths": [each.length for each in order],
            "crc_extra": definition.crc_extra,
            "unpacker": struct.Struct("<" + "".join(each.format for each in order)),
        },
    )


def make_decoder(message: type[ExtraMessage], definition: ExtraDefinition) -> Callable[[bytes], Message]:
    """Return a function from a whole payload to the message."""
    order, unpack = definition.wire_order, message.unpacker.unpack
    return lambda payload: message(dict(_values(order, unpack(payload))))


def make_encoder(message: type[ExtraMessage], definition: ExtraDefinition) -> Callable[[Any], bytes]:
    """Return a function from the message to its whole payload."""
    order, pack = definition.wire_order, message.unpacker.pack
    return lambda given: pack(*_items(order, given.values))


def _is_bitmask(field: Field, enums: Mapping[str, Enum]) -> bool:
    return field.bitmask or (field.enum in enums and enums[field.enum].bitmask)


def _values(order: Sequence[Field], unpacked: Sequence[Any]) -> Iterator[tuple[str, Any]]:
    """Yield name and value of each field."""
    items = iter(unpacked)
    for each in order:
        if each.type == "char":
            yield each.name, next(items).rstrip(b"\0") if each.length else next(items)
        else:
            yield each.name, list(islice(items, each.length)) if each.length else next(items)


def _items(order: Sequence[Field], values: Mapping[str, Any]) -> Iterator[Any]:
    for each in order:
        value = values[each.name]
        if each.length and each.type != "char":
            yield from value
        else:
            yield value
