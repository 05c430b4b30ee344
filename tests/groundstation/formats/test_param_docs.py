"""Texts of parameters: files of ArduPilot, PX4 and vehicles, and damaged ones."""

from __future__ import annotations

import json
import lzma
import math

import pytest

from dialects.enums import Autopilot
from groundstation.formats.docs_files import parse_docs, read_docs
from groundstation.formats.errors import FileFormatError
from groundstation.formats.metadata_json import MAX_SIZE, load_json, parse_general, parse_parameters
from groundstation.views.params import ParamDoc
from link.services.metadata import build_metadata
from vehicle.params import TABLE

XML = b"""<?xml version="1.0" encoding="utf-8"?>
<!-- generated -->
<paramfile><vehicles><parameters name="Rover">
<param humanName="Failsafe Action" name="Rover:FS_ACTION" documentation="What to do on a
 failsafe event" user="Standard"><values><value code="0">Nothing</value><value code="2">Hold</value></values></param>
<param humanName="RC override timeout" name="RC_OVERRIDE_TIME" documentation="Timeout after which RC overrides stop">
<field name="Range">0.0 120.0</field><field name="Units">s</field><field name="UnitText">seconds</field>
<field name="Increment">0.1</field></param>
</parameters></vehicles><libraries><parameters name="LOG_"><param humanName="Log &amp; bits" name="LOG_BITMASK"
 documentation=""><field name="RebootRequired">True</field><bitmask><bit code="0">Fast Attitude</bit>
<bit code="3">System Performance</bit></bitmask>
<field name="Bitmask">0:Fast Attitude,3:System Performance</field></param>
</parameters></libraries></paramfile>"""

PDEF = {
    "": {
        "FS_ACTION": {
            "DisplayName": "Failsafe Action", "Description": "What to do on a failsafe event",
            "Values": {"0": "Nothing", "2": "Hold"}, "User": "Standard",
        },
        "RC_OVERRIDE_TIME": {
            "DisplayName": "RC override timeout", "Description": "Timeout after which RC overrides stop",
            "Range": {"low": "0.0", "high": "120.0"}, "Units": "s", "Increment": "0.1",
        },
    },
    "LOG_": {
        "LOG_BITMASK": {
            "DisplayName": "Log & bits", "Bitmask": {"0": "Fast Attitude", "3": "System Performance"},
            "RebootRequired": "True",
        }
    },
    "json": {"version": 0},
}  # fmt: skip

PX4 = {
    "version": 1,
    "parameters": [
        {
            "name": "NAV_RCL_ACT", "shortDesc": "RC loss failsafe", "longDesc": "The action that is taken.",
            "type": "Int32", "default": 2, "min": 1, "max": 6, "rebootRequired": True,
            "values": [{"value": 1, "description": "Hold"}, {"value": 2, "description": "Return"}],
        },
        {"name": "COM_RCL_EXCEPT", "bitmask": [{"index": 0, "description": "Mission"}], "type": "Int32"},
        {"shortDesc": "without a name"},
        "not an object",
    ],
}  # fmt: skip


@pytest.mark.parametrize("data", [XML, json.dumps(PDEF).encode()], ids=["xml", "json"])
def test_both_files_of_ardupilot_say_the_same(data: bytes) -> None:
    docs = parse_docs(data, "apm.pdef")
    assert docs.get("FS_ACTION") == ParamDoc(
        "FS_ACTION", "Failsafe Action", "What to do on a failsafe event", values=((0.0, "Nothing"), (2.0, "Hold"))
    )
    assert docs.get("RC_OVERRIDE_TIME") == ParamDoc(
        "RC_OVERRIDE_TIME", "RC override timeout", "Timeout after which RC overrides stop", "s", 0.0, 120.0, 0.1
    )
    assert docs.get("LOG_BITMASK") == ParamDoc(
        "LOG_BITMASK", "Log & bits", bits=((0, "Fast Attitude"), (3, "System Performance")), reboot=True
    )
    assert docs.get("LOG_BITMASK").meaning(9.0) == "Fast Attitude, System Performance"
    assert docs.get("FS_ACTION").meaning(1.0) == ""
    assert docs.get("LOG_BITMASK").meaning(math.nan) == docs.get("LOG_BITMASK").meaning(math.inf) == ""
    assert docs.get("NO_SUCH") == ParamDoc("NO_SUCH")


