"""Numbers of PARAM_VALUE: integers in both encodings, and the shortest decimal of a float32."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from dialects.enums import Autopilot, Capability, ParamErrorCode
from link.services.param.float32 import float32_neighbours, same_float32, shortest_float32
from link.services.param.values import (
    NAME_SIZE,
    REAL32,
    from_wire,
    is_bytewise,
    name_from_wire,
    name_to_wire,
    to_wire,
    value_fault,
)
from tests.rows import each_row


@each_row("kind", [1, 2, 3, 4, 5, 6])
@each_row("bytewise", [True, False])
def test_whole_numbers_survive_both_ways_of_sending_them(kind: int, bytewise: bool) -> None:
    for value in (0, 1, 100, 127):
        assert from_wire(to_wire(value, kind, bytewise=bytewise), kind, bytewise=bytewise) == value
    if kind in (2, 4, 6):
        assert from_wire(to_wire(-5, kind, bytewise=bytewise), kind, bytewise=bytewise) == -5


@given(st.floats(width=32, allow_nan=False))
def test_the_shortest_number_is_the_same_float32(value: float) -> None:
    assert through_float32(shortest_float32(value)) == value


@pytest.mark.parametrize("typed", [1.17549435e-38, 0.123456791, 16777217.9, -0.0])
def test_a_typed_number_is_the_same_as_its_echo(typed: float) -> None:
    assert same_float32(typed, through_float32(typed))
    assert same_float32(typed, shortest_float32(through_float32(typed)))
    assert not same_float32(typed, typed * 1.001 + 1e-39)


def through_float32(value: float) -> float:
    return m.ParamValue.unpacker.unpack(m.ParamValue.unpacker.pack(value, 1, 0, b"A", REAL32))[0]  # type: ignore[no-any-return]


@given(st.binary(min_size=1, max_size=NAME_SIZE).filter(lambda raw: b"\0" not in raw))
def test_any_name_survives_the_way_to_the_screen_and_back(raw: bytes) -> None:
    name = name_from_wire(raw)
    assert name.isprintable()
    assert " " not in name
    assert name_to_wire(name) == raw


@pytest.mark.parametrize("name", ["", "SEVENTEEN_LETTERS", "GRÖSSE", "\\x00"])
def test_names_that_no_vehicle_has(name: str) -> None:
    assert name_to_wire(name) is None


@pytest.mark.parametrize(
    ("autopilot", "capabilities", "bytewise"),
    [
        (Autopilot.ARDUPILOT, 61935, False),  # as ArduRover 4.7 reports
        (Autopilot.PX4, Capability.PARAM_BYTEWISE | Capability.FTP, True),
        (Autopilot.PX4, 0, True),
        (Autopilot.GENERIC, 0xE004, True),  # MAVSDK's server: bytes, but it does not say so
        (Autopilot.GENERIC, Capability.PARAM_C_CAST, False),
        (Autopilot.ARDUPILOT, Capability.PARAM_BYTEWISE, True),
    ],
)
def test_the_encoding_of_integers(autopilot: int, capabilities: int, bytewise: bool) -> None:
    assert is_bytewise(autopilot, capabilities) is bytewise


@pytest.mark.parametrize(
    ("value", "kind", "fault"),
    [
        (1.7, 2, ParamErrorCode.TYPE_MISMATCH),
        (128, 2, ParamErrorCode.VALUE_OUT_OF_RANGE),
        (-1, 1, ParamErrorCode.VALUE_OUT_OF_RANGE),
        (float("nan"), 6, ParamErrorCode.VALUE_OUT_OF_RANGE),
        (1e39, REAL32, ParamErrorCode.VALUE_OUT_OF_RANGE),
        (127, 2, None),
        (1.7, REAL32, None),
    ],
)
def test_values_that_a_type_cannot_hold(value: float, kind: int, fault: ParamErrorCode | None) -> None:
    assert value_fault(value, kind, bytewise=False) is fault
    assert value_fault(value, kind, bytewise=True) is fault


@pytest.mark.parametrize(
    ("value", "below", "above"),
    [
        (1073741825, 1073741824, 1073741952),
        (-16777217, -16777218, -16777216),
        (33554433, 33554432, 33554436),
        (7, 7, 7),
    ],
)
def test_a_set_cast_to_float32_carries_its_neighbours(value: float, below: float, above: float) -> None:
    assert float32_neighbours(value) == (below, above)
    cast = None if below == above else ParamErrorCode.VALUE_OUT_OF_RANGE
    assert value_fault(value, 6, bytewise=False) is cast
    assert value_fault(value, 8, bytewise=True) is cast  # INT64 does not fit into the four bytes
    assert value_fault(value, 6, bytewise=True) is None
    assert all(value_fault(each, 6, bytewise=False) is None for each in (below, above))


def test_whole_numbers_of_four_bytes_keep_all_digits() -> None:
    assert shortest_float32(287454016.0) == 287454016
    assert shortest_float32(-2147483648.0) == -2147483648
    assert shortest_float32(2.0**32 - 256) == 4294967040
    assert shortest_float32(through_float32(1e20)) == 1e20
    assert shortest_float32(through_float32(0.45)) == 0.45
