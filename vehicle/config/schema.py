"""The JSON schema of rover.toml, for checks and completion in editors; `mavhelm vehicle schema` prints it."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

import msgspec

from link.runtime.docstrings import field_docs
from vehicle.accessories.drivers import DRIVERS as ACCESSORY_DRIVERS
from vehicle.accessories.settings import COMMON
from vehicle.accessories.settings import settings_type as settings_type_of
from vehicle.config.config import Config
from vehicle.config.template import parameter_help
from vehicle.motors.drivers import DRIVERS, profile_settings, settings_type
from vehicle.motors.settings import CommonMotorSettings, NoSettings
from vehicle.params import TABLE, Parameter


def build_schema() -> str:
    """Return the JSON schema."""
    kinds = {name: settings_type(name) or NoSettings for name in DRIVERS}
    accessories = {
        (kind, name): settings_type_of(kind, name) or NoSettings for kind in COMMON for name in ACCESSORY_DRIVERS[kind]
    }
    structs = [Config, CommonMotorSettings, *COMMON.values(), *dict.fromkeys([*kinds.values(), *accessories.values()])]
    _, parts = msgspec.json.schema_components(structs, ref_template="#/$defs/{name}")
    _describe(parts, _structs(structs))
    config = parts.pop("Config")
    common_motor = parts.pop("CommonMotorSettings")
    own = {kind.__name__: parts.pop(kind.__name__) for kind in dict.fromkeys([*kinds.values(), *accessories.values()])}
    common = {kind: parts.pop(each.__name__) for kind, each in COMMON.items()}
    for which, known in common.items():
        variants = [
            _accessory_schema(name, own[each.__name__], known)
            for (of, name), each in accessories.items()
            if of == which
        ]
        parts["Accessories"]["properties"][f"{which}s"]["items"] = {"oneOf": [*variants, _own(known)]}
    drivers = [_driver_schema(name, own[kind.__name__], common_motor) for name, kind in kinds.items()]
    config["properties"]["motors"] = {"oneOf": [*drivers, _OWN_DRIVER]}
    config["properties"]["params"] = {
        "type": "object", "additionalProperties": False,
        "properties": {parameter.name: _parameter_schema(parameter) for parameter in TABLE},
    }  # fmt: skip
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "rover.toml"}
    return json.dumps({**config, **head, "$defs": parts}, indent=1) + "\n"


def _accessory_schema(name: str, own: Mapping[str, Any], common: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "title": name,
        "description": own.get("description", ""),
        "properties": {"driver": {"const": name}, **common["properties"], **own["properties"]},
        "required": ["driver", *common["required"], *own.get("required", ())],
        "additionalProperties": False,
    }


def _own(common: Mapping[str, Any]) -> dict[str, Any]:
    """Return the schema of an accessory with a driver from outside, whose own settings are unknown."""
    return {
        **_OWN_DRIVER,
        "properties": {**_OWN_DRIVER["properties"], **common["properties"]},
        "required": ["driver", *common["required"]],
    }


_OWN_DRIVER: dict[str, Any] = {
    "type": "object",
    "description": "A driver of your own: module:Class.",
    "properties": {"driver": {"type": "string", "pattern": ":"}},
    "required": ["driver"],
}


def _driver_schema(name: str, own: Mapping[str, Any], common: Mapping[str, Any]) -> dict[str, Any]:
    known = profile_settings(name)
    return {
        "type": "object",
        "title": name,
        "description": own.get("description", ""),
        "properties": {"driver": {"const": name}, **own["properties"], **common["properties"]},
        "required": ["driver", *(key for key in own.get("required", ()) if key not in known)],
        "additionalProperties": False,
    }


def _parameter_schema(parameter: Parameter) -> dict[str, Any]:
    return {
        "type": "integer" if parameter.whole else "number",
        "minimum": parameter.low, "maximum": parameter.high, "default": parameter.default,
        "description": parameter_help(parameter),
    }  # fmt: skip


def _structs(kinds: Iterable[type]) -> dict[str, type]:
    """Return all structs used by `kinds`, by name."""
    found: dict[str, type] = {}
    waiting: list[Any] = [msgspec.inspect.type_info(kind) for kind in kinds]
    while waiting:
        each = waiting.pop()
        if isinstance(each, msgspec.inspect.StructType) and each.cls.__name__ not in found:
            found[each.cls.__name__] = each.cls
            waiting += [field.type for field in each.fields]
        waiting += getattr(each, "types", ())
        waiting += [part for name in ("item_type", "type") if (part := getattr(each, name, None)) is not None]
    return found


def _describe(parts: Mapping[str, Any], structs: Mapping[str, type]) -> None:
    for name, part in parts.items():
        docs = field_docs(structs[name]) if name in structs else {}
        for key, text in docs.items():
            part["properties"][key]["description"] = text
