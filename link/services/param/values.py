"""Names and values of PARAM_VALUE: several types inside one float."""

from __future__ import annotations

import math
import re
import struct

from dialects.enums import Autopilot, Capability, ParamErrorCode
from link.services.param.float32 import is_exact_float32, is_float32, same_float32, shortest_float32

REAL32 = 9
"""MAV_PARAM_TYPE_REAL32."""
NAME_SIZE = 16
"""Bytes of `param_id`."""

_FORMATS: dict[int, tuple[str, int, int]] = {
    1: ("<Bxxx", 0, 0xFF),
    2: ("<bxxx", -0x80, 0x7F),
    3: ("<Hxx", 0, 0xFFFF),
    4: ("<hxx", -0x8000, 0x7FFF),
    5: ("<I", 0, 0xFFFF_FFFF),
    6: ("<i", -0x8000_0000, 0x7FFF_FFFF),
}
"""MAV_PARAM_TYPE of an integer -> its place in the four bytes (the first ones), smallest, largest."""
_WHOLE = frozenset({*_FORMATS, 7, 8})
"""MAV_PARAM_TYPE of integers; UINT64 and INT64 do not fit into four bytes."""
_FLOAT = struct.Struct("<f")
_ESCAPED = re.compile(r"\\x([0-9a-f]{2})")


def name_from_wire(raw: bytes) -> str:
    r"""Return the name in `param_id`. A byte that is not a printable ASCII character becomes e.g. "\xff".

    So two names are never equal unless their bytes are, and the name can be sent back.
    """
    name = raw.split(b"\0", 1)[0][:NAME_SIZE]
    return "".join(chr(byte) if 0x20 < byte < 0x7F and byte != 0x5C else f"\\x{byte:02x}" for byte in name)


def name_to_wire(name: str) -> bytes | None:
    """Return `param_id` for a name; None if it does not fit: cut to 16 bytes it could be another parameter's."""
    if not name.isascii():
        return None
    raw = _ESCAPED.sub(lambda found: chr(int(found[1], 16)), name).encode("latin-1")
    return raw if 0 < len(raw) <= NAME_SIZE and b"\0" not in raw else None


def is_bytewise(autopilot: int, capabilities: int) -> bool:
    """Return whether integers are stored in the bytes of `param_value` (https://mavlink.io/en/services/parameter.html).

    Where `capabilities` (AUTOPILOT_VERSION) name neither encoding, ArduPilot casts and all others store bytes, as
    QGroundControl and MAVSDK assume.
    """
    if capabilities & Capability.PARAM_C_CAST:
        return False
    return bool(capabilities & Capability.PARAM_BYTEWISE) or autopilot != Autopilot.ARDUPILOT


def is_whole(kind: int) -> bool:
    """Return whether a MAV_PARAM_TYPE is one of integers."""
    return kind in _WHOLE


def same_value(one: float, other: float, kind: int) -> bool:
    """Return whether two values of a parameter are the same: integers exactly, others as float32."""
    return one == other if kind in _WHOLE else same_float32(one, other)


def is_carried(value: float, kind: int, *, bytewise: bool) -> bool:
    """Return whether PARAM_SET carries an integer as it is: cast to float32, most above 2**24 become another one."""
    return kind not in _WHOLE or (bytewise and kind in _FORMATS) or is_exact_float32(value)


def value_fault(value: float, kind: int, *, bytewise: bool) -> ParamErrorCode | None:
    """Return why `value` cannot be sent as MAV_PARAM_TYPE `kind`, or None."""
    if not is_float32(value):
        return ParamErrorCode.VALUE_OUT_OF_RANGE
    if kind not in _WHOLE:
        return None
    if value != round(value):
        return ParamErrorCode.TYPE_MISMATCH
    _, low, high = _FORMATS.get(kind, ("", -math.inf, math.inf))
    fits = low <= value <= high and is_carried(value, kind, bytewise=bytewise)
    return None if fits else ParamErrorCode.VALUE_OUT_OF_RANGE


def from_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """Return the number in `param_value`. `bytewise`: integers are stored in the float's bytes (PX4).

    Types that do not fit into four bytes (UINT64, INT64, REAL64) are sent as their value.
    """
    if not bytewise or kind not in _FORMATS:
        return value if kind in _WHOLE else shortest_float32(value)
    return float(struct.unpack(_FORMATS[kind][0], _FLOAT.pack(value))[0])


def to_wire(value: float, kind: int, *, bytewise: bool) -> float:
    """Return `param_value` for a value without `value_fault`."""
    if not bytewise or kind not in _FORMATS:
        return value
    return float(_FLOAT.unpack(struct.pack(_FORMATS[kind][0], round(value)))[0])