@pytest.mark.parametrize("packed", [False, True])
def test_the_file_of_px4(*, packed: bool) -> None:
    plain = json.dumps(PX4).encode()
    docs = parse_docs(lzma.compress(plain) if packed else plain, "parameters.json")
    assert sorted(docs.docs) == ["COM_RCL_EXCEPT", "NAV_RCL_ACT"]
    assert docs.get("NAV_RCL_ACT") == ParamDoc(
        "NAV_RCL_ACT", "RC loss failsafe", "The action that is taken.", low=1.0, high=6.0, default=2.0,
        values=((1.0, "Hold"), (2.0, "Return")), reboot=True,
    )  # fmt: skip
    assert docs.get("COM_RCL_EXCEPT").bits == ((0, "Mission"),)


def test_the_texts_of_our_vehicle() -> None:
    made = build_metadata(TABLE, vendor="mavhelm", model="rover", version="1.0.0")
    assert parse_general(made.general, "general") == "mftp:///parameter.json.xz"
    docs = parse_parameters(made.parameters, "the vehicle")
    timeout = docs.get("FS_TIMEOUT")
    assert (timeout.title, timeout.text) == ("From loss of manual control to HOLD", "Not while armed.")
    assert (timeout.unit, timeout.low, timeout.high, timeout.default, timeout.not_armed) == ("s", 0.5, 10.0, 1.5, True)
    assert docs.get("FS_GCS_ENABLE").meaning(2.0) == "HOLD except in AUTO"
    assert docs.get("FENCE_TYPE").meaning(6.0) == "circle around home, uploaded areas"
    assert docs.get("MAV_GCS_SYSID").values == (), "0: any is one value of many"


BOMB = b'<!DOCTYPE a [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;">]><paramfile>&b;</paramfile>'


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (BOMB, "x:1: a DOCTYPE with entities is not accepted"),
        (XML[:400], "x:6: damaged XML: "),
        (b"<paramfile/>", "x: no parameters in it"),
        (b"{", "x:1: this is not JSON: "),
        (b"\xff\xfe\x00", "x: this is not JSON: UnicodeDecodeError"),
        (b"[" * 200_000, "x: this is not JSON: RecursionError"),
        (b"[]", 'x: there is no list "parameters" in it'),
        (b'{"parameters": 1}', 'x: there is no list "parameters" in it'),
        (b'{"a": 1}', "x: no parameters in it"),
        (lzma.compress(b"{}")[:-9], "x: damaged xz file: its end is missing"),
        (lzma.compress(b" " * (MAX_SIZE + 2), preset=0), f"x: damaged xz file: more than {MAX_SIZE} bytes"),
        (b"\xfd7zXZ\0rubbish....", "x: damaged xz file: "),
    ],
    ids=["bomb", "cut", "empty", "brace", "bytes", "deep", "list", "number", "other", "cut xz", "large xz", "bad xz"],
)
def test_a_damaged_file_is_one_clear_line(data: bytes, words: str) -> None:
    found = read_docs(data, "x", Autopilot.PX4)
    assert found.docs.docs == {}
    assert found.problem.startswith(words)
    assert "\n" not in found.problem
    with pytest.raises(FileFormatError):
        parse_docs(data, "x")


def test_odd_entries_are_left_out_and_the_others_stand() -> None:
    data = {
        "parameters": [
            {"name": "A", "min": "low", "max": float("nan"), "values": [{"value": "x"}, 3], "units": 5},
            {"name": "B", "bitmask": [{"index": 99}, {"index": 2, "description": "two"}], "values": {}},
        ]
    }
    docs = parse_parameters(json.dumps(data).encode(), "x")
    assert docs.get("A") == ParamDoc("A")
    assert docs.get("B") == ParamDoc("B", bits=((2, "two"),))


def test_words_of_texts_can_be_found() -> None:
    docs = parse_docs(XML, "x")
    assert docs.search_text("FS_ACTION") == " FAILSAFE ACTION WHAT TO DO ON A FAILSAFE EVENT"


def test_metadata_that_is_packed_as_px4_packs_it_is_read() -> None:
    assert load_json(lzma.compress(b'{"parameters": []}', preset=9 | lzma.PRESET_EXTREME), "x") == {"parameters": []}
