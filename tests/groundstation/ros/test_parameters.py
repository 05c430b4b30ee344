"""Parameters of a vehicle as values of rcl_interfaces."""

from __future__ import annotations

import math
from typing import Any

import pytest

from groundstation.ros.parameters import BOOL, DOUBLE, INTEGER, NOT_SET, describe, matching, value_of, wanted_value
from groundstation.ros.services import SERVICES
from groundstation.ros.types import RosTypes
from groundstation.ros.vehicle import Values
from link.services.param.client import Param

REAL, INT32 = 9, 6
PARAMS = {"A": Param("A", 0.5, REAL, 0, default=0.25), "N": Param("N", 3.0, INT32, 1)}


def value(kind: int, *, flag: bool = False, whole: int = 0, real: float = 0.0) -> Values:
    return {"type": kind, "bool_value": flag, "integer_value": whole, "double_value": real}


def test_integers_are_integers_and_the_others_doubles() -> None:
    real, whole, unknown = value_of(PARAMS["A"]), value_of(PARAMS["N"]), value_of(None)
    assert (real["type"], real["double_value"]) == (DOUBLE, 0.5)
    assert (whole["type"], whole["integer_value"]) == (INTEGER, 3)
    assert unknown["type"] == NOT_SET


def test_values_and_descriptors_are_messages_of_ros() -> None:
    types = RosTypes()
    for name in ("GetParameters", "DescribeParameters"):
        types.register_service(f"rcl_interfaces/srv/{name}", *SERVICES[f"rcl_interfaces/srv/{name}"])
    kind = "rcl_interfaces/srv/GetParameters_Response"
    data = types.encode(kind, {"values": [value_of(PARAMS["A"]), value_of(None)]})
    assert [each.double_value for each in types.decode(kind, data).values] == [0.5, 0.0]
    kind = "rcl_interfaces/srv/DescribeParameters_Response"
    data = types.encode(kind, {"descriptors": [describe("A", PARAMS["A"]), describe("X", None)]})
    first, second = types.decode(kind, data).descriptors
    assert (first.name, first.type, first.description) == ("A", DOUBLE, "default 0.25")
    assert (second.name, second.type) == ("X", NOT_SET)


def test_a_number_of_any_type_sets_a_parameter() -> None:
    assert wanted_value(value(DOUBLE, real=1.5), "A", PARAMS) == 1.5
    assert wanted_value(value(INTEGER, whole=2), "A", PARAMS) == 2.0
    assert wanted_value(value(BOOL, flag=True), "N", PARAMS) == 1.0
    assert wanted_value(value(DOUBLE, real=4.0), "N", PARAMS) == 4.0


@pytest.mark.parametrize(
    ("wanted", "name", "why"),
    [
        (value(DOUBLE, real=1.0), "X", "no such parameter"),
        (value(DOUBLE, real=math.nan), "A", "one finite number"),
        (value(DOUBLE, real=math.inf), "N", "one finite number"),
        (value(DOUBLE, real=1.5), "N", "not a whole number"),
        (value(4), "A", "one finite number"),
    ],
)
def test_what_cannot_be_set_is_refused(wanted: Any, name: str, why: str) -> None:
    refused = wanted_value(wanted, name, PARAMS)
    assert isinstance(refused, str)
    assert why in refused


def test_prefixes_end_at_a_dot() -> None:
    assert matching(["B", "A", "A.x", "AB"], []) == ["A", "A.x", "AB", "B"]
    assert matching(["B", "A", "A.x", "AB"], ["A"]) == ["A", "A.x"]
