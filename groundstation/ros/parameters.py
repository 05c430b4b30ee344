"""Parameters of a vehicle as values of rcl_interfaces: an integer of MAVLink is an integer, the others are doubles."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from groundstation.ros.vehicle import Values
from link.services.param.client import Param
from link.services.param.values import REAL32

NOT_SET, BOOL, INTEGER, DOUBLE = 0, 1, 2, 3
"""rcl_interfaces/msg/ParameterType; a vehicle has no other types."""


def type_of(param: Param | None) -> int:
    """Return the type of a parameter; NOT_SET for one that the vehicle does not have."""
    if param is None:
        return NOT_SET
    return DOUBLE if param.kind >= REAL32 else INTEGER


def value_of(param: Param | None) -> Values:
    """Return a ParameterValue."""
    kind = type_of(param)
    value = param.value if param is not None else 0.0
    return {
        "type": kind,
        "bool_value": False,
        "integer_value": int(value) if kind == INTEGER and math.isfinite(value) else 0,
        "double_value": float(value) if kind == DOUBLE else 0.0,
        "string_value": "",
        "byte_array_value": [],
        "bool_array_value": [],
        "integer_array_value": [],
        "double_array_value": [],
        "string_array_value": [],
    }


def describe(name: str, param: Param | None) -> Values:
    """Return a ParameterDescriptor, with the default where the vehicle reports it."""
    known = param is not None and param.default is not None
    return {
        "name": name,
        "type": type_of(param),
        "description": f"default {param.default:g}" if known and param is not None else "",
        "additional_constraints": "",
        "read_only": False,
        "dynamic_typing": False,
        "floating_point_range": [],
        "integer_range": [],
    }


def matching(names: Iterable[str], prefixes: Iterable[str]) -> list[str]:
    """Return the names with one of the prefixes, in order; without prefixes all. A dot ends a prefix."""
    wanted = list(prefixes)
    return sorted(
        name for name in names if not wanted or any(name == each or name.startswith(f"{each}.") for each in wanted)
    )


def wanted_value(value: Values, name: str, params: Mapping[str, Param]) -> float | str:
    """Return the number that a ParameterValue sets a parameter to, or in one line why it cannot."""
    param = params.get(name)
    if param is None:
        return f"{name!r}: the vehicle has no such parameter"
    numbers = {
        BOOL: float(value["bool_value"]), INTEGER: float(value["integer_value"]), DOUBLE: value["double_value"],
    }  # fmt: skip
    number = numbers.get(value["type"])
    if number is None or not math.isfinite(number):
        return f"{name}: a parameter of a vehicle is one finite number"
    if type_of(param) == INTEGER and number != int(number):
        return f"{name}: {number:g} is not a whole number"
    return float(number)
