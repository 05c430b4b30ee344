"""GPX and KML: the points of pymavlink's mavtogpx, in the order of elements that the schemas ask for."""

from __future__ import annotations

import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from dialects import messages as m
from groundstation.export.map_files import GPX, KML
from tests.groundstation.export.logs import ARDUROVER, BEAT, POINTS, drive, gps, run, sent

PLACE = (-353_629_380, 1_491_650_850)


def parse(path: Path) -> ET.Element:
    return ET.parse(path).getroot()


def names(element: ET.Element) -> list[str]:
    return [each.tag.partition("}")[2] for each in element]


def gpx_of(tmp_path: Path, log: bytes) -> ET.Element:
    (tmp_path / "log.tlog").write_bytes(log)
    run(tmp_path / "log.tlog", ("gpx", tmp_path / "log.gpx"))
    return parse(tmp_path / "log.gpx")


def points(root: ET.Element) -> list[tuple[float, float]]:
    return [(float(each.attrib["lat"]), float(each.attrib["lon"])) for each in root.iter(f"{{{GPX}}}trkpt")]


def test_gpx_has_the_points_of_mavtogpx(tmp_path: Path) -> None:
    log = tmp_path / "log.tlog"
    log.write_bytes(ARDUROVER.read_bytes())
    run(log, ("gpx", tmp_path / "ours.gpx"))
    script = Path(sys.executable).with_name("mavtogpx.py")
    subprocess.run(
        [sys.executable, script, log, "--type", "GLOBAL_POSITION_INT"], capture_output=True, timeout=50, check=True
    )
    theirs = (tmp_path / "log.tlog.gpx").read_text()
    expected = [tuple(map(float, each)) for each in re.findall(r'<trkpt lat="(.*?)" lon="(.*?)">', theirs)]
    heights = [float(each) for each in re.findall(r"<ele>(.*?)</ele>", theirs)]
    ours = parse(tmp_path / "ours.gpx")
    assert points(ours)[1:] == expected  # before the first estimate there is one of the receiver
    assert len(expected) >= 30
    assert [float(each[0].text or "") for each in ours.iter(f"{{{GPX}}}trkpt")][1:] == heights


def test_gpx_elements_stand_in_the_order_of_the_schema(tmp_path: Path) -> None:
    root = gpx_of(tmp_path, drive())
    assert (root.tag, root.attrib["version"], bool(root.attrib["creator"])) == (f"{{{GPX}}}gpx", "1.1", True)
    assert names(root) == ["metadata", "wpt", "trk"]
    assert names(root[0]) == ["name", "time"]
    assert names(root[1]) == ["ele", "time", "name"]
    assert names(root[2]) == ["name", "trkseg"]
    assert {tuple(names(each)) for each in root.iter(f"{{{GPX}}}trkpt")} == {("ele", "time")}
    assert points(root) == [(latitude / 1e7, longitude / 1e7) for latitude, longitude in POINTS]


def test_a_warning_is_escaped_and_has_no_control_characters(tmp_path: Path) -> None:
    root = gpx_of(tmp_path, drive())
    name = root.findtext(f"{{{GPX}}}wpt/{{{GPX}}}name") or ""
    assert name.startswith("<Wheel> & ")
    assert name.isprintable()


def test_places_that_are_none_are_left_out_and_end_a_segment(tmp_path: Path) -> None:
    places = [PLACE, (0, 0), (2**31 - 1, 2**31 - 1), (-910_000_000, 5), (-353_629_000, 1_800_000_000)]
    log = BEAT + b"".join(sent(number, gps(*place)) for number, place in enumerate(places))
    root = gpx_of(tmp_path, log)
    assert points(root) == [(-35.362938, 149.165085), (-35.3629, -180.0)]
    assert len(list(root.iter(f"{{{GPX}}}trkseg"))) == 2


