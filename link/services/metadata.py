"""Component metadata: files that describe this vehicle's parameters to a ground station.

Built once, from the parameter table. Source: https://mavlink.io/en/services/component_information.html. Schemas:
mavlink/component_metadata/{general,parameter}.schema.json; version 1, because QGroundControl rejects any other.
"""

from __future__ import annotations

import json
import lzma
import re
from functools import lru_cache
from typing import Any

import msgspec

from dialects import messages as m
from link.services.ftp.protocol import crc32
from link.services.param.server import ParamDefinition

GENERAL_FILE, PARAMETER_FILE = "general.json.xz", "parameter.json.xz"
PARAMETER_TYPE = 1
"""COMP_METADATA_TYPE_PARAMETER."""
VERSION = 1
DICTIONARY = 1 << 16
"""Bytes of the compressor's window: the files are smaller, and compressing with the default 8 MB window takes 94 MB."""
DECIMALS = 3
_CHOICE = re.compile(r"(?:^|: |, )(\d+):? ([^,;]+)")
"""A value with its name in a description."""


class Metadata(msgspec.Struct, frozen=True):
    """The files, as served in the root of MAVLink FTP."""

    general: bytes
    parameters: bytes

    @property
    def files(self) -> dict[str, bytes]:
        """The files by name."""
        return {GENERAL_FILE: self.general, PARAMETER_FILE: self.parameters}

    def message(self, time_boot_ms: int) -> m.ComponentMetadata:
        """Return COMPONENT_METADATA: the URI of the general file, and the checksum by which it may be cached."""
        return m.ComponentMetadata(time_boot_ms, crc32(self.general), _uri(GENERAL_FILE).encode())


@lru_cache(maxsize=16)
def build_metadata(table: tuple[ParamDefinition, ...], *, vendor: str, model: str, version: str) -> Metadata:
    """Build all files. `version` is that of the vehicle's software: three numbers separated by dots.

    Cached, because compressing takes most of the time that a vehicle needs to start.
    """
    parameters = _compressed({"version": VERSION, "parameters": [_parameter(setting) for setting in table]})
    general = {
        "version": VERSION,
        "vendorName": vendor,
        "modelName": model,
        "firmwareVersion": version,
        "metadataTypes": [{"type": PARAMETER_TYPE, "uri": _uri(PARAMETER_FILE), "fileCrc": crc32(parameters)}],
    }
    return Metadata(_compressed(general), parameters)


def _parameter(setting: ParamDefinition) -> dict[str, Any]:
    described = {
        "name": setting.name,
        "type": "Float",
        "shortDesc": setting.description,
        "longDesc": setting.description + (". Not while armed." if setting.safety else ""),
        "units": setting.unit,
        "default": setting.default,
        "min": setting.low,
        "max": setting.high,
        "decimalPlaces": 0 if setting.whole else DECIMALS,
        "rebootRequired": setting.needs_reboot,
        "readOnly": setting.read_only,
        "group": setting.name.partition("_")[0].rstrip("0123456789"),
        "category": "Standard",
    }
    return described | ({"increment": 1} if setting.whole else {}) | _choices(setting)


def _choices(setting: ParamDefinition) -> dict[str, Any]:
    """Return the names of values or bits that the description lists: "Ground station lost: 0 no action, 1 HOLD"."""
    listed = [(int(code), name.strip()) for code, name in _CHOICE.findall(setting.description)]
    if not setting.whole or len(listed) < 2 or not all(setting.low <= code <= setting.high for code, _ in listed):
        return {}
    if setting.description.startswith("Bits: "):
        return {"bitmask": [{"index": code.bit_length() - 1, "description": name} for code, name in listed]}
    return {"values": [{"value": code, "description": name} for code, name in listed]}


def _compressed(content: dict[str, Any]) -> bytes:
    """Compress with CRC-32, the one checksum of xz-embedded (QGroundControl and MAVSDK)."""
    plain = json.dumps(content, separators=(",", ":")).encode()
    filters = [{"id": lzma.FILTER_LZMA2, "preset": 6, "dict_size": DICTIONARY}]
    return lzma.compress(plain, format=lzma.FORMAT_XZ, check=lzma.CHECK_CRC32, filters=filters)


def _uri(name: str) -> str:
    return f"mftp:///{name}"
