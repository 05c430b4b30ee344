"""Parameter files: what MAVProxy, QGroundControl and Mission Planner write is read, and written back alike."""

from __future__ import annotations

import contextlib
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink import mavparm

from groundstation.formats.errors import FileFormatError
from groundstation.formats.param_file import MAX_LINES, format_params, parse_params
from groundstation.formats.param_form import ParamForm
from link.services.param.client import Param
from link.services.param.float32 import same_float32, shortest_float32
from link.services.param.values import NAME_SIZE, REAL32

MAVPROXY = """\
ACRO_TURN_RATE   180.000000
AHRS_TRIM_X      -0.012500
ATC_STR_RAT_FF   0.200000
FS_ACTION        2.000000
SIXTEEN_LETTERS_ 1.500000
"""
QGC = """\
# Onboard parameters for Vehicle 1
#
# Vehicle-Id Component-Id Name Value Type
1\t1\tACRO_EXPO\t0.300000011920928955\t9
1\t1\tBATT_CAPACITY\t3300\t6
1\t1\tMOT_1_DIRECTION\t-1\t2
1\t1\tRTL_SPEED\t0.000000000000000000\t9
"""
MISSION_PLANNER = "ACRO_EXPO,0.3\nBATT_CAPACITY,3300\nCOMPASS_OFS_X,-12.25\nSTAT_RUNTIME,123456.8\n"

FLOATS = st.floats(width=32, allow_nan=False, allow_infinity=False)
PARAMS = st.dictionaries(
    st.text("ABCXYZ0189_", min_size=1, max_size=NAME_SIZE),
    st.tuples(FLOATS, st.just(REAL32)) | st.tuples(st.integers(-128, 127).map(float), st.just(2)),
    min_size=1,
)


def as_params(text: str) -> list[Param]:
    return [Param(line.name, line.value, line.kind or REAL32, None) for line in parse_params(text, "x").lines]


@pytest.mark.parametrize(
    ("text", "form"),
    [
        (MAVPROXY, ParamForm.MAVPROXY),
        (QGC, ParamForm.QGROUNDCONTROL),
        (MISSION_PLANNER, ParamForm.MISSION_PLANNER),
    ],
)
def test_what_the_others_write_is_written_back_byte_for_byte(text: str, form: ParamForm) -> None:
    assert parse_params(text, "x").form is form
    assert format_params(as_params(text), form) == text


@given(PARAMS, st.sampled_from(ParamForm))
def test_every_value_survives_every_form(values: dict[str, tuple[float, int]], form: ParamForm) -> None:
    params = [Param(name, shortest_float32(value), kind, None) for name, (value, kind) in values.items()]
    lines = parse_params(format_params(params, form), "x").lines
    assert [line.name for line in lines] == sorted(values)
    assert all(same_float32(line.value, values[line.name][0]) for line in lines)


@given(values=PARAMS)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_mavproxy_and_we_write_the_same(values: dict[str, tuple[float, int]], tmp_path: Path) -> None:
    """Where six decimals are enough: MAVProxy loses the digits behind them."""
    ours = {
        name: shortest_float32(value)
        for name, (value, _) in values.items()
        if same_float32(float(f"{shortest_float32(value):f}"), value)
    }
    theirs = mavparm.MAVParmDict()  # type: ignore[no-untyped-call]
    theirs.update(ours)
    path = tmp_path / "theirs.parm"
    theirs.save(str(path))  # type: ignore[no-untyped-call]
    assert path.read_text() == format_params(
        [Param(name, value, REAL32, None) for name, value in ours.items()], ParamForm.MAVPROXY
    )


def test_comments_empty_lines_windows_line_ends_and_hexadecimal() -> None:
    text = "\ufeff#NOTE: 12/1/2025, made by hand\r\n\r\nFS_ACTION,2 # hold\r\nRC_OPTIONS\t0x20\r\n"
    assert [(line.name, line.value, line.line) for line in parse_params(text, "x").lines] == [
        ("FS_ACTION", 2.0, 3),
        ("RC_OPTIONS", 32.0, 4),
    ]


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("A 1\nB 2\nA 1\n", "f.param:3: A is given twice, first in line 1: remove one"),
        ("A 1\nB two\n", "f.param:2: the value of B, 'two', is not a number"),
        ("A nan\n", "f.param:1: the value of A, 'nan', cannot be set"),
        ("A,inf\n", "f.param:1: the value of A, 'inf', cannot be set"),
        ("A 1e39\n", "f.param:1: the value of A, '1e39', cannot be set"),
        ("A 0xzz\n", "f.param:1: the value of A, '0xzz', is not a number"),
        ("A\n", "f.param:1: 'A' is neither 'NAME value' nor a line of QGroundControl"),
        ("A 1 2\n", "f.param:1: 'A 1 2' is neither 'NAME value' nor a line of QGroundControl"),
        ("SEVENTEEN_LETTERS 1\n", "f.param:1: 'SEVENTEEN_LETTERS' is not a name of at most 16 ASCII characters"),
        ("GRÖSSE 1\n", "f.param:1: 'GRÖSSE' is not a name of at most 16 ASCII characters"),
        ("1\t1\tA\t1\tx\n", "f.param:1: the type, 'x', is not a number from 0 to 255"),
        ("1\t999\tA\t1\t9\n", "f.param:1: the component id, '999', is not a number from 0 to 255"),
        ("\x1b[2J 1 2\n", "f.param:1: '\\x1b[2J 1 2' is neither 'NAME value' nor a line of QGroundControl"),
        ("# only\n", "f.param: no parameters in it"),
        ("", "f.param: no parameters in it"),
        ("\n" * (MAX_LINES + 1), f"f.param:{MAX_LINES + 1}: more than {MAX_LINES} lines: this is not a parameter file"),
    ],
)
def test_an_error_is_one_line_with_the_place(text: str, error: str) -> None:
    with pytest.raises(FileFormatError) as caught:
        parse_params(text, "f.param")
    assert str(caught.value) == error


def test_parameters_of_two_components_do_not_collide() -> None:
    lines = parse_params("1\t1\tA\t1\t9\n1\t100\tA\t2\t9\n", "x").lines
    assert [(line.component, line.value) for line in lines] == [(1, 1.0), (100, 2.0)]


@given(st.text())
def test_no_text_raises_anything_else(text: str) -> None:
    with contextlib.suppress(FileFormatError):
        parse_params(text, "x")


@pytest.mark.parametrize("form", ParamForm)
@pytest.mark.parametrize(
    "name", ["OTHER 0 #", "a b", "#x", "a,b", "OTHER,0#", "-o", "[/x]", "=1+1", r"a\x0ab", "'", '"']
)
def test_no_name_of_a_vehicle_makes_a_line_for_another_parameter(name: str, form: ParamForm) -> None:
    text = format_params([Param(name, 1.0, REAL32, 0)], form)
    assert [(line.name, line.value) for line in parse_params(text, "rover.param").lines] == [(name, 1.0)]
