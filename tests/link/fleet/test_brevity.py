"""To a ground station that does not look at a vehicle goes all but telemetry, and of that each kind once a second."""

from __future__ import annotations

from dialects import messages as m
from dialects import rover
from link.fleet.brevity import MAX_KINDS, PERIOD, BriefTelemetry
from link.fleet.keys import read_frame
from link.protocol.frame import Frame
from tests.link.frames import frame, heartbeat


def read(data: bytes) -> Frame:
    found = read_frame(data)
    assert found is not None
    return found


ATTITUDE = read(frame(m.Attitude(1, *(0.0,) * 6), 0, 1, 1))
STATUS = read(frame(m.SysStatus(*(0,) * 13), 0, 1, 1))
ALL_THE_SAME = [
    read(heartbeat(0, 1, 1)),
    read(frame(m.CommandAck(rover.MAV_CMD_COMPONENT_ARM_DISARM, 0), 0, 1, 1)),
    read(frame(m.StatusText(4, b"stopped"), 0, 1, 1)),
    read(frame(m.ParamValue(b"A", 1.0, 9, 1, 0), 0, 1, 1)),
]


def test_each_kind_of_telemetry_once_a_second() -> None:
    brief = BriefTelemetry()
    brief.set("alice/1", is_brief=True)
    times = [number / 50 for number in range(500)]
    assert sum(brief.passes(ATTITUDE, "alice/1", now) for now in times) in (10, 11)
    assert brief.passes(STATUS, "alice/1", 0.0)
    assert not brief.passes(STATUS, "alice/1", PERIOD - 0.1)
    assert brief.passes((*STATUS[:2], 100, *STATUS[3:]), "alice/1", PERIOD - 0.1), "of another component"


def test_all_else_goes_to_everybody_and_telemetry_to_who_looks() -> None:
    brief = BriefTelemetry()
    brief.set("alice/1", is_brief=True)
    assert all(brief.passes(each, "alice/1", 0.0) for each in ALL_THE_SAME * 3)
    assert all(brief.passes(ATTITUDE, "bob/1", 0.0) for _ in range(3))
    brief.set("alice/1", is_brief=False)
    assert all(brief.passes(ATTITUDE, "alice/1", 0.0) for _ in range(3))
    brief.set("alice/1", is_brief=False)


def test_invented_kinds_fill_no_memory() -> None:
    brief = BriefTelemetry()
    brief.set("alice/1", is_brief=True)
    for number in range(2 * MAX_KINDS + 3):
        brief.passes((60000 + number, 1, 1, 0, b""), "alice/1", 0.0)
    assert len(brief._sent["alice/1"]) <= MAX_KINDS


def test_the_wishes_of_one_operator_fill_no_memory() -> None:
    brief = BriefTelemetry()
    for number in range(6000):
        brief.set(f"bob/{number}", is_brief=True)
    assert len(brief._sent) == 32
    brief.set("alice/1", is_brief=True)
    assert not all(brief.passes(ATTITUDE, "alice/1", 0.0) for _ in range(3)), "others are still served"


def test_without_a_session_only_wishes_of_the_present_stay() -> None:
    brief = BriefTelemetry()
    for address in ("bob/1", "bob/2", "alice/1"):
        brief.set(address, is_brief=True)
    brief.keep({"alice/1"})
    assert list(brief._sent) == ["alice/1"]
