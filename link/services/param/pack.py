"""All parameters as one file, `@PARAM/param.pck`, in ArduPilot's packed format.

MAVProxy and Mission Planner request it first, because it takes a fifth of the messages. Header: magic, number of
parameters in the file, total number, each uint16. Each parameter: a byte of type (low nibble) and flags (high; 1: the
default follows), a byte of how many characters are shared with the previous name (low) and how many follow less one
(high), those characters, the value, the default where flagged. All little-endian.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence

from link.services.param.float32 import same_float32
from link.services.param.server import ParamDefinition, ParamValues

MAGIC, MAGIC_DEFAULTS = 0x671B, 0x671C
FLOAT = 4
"""ArduPilot's AP_PARAM_FLOAT, the type of all our parameters."""
HAS_DEFAULT = 1
MAX_SHARED = 15


def pack(table: Sequence[ParamDefinition], values: ParamValues, query: Mapping[str, str] | None = None) -> bytes | None:
    """Return the file; None for an invalid `query` (withdefaults, start, count; behind the path's `?`)."""
    try:
        options = {key: int(text) for key, text in (query or {}).items()}
    except ValueError:
        return None
    defaults, start, count = options.get("withdefaults", 0), options.get("start", 0), options.get("count", 0)
    if defaults not in (0, 1) or not 0 <= start < max(1, len(table)) or count < 0:
        return None
    chosen = table[start : start + count] if count else table[start:]
    packed = bytearray(struct.pack("<HHH", MAGIC_DEFAULTS if defaults else MAGIC, len(chosen), len(table)))
    before = ""
    for setting in chosen:
        packed += _one(setting, values[setting.name], before, with_default=bool(defaults))
        before = setting.name
    return bytes(packed)


def _one(setting: ParamDefinition, value: float, before: str, *, with_default: bool) -> bytes:
    shared = _shared(before, setting.name)
    rest = setting.name[shared:].encode("ascii")
    flagged = with_default and not same_float32(value, setting.default)
    head = bytes([FLOAT | (HAS_DEFAULT << 4 if flagged else 0), shared | (len(rest) - 1) << 4])
    default = struct.pack("<f", setting.default) if flagged else b""
    return head + rest + struct.pack("<f", value) + default


def _shared(before: str, name: str) -> int:
    """Return how many characters both names share at their start, leaving at least one of `name`."""
    longest = min(len(before), len(name) - 1, MAX_SHARED)
    return next((at for at in range(longest) if before[at] != name[at]), longest)
