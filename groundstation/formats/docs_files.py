"""Chooses how a file with texts of parameters is read: apm.pdef.xml, apm.pdef.json, or PX4's parameters.json."""

from __future__ import annotations

import msgspec

from dialects.enums import Autopilot
from groundstation.formats.errors import FileFormatError
from groundstation.formats.metadata_json import XZ, load_json, parse_parameters
from groundstation.formats.param_docs import ParamDocs
from groundstation.formats.pdef import parse_pdef_json, parse_pdef_xml

FILE_NAMES = {
    "apm.pdef.xml": Autopilot.ARDUPILOT,
    "apm.pdef.json": Autopilot.ARDUPILOT,
    "parameters.json": Autopilot.PX4,
    "parameters.json.xz": Autopilot.PX4,
}
"""Names that are looked for in the configuration folder, and whose parameters they describe; the first found counts."""


class DocsFile(msgspec.Struct, frozen=True):
    """Texts of a file of the user, or why there are none."""

    docs: ParamDocs = msgspec.field(default_factory=ParamDocs)
    autopilot: int | None = None
    """MAV_AUTOPILOT that they are for; None: any."""
    problem: str = ""
    """One line."""


def parse_docs(data: bytes, where: str) -> ParamDocs:
    """Return the texts of a file of any of these forms. Raises FileFormatError."""
    if data.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
        return parse_pdef_xml(data, where)
    if not data.startswith(XZ):
        content = load_json(data, where)
        if isinstance(content, dict) and "parameters" not in content:
            return parse_pdef_json(data, where)
    return parse_parameters(data, where)


def read_docs(data: bytes, where: str, autopilot: int | None) -> DocsFile:
    """Return the texts of a file, or what is wrong with it."""
    try:
        return DocsFile(parse_docs(data, where), autopilot)
    except FileFormatError as error:
        return DocsFile(autopilot=autopilot, problem=str(error))
