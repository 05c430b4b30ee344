"""All parameters as one file, as pymavlink's decoder reads it."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavftp

from link.services.param.float32 import shortest_float32
from link.services.param.pack import pack
from tests.link.param_rig import TABLE, Line, Memory


def unpack(data: bytes | None) -> Any:
    """What pymavlink's decoder makes of it."""
    assert data is not None
    decoded = mavftp.MAVFTP.ftp_param_decode(data)
    assert decoded is not None
    return decoded


def test_the_packed_file_reads_as_pymavlink_reads_it() -> None:
    values = Memory({line.name: line.default for line in TABLE})
    values["MAN_DEADBAND"] = 7.25
    plain = unpack(pack(TABLE, values))
    assert [(name.decode(), kind) for name, _, kind in plain.params] == [(line.name, 4) for line in TABLE]
    assert [shortest_float32(value) for _, value, _ in plain.params] == [0.45, 7.25, 0.1, 0, 7]
    with_defaults = unpack(pack(TABLE, values, {"withdefaults": "1"}))
    assert [shortest_float32(value) for _, value, _ in with_defaults.defaults] == [line.default for line in TABLE]
    assert [shortest_float32(value) for _, value, _ in with_defaults.params] == [0.45, 7.25, 0.1, 0, 7]


@pytest.mark.parametrize(
    ("query", "names"), [({"start": "3"}, ["INITIAL_MODE", "VERSION"]), ({"count": "1"}, ["MAN_TIMEOUT"])]
)
def test_a_part_of_the_packed_file(query: dict[str, str], names: list[str]) -> None:
    values = Memory({line.name: line.default for line in TABLE})
    decoded = unpack(pack(TABLE, values, query))
    assert [name.decode() for name, _, _ in decoded.params] == names


@pytest.mark.parametrize("query", [{"start": "-1"}, {"start": "99"}, {"withdefaults": "x"}, {"withdefaults": "2"}])
def test_a_bad_query_is_no_file(query: dict[str, str]) -> None:
    assert pack(TABLE, Memory({line.name: 0.0 for line in TABLE}), query) is None


NAMES = st.text("ABCDEF_", min_size=1, max_size=16)


@given(st.lists(NAMES, min_size=1, max_size=40, unique=True))
def test_any_names_survive_packing(names: list[str]) -> None:
    table = tuple(Line(name, 1.0) for name in names)
    decoded = unpack(pack(table, Memory(dict.fromkeys(names, 2.0)), {"withdefaults": "1"}))
    assert [name.decode() for name, _, _ in decoded.params] == names
