"""ArduPilot's parameter files apm.pdef.xml and apm.pdef.json (https://autotest.ardupilot.org/Parameters/)."""

from __future__ import annotations

import re
from typing import Any
from xml.parsers import expat

from groundstation.formats.errors import FileFormatError
from groundstation.formats.metadata_json import load_json
from groundstation.formats.param_docs import MAX_CHOICES, MAX_DOCS, ParamDocs, number_of, text_of
from groundstation.views.params import ParamDoc

_RANGE = re.compile(r"^\s*(\S+?)(?:\s+to|\s*[,:]|\s)\s*(\S+)\s*$")
_TRUE = ("true", "1", "yes")


def parse_pdef_json(data: bytes, where: str) -> ParamDocs:
    """Return the texts in an apm.pdef.json. Raises FileFormatError."""
    content = load_json(data, where)
    if not isinstance(content, dict):
        raise FileFormatError(f"{where}: this is not an object with groups of parameters")
    docs: dict[str, ParamDoc] = {}
    for group in content.values():
        for name, entry in group.items() if isinstance(group, dict) else ():
            if isinstance(entry, dict):
                _add(docs, _json_doc(name, entry), where)
    if not docs:
        raise FileFormatError(f"{where}: no parameters in it")
    return ParamDocs(where, docs)


def _json_doc(name: str, entry: dict[str, Any]) -> ParamDoc:
    ends = entry.get("Range")
    low, high = (ends.get("low"), ends.get("high")) if isinstance(ends, dict) else (None, None)
    return ParamDoc(
        name=name.rpartition(":")[2],
        title=text_of(entry.get("DisplayName")),
        text=text_of(entry.get("Description")),
        unit=text_of(entry.get("Units")),
        low=number_of(low),
        high=number_of(high),
        step=number_of(entry.get("Increment")),
        values=_values(_pairs(entry.get("Values"))),
        bits=_bits(_pairs(entry.get("Bitmask"))),
        reboot=text_of(entry.get("RebootRequired")).lower() in _TRUE,
        read_only=text_of(entry.get("ReadOnly")).lower() in _TRUE,
    )


def _pairs(value: object) -> list[tuple[str, str]]:
    """Return codes and names, of an object or of a text such as "0:Off,1:On"."""
    if isinstance(value, dict):
        return [(str(code), text_of(name)) for code, name in list(value.items())[:MAX_CHOICES]]
    if isinstance(value, str):
        found = [part.partition(":") for part in value.split(",")[:MAX_CHOICES]]
        return [(code.strip(), text_of(name)) for code, colon, name in found if colon]
    return []


def _values(pairs: list[tuple[str, str]]) -> tuple[tuple[float, str], ...]:
    return tuple((value, name) for code, name in pairs if (value := number_of(code)) is not None)


def _bits(pairs: list[tuple[str, str]]) -> tuple[tuple[int, str], ...]:
    return tuple((int(bit), name) for code, name in pairs if (bit := number_of(code)) is not None and 0 <= bit < 64)


def _add(docs: dict[str, ParamDoc], doc: ParamDoc, where: str) -> None:
    if len(docs) >= MAX_DOCS:
        raise FileFormatError(f"{where}: more than {MAX_DOCS} parameters")
    docs[doc.name] = doc


# ---- XML ----


class _PdefReader:
    """Collects the parameters while expat reads the file."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.docs: dict[str, ParamDoc] = {}
        self._attributes: dict[str, str] | None = None
        self._fields: dict[str, str] = {}
        self._choices: dict[str, list[tuple[str, str]]] = {"value": [], "bit": []}
        self._path: tuple[str, str] | None = None
        """Element with a text that is wanted: "field" with its name, or "value" or "bit" with its code."""
        self._text = ""

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        """Begin an element."""
        if tag == "param":
            self._attributes, self._fields, self._choices = attributes, {}, {"value": [], "bit": []}
        elif self._attributes is not None and tag in ("field", "value", "bit"):
            self._path, self._text = (tag, attributes.get("name" if tag == "field" else "code", "")), ""

    def text(self, data: str) -> None:
        """Handle a piece of a text."""
        if self._path is not None and len(self._text) < 10_000:
            self._text += data

    def end(self, tag: str) -> None:
        """End an element."""
        if self._path is not None and tag == self._path[0]:
            if tag == "field":
                self._fields[self._path[1]] = self._text
            elif len(self._choices[tag]) < MAX_CHOICES:
                self._choices[tag].append((self._path[1], text_of(self._text)))
            self._path = None
        elif tag == "param" and self._attributes is not None:
            _add(self.docs, self._doc(self._attributes), self.where)
            self._attributes = None

    def _doc(self, attributes: dict[str, str]) -> ParamDoc:
        fields = self._fields
        ends = _RANGE.match(fields.get("Range", ""))
        return ParamDoc(
            name=attributes.get("name", "").rpartition(":")[2],
            title=text_of(attributes.get("humanName")),
            text=text_of(attributes.get("documentation")),
            unit=text_of(fields.get("Units")),
            low=number_of(ends[1]) if ends else None,
            high=number_of(ends[2]) if ends else None,
            step=number_of(fields.get("Increment")),
            values=_values(self._choices["value"]),
            bits=_bits(self._choices["bit"] or _pairs(fields.get("Bitmask"))),
            reboot=text_of(fields.get("RebootRequired")).lower() in _TRUE,
            read_only=text_of(fields.get("ReadOnly")).lower() in _TRUE,
        )


def parse_pdef_xml(data: bytes, where: str) -> ParamDocs:
    """Return the texts in an apm.pdef.xml. Raises FileFormatError, also for a file that defines entities."""

    def refuse(*_: object) -> None:
        raise FileFormatError(f"{where}:{parser.CurrentLineNumber}: a DOCTYPE with entities is not accepted")

    reader, parser = _PdefReader(where), expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler = reader.start, reader.end
    parser.CharacterDataHandler, parser.StartDoctypeDeclHandler = reader.text, refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        raise FileFormatError(f"{where}:{error.lineno}: damaged XML: {expat.ErrorString(error.code)}") from None
    if not reader.docs:
        raise FileFormatError(f"{where}: no parameters in it")
    return ParamDocs(where, reader.docs)
