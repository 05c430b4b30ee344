"""The file with all parameters: what the vehicle packs, what ArduPilot packs, and damage."""

from __future__ import annotations

import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.services.param.client import Param
from link.services.param.pack import pack
from link.services.param.unpack import unpack
from link.services.param.values import REAL32
from tests.link.param_rig import Line, Memory

NAMES = st.lists(st.text("ABCDEF_", min_size=1, max_size=16), min_size=1, max_size=40, unique=True)

ARDUPILOT = struct.pack("<HHH", 0x671C, 4, 4) + b"".join(
    [
        bytes([1, 0x70]) + b"FORMAT_V" + struct.pack("<b", -5),
        bytes([2 | 0x10, 0x30 | 7]) + b"ORCE" + struct.pack("<hh", 300, 100),
        b"\0\0\0",  # ArduPilot keeps a record within one read
        bytes([3, 0x40]) + b"INTER" + struct.pack("<i", 16777217),
        bytes([4 | 0x10, 0x00 | 5]) + b"F" + struct.pack("<ff", 0.1, 0.2),
    ]
)
"""As ArduRover 4.7 writes it: four types, defaults where they differ, padding."""


def test_ardupilots_file() -> None:
    assert unpack(ARDUPILOT) == [
        Param("FORMAT_V", -5.0, 2, None, -5.0),
        Param("FORMAT_ORCE", 300.0, 4, None, 100.0),
        Param("INTER", 16777217.0, 6, None, 16777217.0),
        Param("INTERF", 0.1, REAL32, None, 0.2),
    ]


@given(NAMES, st.booleans())
def test_what_our_vehicle_packs(names: list[str], defaults: bool) -> None:
    table = tuple(Line(name, 1.0) for name in names)
    data = pack(table, Memory(dict.fromkeys(names, 2.5)), {"withdefaults": str(int(defaults))})
    assert data is not None
    assert unpack(data) == [Param(name, 2.5, REAL32, None, 1.0 if defaults else None) for name in names]


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"", "too short"),
        (b"<html>", "begins with 0x683c"),
        (ARDUPILOT[:-1], "damaged behind parameter 3"),
        (ARDUPILOT[:-9], "damaged behind parameter 3"),
        (ARDUPILOT[:6] + b"\x07" + ARDUPILOT[7:], "damaged behind parameter 0"),
        (ARDUPILOT[: ARDUPILOT.index(b"\0\0\0\x03")], "has 2 of 4 parameters"),
        (struct.pack("<HHH", 0x671B, 1, 1) + bytes([4, 0x9F]) + b"A" * 10 + bytes(4), "damaged behind parameter 0"),
    ],
)
def test_damage_is_named(data: bytes, words: str) -> None:
    result = unpack(data)
    assert isinstance(result, str)
    assert words in result


@given(st.binary(max_size=300), st.sampled_from([0x671B, 0x671C]))
def test_no_bytes_raise(data: bytes, magic: int) -> None:
    unpack(data)
    unpack(struct.pack("<H", magic) + data)
