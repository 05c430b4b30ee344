"""Plans as files: what is written is read again, other tools' files are read, and over FTP they are the plans."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink import mavwp

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.ftp.protocol import FtpError
from link.services.mission.files import FILE_TYPES, PlanFileError, PlanFolder, decode_plan, encode_plan
from link.services.mission.items import MissionItem, from_message, to_message
from tests.link.mission_rig import MissionRig, plain, waypoint
from tests.link.services_world import through_the_wire

FLOATS = st.floats(width=32)
ITEMS = st.builds(
    MissionItem,
    command=st.integers(0, 65535),
    frame=st.sampled_from([0, 3, 6]),
    params=st.tuples(FLOATS, FLOATS, FLOATS, FLOATS),
    x=st.integers(-900_000_000, 900_000_000),
    y=st.integers(-1_800_000_000, 1_800_000_000),
    z=FLOATS,
    autocontinue=st.booleans(),
)


@given(st.lists(ITEMS, max_size=10))
def test_what_is_written_is_read_again(items: list[MissionItem]) -> None:
    assert plain(decode_plan(encode_plan(items))) == plain(tuple(items))


def test_pymavlink_reads_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MAVLINK20", raising=False)  # set by other tests, after mavutil has chosen its dialect
    file = tmp_path / "plan.waypoints"
    file.write_bytes(encode_plan([waypoint(0), waypoint(1, params=(5.0, 1.0, 0.0, 0.0))]))
    loader: Any = mavwp.MAVWPLoader()  # type: ignore[no-untyped-call]
    assert loader.load(str(file)) == 2
    item = loader.wp(1)
    assert (item.command, item.frame, item.param1, item.z) == (16, 3, 5.0, 0.5)
    assert item.x == pytest.approx(waypoint(1).latitude, abs=1e-7)


def test_a_file_of_another_tool_is_read() -> None:
    text = "QGC WPL 110\r\n0\t1\t0\t16\t0\t0\t0\t0\t-35.363262\t149.165237\t584.1\t1\r\n\r\n"
    [item] = decode_plan(text.encode())
    assert (item.x, item.y, item.command, item.frame) == (-353632620, 1491652370, 16, 0)
    assert item.z == pytest.approx(584.1)


def test_values_are_those_that_the_wire_can_carry() -> None:
    text = "QGC WPL 110\n0\t0\t2\t93\t0.1\tnan\t0\t0\t-2147483648\t0\t0\t1\n"
    [item] = decode_plan(text.encode())
    assert m.MissionItemInt(1, 1, 0, 2, 93, 0, 1, *item.params, item.x, item.y, item.z).param1 == item.params[0]
    again = from_message(through_the_wire(to_message(item, 0, 0, (1, 1))))  # type: ignore[arg-type]
    assert repr(again) == repr(item)
    assert item.x == -(2**31)


def test_comments_are_passed_over() -> None:
    assert plain(
        decode_plan(b"QGC WPL 110\n# made by hand\n" + encode_plan([waypoint()]).partition(b"\n")[2])
    ) == plain((waypoint(),))


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "line 1 is not 'QGC WPL 110'"),
        (b"{}", "line 1 is not 'QGC WPL 110'"),
        (b"QGC WPL 110\n0 1 2\n", "line 2 has 3 fields, not 12"),
        (b"QGC WPL 110\n0 1 x 16 0 0 0 0 0 0 0 1\n", "line 2: invalid literal"),
        (b"QGC WPL 110\n0 1 3 16 0 0 0 0 \xff 0 0 1\n", "line 2: could not convert"),
        (b"QGC WPL 110\n0 1 3 16 1e300 0 0 0 0 0 0 1\n", "line 2: 1e300 is too large"),
    ],
)
def test_what_is_no_plan_says_where(data: bytes, reason: str) -> None:
    with pytest.raises(PlanFileError, match=reason.split("'")[0]):
        decode_plan(data)


@given(st.binary())
def test_any_bytes_are_a_plan_or_an_error(data: bytes) -> None:
    for junk in (data, b"QGC WPL 110\n" + data):
        try:
            decode_plan(junk)
        except PlanFileError:
            continue


# ---- over FTP ----


def test_the_plans_are_files() -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(0), waypoint(1)])
    folder = PlanFolder(vehicle.server)
    assert [entry.name for entry in folder.entries()] == list(FILE_TYPES)
    content = folder.open("mission.waypoints", {})
    assert content is not None
    data = content.read(0, content.size)
    assert data is not None
    assert plain(decode_plan(data)) == plain((waypoint(0), waypoint(1)))
    assert folder.open("other.waypoints", {}) is None


def test_a_written_file_is_the_plan_in_force() -> None:
    vehicle = MissionRig()
    folder = PlanFolder(vehicle.server)
    assert folder.store("mission.waypoints", encode_plan([waypoint(3)])) is None
    assert plain(vehicle.plan) == plain((waypoint(3),))
    assert vehicle.changes == [(MissionType.MISSION, 1)]
    assert folder.remove("mission.waypoints") is None
    assert vehicle.plan == ()


@pytest.mark.parametrize(
    ("name", "data", "error"),
    [
        ("mission.waypoints", b"no plan", FtpError.FAIL),
        ("mission.waypoints", encode_plan([waypoint(command=22)]), FtpError.FAIL),
        ("mission.waypoints", encode_plan([waypoint(params=(math.inf, 0.0, 0.0, 0.0))]), FtpError.FAIL),
        ("fence.waypoints", encode_plan([waypoint()]), FtpError.FAIL),
        ("other.waypoints", encode_plan([waypoint()]), FtpError.PROTECTED),
    ],
)
def test_what_breaks_the_rules_changes_nothing(name: str, data: bytes, error: FtpError) -> None:
    vehicle = MissionRig()
    vehicle.upload([waypoint(9)])
    assert PlanFolder(vehicle.server).store(name, data) is error
    assert plain(vehicle.plan) == plain((waypoint(9),))
    assert len(vehicle.changes) == 1


def test_a_plan_that_may_not_be_changed_now_is_protected() -> None:
    vehicle = MissionRig()
    told: list[tuple[MissionType, str]] = []
    folder = PlanFolder(
        vehicle.server,
        lambda kind: "AUTO drives by it" if kind is MissionType.MISSION else None,
        lambda kind, why: told.append((kind, why)),
    )
    assert folder.store("mission.waypoints", encode_plan([waypoint()])) is FtpError.PROTECTED
    assert told == [(MissionType.MISSION, "AUTO drives by it")]
    assert folder.remove("mission.waypoints") is FtpError.PROTECTED
    assert vehicle.plan == ()


def test_a_file_does_not_cross_an_upload() -> None:
    vehicle = MissionRig()
    vehicle.ask(m.MissionCount(1, 1, 2))
    assert PlanFolder(vehicle.server).store("mission.waypoints", encode_plan([waypoint()])) is FtpError.FAIL


@pytest.mark.parametrize(
    ("data", "told", "unfit"),
    [
        (b"no plan", [(MissionType.MISSION, "line 1 is not 'QGC WPL 110'")], []),
        (encode_plan([waypoint(), waypoint(command=22)]), [], [(MissionType.MISSION, 1, MissionResult.UNSUPPORTED)]),
        (encode_plan([waypoint()] * 301), [], [(MissionType.MISSION, None, MissionResult.NO_SPACE)]),
    ],
)
def test_what_is_wrong_with_a_file_is_told(data: bytes, told: list[object], unfit: list[object]) -> None:
    """MAVLink FTP says no more than "failed", and MAVProxy does not even look."""
    vehicle, why = MissionRig(), []
    folder = PlanFolder(vehicle.server, refused=lambda kind, words: why.append((kind, words)))
    assert folder.store("mission.waypoints", data) is FtpError.FAIL
    assert why == told
    assert vehicle.unfits == unfit


def test_only_plans_have_a_place() -> None:
    folder = PlanFolder(MissionRig().server)
    assert all(map(folder.writable, FILE_TYPES))
    assert not folder.writable("other.waypoints")
