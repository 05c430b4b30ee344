"""Reads `@PARAM/param.pck`, the file with all parameters of a vehicle; pack.py describes its format."""

from __future__ import annotations

import struct

import msgspec

from link.services.param.client import MAX_PARAMS, Param
from link.services.param.float32 import shortest_float32
from link.services.param.pack import HAS_DEFAULT, MAGIC, MAGIC_DEFAULTS
from link.services.param.values import NAME_SIZE, REAL32, name_from_wire

PATH = "@PARAM/param.pck"
PATH_WITH_DEFAULTS = f"{PATH}?withdefaults=1"
_HEADER = struct.Struct("<HHH")
_TYPES: dict[int, tuple[struct.Struct, int]] = {
    1: (struct.Struct("<b"), 2),
    2: (struct.Struct("<h"), 4),
    3: (struct.Struct("<i"), 6),
    4: (struct.Struct("<f"), REAL32),
}
"""ArduPilot's ap_var_type -> its bytes, and MAV_PARAM_TYPE."""


class _Reader(msgspec.Struct):
    """A position in the file."""

    data: bytes
    at: int = 0

    def take(self, size: int) -> bytes:
        """Return the next `size` bytes, fewer at the end."""
        taken = self.data[self.at : self.at + size]
        self.at += size
        return taken

    def skip_padding(self) -> bool:
        """Skip the zeros that ArduPilot puts between records; return whether a record follows."""
        while self.at < len(self.data) and self.data[self.at] == 0:
            self.at += 1
        return self.at < len(self.data)


def unpack(data: bytes) -> list[Param] | str:
    """Return the parameters in the order of the file, or what is wrong with it."""
    if len(data) < _HEADER.size:
        return "param.pck is too short"
    magic, count, total = _HEADER.unpack_from(data)
    if magic not in (MAGIC, MAGIC_DEFAULTS):
        return f"param.pck begins with 0x{magic:04x}"
    reader, params, before = _Reader(data, _HEADER.size), list[Param](), b""
    while reader.skip_padding() and len(params) < MAX_PARAMS:
        record = _record(reader, before, with_defaults=magic == MAGIC_DEFAULTS)
        if record is None:
            return f"param.pck is damaged behind parameter {len(params)}"
        before, param = record
        params.append(param)
    if not len(params) == count == total:
        return f"param.pck has {len(params)} of {total} parameters"
    return params


def _record(reader: _Reader, before: bytes, *, with_defaults: bool) -> tuple[bytes, Param] | None:
    """Return the next name and parameter; None if they are damaged. `before`: the name in front."""
    kinds, lengths = reader.take(2).ljust(2, b"\0")
    shared, own = lengths & 0x0F, (lengths >> 4) + 1
    name = before[:shared] + reader.take(own)
    if kinds & 0x0F not in _TYPES or len(name) != shared + own or len(name) > NAME_SIZE:
        return None
    form, kind = _TYPES[kinds & 0x0F]
    flagged = with_defaults and kinds >> 4 & HAS_DEFAULT
    raw = reader.take(form.size), reader.take(form.size if flagged else 0)
    if len(raw[0]) != form.size or len(raw[1]) not in (0, form.size):
        return None
    value = _number(form, raw[0])
    default = (_number(form, raw[1]) if flagged else value) if with_defaults else None
    return name, Param(name_from_wire(name), value, kind, None, default)


def _number(form: struct.Struct, raw: bytes) -> float:
    (number,) = form.unpack(raw)
    return shortest_float32(number) if form.format == "<f" else float(number)
