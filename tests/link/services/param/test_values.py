"""Numbers of PARAM_VALUE: integers in both encodings, and the shortest decimal of a float32."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dialects import messages as m
from link.services.param.values import REAL32, from_wire, shortest_float32, to_wire


@pytest.mark.parametrize("kind", [1, 2, 3, 4, 5, 6])
@pytest.mark.parametrize("bytewise", [True, False])
def test_whole_numbers_survive_both_ways_of_sending_them(kind: int, bytewise: bool) -> None:
    for value in (0, 1, 100, 127):
        assert from_wire(to_wire(value, kind, bytewise=bytewise), kind, bytewise=bytewise) == value
    if kind in (2, 4, 6):
        assert from_wire(to_wire(-5, kind, bytewise=bytewise), kind, bytewise=bytewise) == -5


@given(st.floats(width=32, allow_nan=False))
def test_the_shortest_number_is_the_same_float32(value: float) -> None:
    assert through_float32(shortest_float32(value)) == value


def through_float32(value: float) -> float:
    return m.ParamValue.unpacker.unpack(m.ParamValue.unpacker.pack(value, 1, 0, b"A", REAL32))[0]  # type: ignore[no-any-return]
