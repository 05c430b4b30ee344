"""Parameter files (.param, .parm, .params) of MAVProxy, QGroundControl and Mission Planner.

MAVProxy: `NAME value`, the name padded to 16 characters. Mission Planner: `NAME,value`. QGroundControl: vehicle id,
component id, name, value and MAV_PARAM_TYPE, separated by tabs
(https://docs.qgroundcontrol.com/master/en/qgc-dev-guide/file_formats/parameters.html). `#` begins a comment.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Callable, Iterable, Sequence

import msgspec

from groundstation.formats.errors import FileFormatError, shown
from groundstation.formats.param_form import ParamForm
from link.services.param.client import Param
from link.services.param.float32 import is_float32, same_float32, value_text
from link.services.param.values import NAME_SIZE, is_whole, name_to_wire

MAX_LINES = 20_000
"""Lines of a file; ten times the parameters of the largest autopilot. More is not a parameter file."""

MAX_NAMED = 20
"""Names in a line for people."""


class ParamLine(msgspec.Struct, frozen=True):
    """One parameter of a file."""

    name: str
    value: float
    text: str
    """The value as the file has it."""
    line: int
    """Number of the line, from 1."""
    component: int | None = None
    """MAVLink component id; only QGroundControl writes it."""
    kind: int | None = None
    """MAV_PARAM_TYPE; only QGroundControl writes it."""


class ParamFile(msgspec.Struct, frozen=True):
    """What a file holds, in its order."""

    form: ParamForm
    lines: tuple[ParamLine, ...]


def parse_params(text: str, source: str) -> ParamFile:
    """Parse a file of any form. Raises FileFormatError, with `source` and the line number, at the first error."""
    form: ParamForm | None = None
    lines: dict[tuple[int | None, str], ParamLine] = {}
    for number, raw in enumerate(text.removeprefix("\ufeff").split("\n"), start=1):
        where = f"{source}:{number}"
        if number > MAX_LINES:
            raise FileFormatError(f"{where}: more than {MAX_LINES} lines: this is not a parameter file")
        content = raw.partition("#")[0].strip()
        if not content:
            continue
        form = form or _form_of(content)
        line = _parse_line(content, number, where)
        first = lines.setdefault((line.component, line.name), line)
        if first is not line:
            raise FileFormatError(f"{where}: {line.name} is given twice, first in line {first.line}: remove one")
    if form is None:
        raise FileFormatError(f"{source}: no parameters in it")
    return ParamFile(form, tuple(lines.values()))


def split_unset(params: Iterable[Param]) -> tuple[list[Param], tuple[str, ...]]:
    """Return the parameters that a file can hold, and the names of the others: PX4 reports NaN where none is set."""
    chosen = list(params)
    unset = tuple(param.name for param in chosen if not math.isfinite(param.value))
    return [param for param in chosen if math.isfinite(param.value)], unset


def unset_text(names: Sequence[str]) -> str:
    """Return which parameters a file does not have, as the end of a line; empty without any."""
    return f"; left out, no number: {shortened_list(names)}" if names else ""


def shortened_list(names: Sequence[str]) -> str:
    """Return the first names, and how many more there are."""
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return ", ".join(names[:MAX_NAMED]) + more


def format_params(params: Iterable[Param], form: ParamForm, *, vehicle: int = 1, component: int = 1) -> str:
    """Return the text of a file with these parameters, sorted by name. Their values are finite (`split_unset`)."""
    chosen = sorted(params, key=lambda param: param.name)
    if form is ParamForm.QGROUNDCONTROL:
        return _header(vehicle) + "".join(
            f"{vehicle}\t{component}\t{_word(param.name)}\t{_full(param)}\t{param.kind}\n" for param in chosen
        )
    return "".join(_WRITERS[form](param) for param in chosen)


def _form_of(content: str) -> ParamForm:
    if len(content.split("\t")) >= 4:
        return ParamForm.QGROUNDCONTROL
    return ParamForm.MISSION_PLANNER if "," in content else ParamForm.MAVPROXY


def _parse_line(content: str, number: int, where: str) -> ParamLine:
    """Parse one line without its comment; forms may be mixed, as all ground stations read them."""
    fields = content.replace(",", " ").split()
    if len(fields) == 2:
        return _line(fields[0], fields[1], number, where)
    if len(fields) == 5 and "\t" in content:
        component, kind = _whole(fields[1], "component id", where), _whole(fields[4], "type", where)
        return _line(fields[2], fields[3], number, where, component, kind)
    raise FileFormatError(f"{where}: {shown(content)} is neither 'NAME value' nor a line of QGroundControl")


def _line(
    name: str, text: str, number: int, where: str, component: int | None = None, kind: int | None = None
) -> ParamLine:
    if name_to_wire(name) is None:
        raise FileFormatError(f"{where}: {shown(name)} is not a name of at most {NAME_SIZE} ASCII characters")
    name = _SET_IN.sub(lambda found: chr(int(found[1], 16)), name)
    return ParamLine(name, _value(text, name, where), text, number, component, kind)


def _value(text: str, name: str, where: str) -> float:
    try:
        value = float(int(text, 16)) if text.lower().startswith("0x") else float(text)
    except (ValueError, OverflowError):
        raise FileFormatError(f"{where}: the value of {name}, {shown(text)}, is not a number") from None
    if not is_float32(value):
        raise FileFormatError(f"{where}: the value of {name}, {shown(text)}, cannot be set")
    return value


def _whole(text: str, what: str, where: str) -> int:
    if not (text.isascii() and text.isdecimal() and int(text[:4]) <= 255 and len(text) <= 3):
        raise FileFormatError(f"{where}: the {what}, {shown(text)}, is not a number from 0 to 255")
    return int(text)


# ---- writing ----


_SEPARATORS = re.compile(r"[ ,#\t]")
_SET_IN = re.compile(r"\\x(20|2c|23)")


def _word(name: str) -> str:
    r"""Return a name without what divides the words of a line, e.g. a space as "\x20".

    A vehicle chooses its names: as it is, `OTHER 0 #` would be a line for OTHER.
    """
    return _SEPARATORS.sub(lambda found: f"\\x{ord(found[0]):02x}", name)


def _mavproxy(param: Param) -> str:
    """Return a line as MAVProxy writes it, with more digits where six decimals are not enough."""
    text = f"{param.value:f}"
    text = text if same_float32(float(text), param.value) else f"{param.value:.9g}"
    return f"{_word(param.name):<16} {text}\n"


def _mission_planner(param: Param) -> str:
    return f"{_word(param.name)},{value_text(param.value)}\n"


_WRITERS: dict[ParamForm, Callable[[Param], str]] = {
    ParamForm.MAVPROXY: _mavproxy,
    ParamForm.MISSION_PLANNER: _mission_planner,
}


def _header(vehicle: int) -> str:
    return f"# Onboard parameters for Vehicle {vehicle}\n#\n# Vehicle-Id Component-Id Name Value Type\n"


def _full(param: Param) -> str:
    """Return the value as QGroundControl writes it: whole numbers plain, floats with 18 decimals."""
    if is_whole(param.kind):
        return f"{param.value:.0f}"
    (exact,) = struct.unpack("<f", struct.pack("<f", param.value))
    text = f"{exact:.18f}"
    return text if same_float32(float(text), exact) else f"{exact:.9g}"
