"""Component metadata: the JSON files with texts of parameters that vehicles serve, compressed with xz.

PX4 builds the same file as parameters.json. Source: https://mavlink.io/en/services/component_information.html.
"""

from __future__ import annotations

import json
import lzma
from typing import Any

from groundstation.formats.errors import FileFormatError
from groundstation.formats.param_docs import MAX_CHOICES, MAX_DOCS, ParamDocs, number_of, text_of
from groundstation.views.params import ParamDoc

MAX_SIZE = 16 * 1024 * 1024
"""Bytes of a decompressed file; PX4's has 1.5 MB."""
MEMORY = 80 * 1024 * 1024
"""Bytes that decompression may take: xz -9 needs 65 MiB, and PX4 packs with it."""
PARAMETER_TYPE = 1
"""COMP_METADATA_TYPE_PARAMETER."""
XZ = b"\xfd7zXZ\0"


def parse_general(data: bytes, where: str) -> str:
    """Return the URI of the parameter file that a general file names, empty if none. Raises FileFormatError."""
    content = load_json(data, where)
    types = content.get("metadataTypes") if isinstance(content, dict) else None
    for each in types if isinstance(types, list) else []:
        if isinstance(each, dict) and each.get("type") == PARAMETER_TYPE:
            uris = (each.get("uri"), each.get("uriMetaData"), each.get("uriMetaDataFallback"), each.get("uriFallback"))
            return next((uri for uri in uris if isinstance(uri, str) and uri.startswith("mftp:")), "")
    return ""


def parse_parameters(data: bytes, where: str) -> ParamDocs:
    """Return the texts in a parameter metadata file. Raises FileFormatError."""
    content = load_json(data, where)
    entries = content.get("parameters") if isinstance(content, dict) else None
    if not isinstance(entries, list):
        raise FileFormatError(f'{where}: there is no list "parameters" in it')
    if len(entries) > MAX_DOCS:
        raise FileFormatError(f"{where}: more than {MAX_DOCS} parameters")
    found = (_doc(each) for each in entries if isinstance(each, dict))
    return ParamDocs(where, {doc.name: doc for doc in found if doc.name})


def load_json(data: bytes, where: str) -> Any:
    """Return the content of a JSON file, compressed or not. Raises FileFormatError."""
    plain = _decompressed(data, where) if data.startswith(XZ) else data
    try:
        return json.loads(plain)
    except (ValueError, RecursionError) as error:
        line = f":{error.lineno}" if isinstance(error, json.JSONDecodeError) else ""
        what = error.msg if isinstance(error, json.JSONDecodeError) else type(error).__name__
        raise FileFormatError(f"{where}{line}: this is not JSON: {what}") from None


def _decompressed(data: bytes, where: str) -> bytes:
    try:
        unpacker = lzma.LZMADecompressor(lzma.FORMAT_XZ, memlimit=MEMORY)
        plain = unpacker.decompress(data, MAX_SIZE)
    except lzma.LZMAError as error:
        raise FileFormatError(f"{where}: damaged xz file: {error}") from None
    if not unpacker.eof:
        reason = f"more than {MAX_SIZE} bytes" if len(plain) >= MAX_SIZE else "its end is missing"
        raise FileFormatError(f"{where}: damaged xz file: {reason}")
    return plain


def _doc(entry: dict[str, Any]) -> ParamDoc:
    title, text = text_of(entry.get("shortDesc")), text_of(entry.get("longDesc"))
    return ParamDoc(
        name=text_of(entry.get("name")),
        title=title,
        text=text.removeprefix(title).lstrip(". "),
        unit=text_of(entry.get("units")),
        low=number_of(entry.get("min")),
        high=number_of(entry.get("max")),
        step=number_of(entry.get("increment")),
        default=number_of(entry.get("default")),
        values=tuple(
            (value, text_of(each.get("description")))
            for each in _objects(entry.get("values"))
            if (value := number_of(each.get("value"))) is not None
        ),
        bits=tuple(
            (int(bit), text_of(each.get("description")))
            for each in _objects(entry.get("bitmask"))
            if (bit := number_of(each.get("index"))) is not None and 0 <= bit < 64
        ),
        reboot=entry.get("rebootRequired") is True,
        read_only=entry.get("readOnly") is True,
        not_armed="not while armed" in text.lower(),
    )


def _objects(value: object) -> list[dict[str, Any]]:
    return [each for each in value[:MAX_CHOICES] if isinstance(each, dict)] if isinstance(value, list) else []