def test_a_pause_ends_a_segment(tmp_path: Path) -> None:
    log = BEAT + b"".join(sent(moment, gps(*PLACE)) for moment in (0, 1, 200, 201))
    assert [len(each) for each in gpx_of(tmp_path, log).iter(f"{{{GPX}}}trkseg")] == [2, 2]


def test_the_receiver_counts_until_there_is_an_estimate(tmp_path: Path) -> None:
    estimate = m.GlobalPositionInt(0, 10, 20, 0, 0, 0, 0, 0, 0)
    log = BEAT + sent(1, gps(*PLACE)) + sent(2, estimate) + sent(3, gps(*PLACE)) + sent(4, estimate)
    assert points(gpx_of(tmp_path, log)) == [(-35.362938, 149.165085), (1e-6, 2e-6), (1e-6, 2e-6)]


def test_each_vehicle_has_its_track(tmp_path: Path) -> None:
    log = BEAT + sent(1, gps(*PLACE)) + sent(2, gps(*PLACE), 7) + sent(3, gps(*PLACE), 7)
    tracks = list(gpx_of(tmp_path, log).iter(f"{{{GPX}}}trk"))
    assert [(each[0].text, len(points(each))) for each in tracks] == [("vehicle 1", 1), ("vehicle 7", 2)]


@pytest.fixture
def kml(tmp_path: Path) -> ET.Element:
    (tmp_path / "<log>.tlog").write_bytes(drive())
    run(tmp_path / "<log>.tlog", ("kml", tmp_path / "log.kml"))
    return parse(tmp_path / "log.kml")


def test_kml_elements_stand_in_the_order_of_the_schema(kml: ET.Element) -> None:
    document = kml[0]
    assert (kml.tag, document.tag) == (f"{{{KML}}}kml", f"{{{KML}}}Document")
    assert names(document) == ["name", "Style", "Placemark", "Placemark"]
    assert document[0].text == "<log>.tlog"
    line, warning = document[2:]
    assert names(line) == ["name", "TimeSpan", "styleUrl", "MultiGeometry"]
    assert names(line[3][0]) == ["tessellate", "coordinates"]
    assert names(warning) == ["name", "description", "TimeStamp", "Point"]


def test_kml_has_longitude_latitude_and_height(kml: ET.Element) -> None:
    text = kml[0][2][3][0][1].text or ""
    found = [tuple(map(float, each.split(","))) for each in text.split()]
    assert found == [(longitude / 1e7, latitude / 1e7, 584.0) for latitude, longitude in POINTS]


@pytest.mark.parametrize("late", [False, True], ids=["kind first", "kind last"])
def test_what_flies_has_its_line_at_its_altitude(tmp_path: Path, late: bool) -> None:
    beat = sent(0 if not late else 300, m.Heartbeat(2, 3, 0x81, 5, 4, 3))
    places = b"".join(sent(moment, gps(*PLACE)) for moment in (1, 2, 200, 201))
    (tmp_path / "log.tlog").write_bytes(places + beat if late else beat + places)
    run(tmp_path / "log.tlog", ("kml", tmp_path / "log.kml"))
    lines = list(parse(tmp_path / "log.kml").iter(f"{{{KML}}}LineString"))
    assert [names(line) for line in lines] == [["extrude", "altitudeMode", "coordinates"]] * 2
    assert [line[1].text for line in lines] == ["absolute"] * 2
    assert all((line[2].text or "").split()[0].endswith(",584.000") for line in lines)


def test_a_warning_in_chunks_is_one_remark(tmp_path: Path) -> None:
    raw = b"x" * 49 + "ü and the end".encode()
    chunks = [sent(15, m.StatusText(3, each, 9, number)) for number, each in enumerate((raw[:50], raw[50:]))]
    root = gpx_of(tmp_path, drive() + b"".join(chunks))
    named = [each.text for point in root.iter(f"{{{GPX}}}wpt") for each in point if each.tag == f"{{{GPX}}}name"]
    assert named[1:] == ["x" * 49 + "ü and the end"]
