from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.rows import each_row
from vehicle.sensors.gpsd import GpsFix, GpsSky, parse

RECORDED = Path(__file__).with_name("gpsd_3_22.jsonl").read_bytes().splitlines()
"""From gpsd 3.22 of Debian 12, fed with NMEA: moving east with 2 knots."""


def tpv(**values: Any) -> bytes:
    return json.dumps({"class": "TPV", **values}).encode()


def test_a_recorded_stream_of_gpsd() -> None:
    reports = [parse(line) for line in RECORDED]
    assert reports[:4] == [None] * 4  # VERSION, DEVICES, WATCH, DEVICE
    fixes = [report for report in reports if isinstance(report, GpsFix)]
    skies = [report for report in reports if isinstance(report, GpsSky)]
    assert fixes[-1].fix_type == 3
    assert (fixes[-1].latitude, fixes[-1].longitude, fixes[-1].altitude) == (52.5163, 13.3777, 34.5)
    assert fixes[-1].velocity_east == pytest.approx(1.029)
    assert fixes[-1].velocity_north == pytest.approx(0.0, abs=1e-9)
    assert skies[-1] == GpsSky(satellites=4, hdop=0.9)


@each_row(
    ("line", "report"),
    [
        (tpv(mode=0), GpsFix(0)),
        (tpv(mode=1), GpsFix(1)),
        (tpv(mode=1, lat=1.0, lon=1.0), GpsFix(1)),
        (tpv(mode=2, lat=1.0, lon=2.0, alt=5.0), GpsFix(2, 1.0, 2.0)),
        (tpv(mode=3, lat=1.0, lon=2.0, alt=5.0), GpsFix(3, 1.0, 2.0, 5.0)),
        (tpv(mode=3, lat=1.0, lon=2.0, alt=5.0, altMSL=4.0), GpsFix(3, 1.0, 2.0, 4.0)),
        (tpv(mode=3, status=2, lat=1.0, lon=2.0), GpsFix(4, 1.0, 2.0)),
        (tpv(mode=3, status=3, lat=1.0, lon=2.0), GpsFix(6, 1.0, 2.0)),
        (tpv(mode=3, status=4, lat=1.0, lon=2.0), GpsFix(5, 1.0, 2.0)),
        (tpv(mode=3, lat=1.0, lon=2.0, speed=0.0), GpsFix(3, 1.0, 2.0, None, 0.0, 0.0)),
        (tpv(mode=3, lat=1.0, lon=2.0, speed=1.0), GpsFix(3, 1.0, 2.0)),
        (tpv(mode=3, lat=91.0, lon=2.0), GpsFix(1)),
        (tpv(mode=3, lat=math.nan, lon=2.0), GpsFix(1)),
        (tpv(mode=3, lat="52", lon=2.0), GpsFix(1)),
        (tpv(mode=3, lat=True, lon=2.0), GpsFix(1)),
        (tpv(mode="3", lat=1.0, lon=2.0), GpsFix(0)),
        (tpv(mode=3), GpsFix(1)),
        (b'{"class":"SKY","satellites":[{"used":true},{"used":false},7]}', GpsSky(1, None)),
        (b'{"class":"SKY","hdop":1.5}', GpsSky(None, 1.5)),
        (b'{"class":"SKY"}', None),
        (b"[1]", None),
        (b"null", None),
        (b"not json", None),
        (b"\xff\xfe", None),
        (b"[" * 100_000, None),
        (b"", None),
    ],
)
def test_reports(line: bytes, report: GpsFix | GpsSky | None) -> None:
    assert parse(line) == report


values = (
    st.none() | st.booleans() | st.integers() | st.floats() | st.sampled_from(["", "3", "x"]) | st.lists(st.integers())
)
names = st.sampled_from(
    ["class", "mode", "lat", "lon", "alt", "speed", "track", "status", "uSat", "hdop", "satellites"]
)


@given(st.dictionaries(names, values), st.sampled_from(["TPV", "SKY"]))
def test_no_report_raises_or_gives_a_position_that_is_none(report: dict[str, Any], kind: str) -> None:
    parsed = parse(json.dumps({**report, "class": kind}).encode())
    if isinstance(parsed, GpsFix) and parsed.fix_type >= 2:
        assert parsed.latitude is not None
        assert abs(parsed.latitude) <= 90
