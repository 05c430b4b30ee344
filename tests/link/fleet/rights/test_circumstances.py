"""When a watcher may send a frame that stops one autopilot and starts another, or that ends a transfer."""

from __future__ import annotations

import math

import pytest

from dialects import messages as m
from dialects import rover
from link.fleet.keys import read_frame
from link.fleet.rights.circumstances import Circumstances
from link.protocol.frame import Frame
from tests.link.fleet.test_roles import command, files, read
from tests.link.frames import frame
from tests.rows import each_row

ARDUPILOT, PX4, GENERIC, INVALID = 3, 12, 0, 8
ROVER, BOAT, COPTER, CAMERA = 10, 11, 2, 30

HOLDS = [
    read(m.SetMode(0, 1, 4)),
    command(rover.MAV_CMD_DO_SET_MODE, 1, 4),
    command(rover.MAV_CMD_DO_SET_MODE, 1, 4, math.nan),
    read(m.CommandInt(1, 1, 0, rover.MAV_CMD_DO_SET_MODE, 0, 0, 1, 4, 0, 0, 0, 0, 0)),
]


def beat(autopilot: int, kind: int, system: int = 1, component: int = 1) -> Frame:
    found = read_frame(frame(m.Heartbeat(kind, autopilot, 1, 0, 4, 3), 0, system, component))
    assert found is not None
    return found


def allowed(known: Circumstances, sent: Frame, sender: str = "bob/1", now: float = 0.0) -> bool:
    return known.allows_watcher(sent, sender, now)


@each_row("hold", HOLDS)
@each_row(
    ("autopilot", "kind", "holds"),
    [
        *((ARDUPILOT, ROVER, True), (ARDUPILOT, BOAT, True), (GENERIC, ROVER, True)),
        *((PX4, ROVER, False), (ARDUPILOT, COPTER, False), (GENERIC, COPTER, False), (INVALID, ROVER, False)),
    ],
)
def test_hold_by_number_is_a_stop_of_ardurover_and_ours_only(
    hold: Frame, autopilot: int, kind: int, holds: bool
) -> None:
    known = Circumstances()
    assert not allowed(known, hold), "nobody was heard"
    known.note_heartbeat(beat(autopilot, kind))
    assert allowed(known, hold) is holds


def test_a_camera_beside_the_autopilot_changes_nothing() -> None:
    known = Circumstances()
    known.note_heartbeat(beat(ARDUPILOT, ROVER))
    known.note_heartbeat(beat(INVALID, CAMERA, component=100))
    assert allowed(known, HOLDS[1])


def test_a_hold_for_all_needs_that_all_hold_by_it() -> None:
    known = Circumstances()
    known.note_heartbeat(beat(ARDUPILOT, ROVER))
    to_all = read(m.SetMode(0, 1, 4))
    assert allowed(known, to_all)
    known.note_heartbeat(beat(PX4, ROVER, system=2))
    assert not allowed(known, to_all)
    assert allowed(known, HOLDS[1])
    known.note_heartbeat(beat(PX4, ROVER))  # another firmware with the same id
    assert not allowed(known, HOLDS[1])


def test_other_modes_and_other_messages_are_never_a_watchers() -> None:
    known = Circumstances()
    known.note_heartbeat(beat(ARDUPILOT, ROVER))
    for sent in (
        read(m.SetMode(1, 1, 10)),
        command(rover.MAV_CMD_DO_SET_MODE, 1, 4, 3),
        command(rover.MAV_CMD_COMPONENT_ARM_DISARM, 1),
        read(m.RequestDataStream(1, 1, 0, 4, 1)),
        files(4),
    ):
        assert not allowed(known, sent)


@pytest.mark.parametrize(
    ("goes_on", "end"),
    [
        (read(m.LogRequestData(1, 1, 1, 0, 90)), read(m.LogRequestEnd(1, 1))),
        (read(m.MissionRequestInt(1, 1, 3)), read(m.MissionAck(1, 1, 0))),
        (read(m.MissionCount(1, 1, 3)), read(m.MissionAck(1, 1, 15))),
        (files(15), files(2)),
        (files(7), files(2)),
    ],
)
def test_a_watcher_ends_its_own_transfer_and_no_other(goes_on: Frame, end: Frame) -> None:
    known = Circumstances()
    known.note_transfer(goes_on, "bob/1", 0.0)
    assert allowed(known, end, now=1.0)
    known.note_transfer(goes_on, "alice/1", 1.0)
    assert not allowed(known, end, now=10.9)
    assert allowed(known, end, now=11.1), "alice's has ended by itself"
    known.note_transfer(goes_on, "alice/1", 12.0)
    assert not allowed(known, end, now=12.0)
    known.forget_sender("alice/1")
    assert allowed(known, end, now=12.0)


def test_a_transfer_of_another_kind_does_not_matter() -> None:
    known = Circumstances()
    known.note_transfer(read(m.LogRequestData(1, 1, 1, 0, 90)), "alice/1", 0.0)
    known.note_transfer(files(3), "alice/1", 0.0)  # a listing has no session
    assert allowed(known, files(2))
    assert allowed(known, read(m.MissionAck(1, 1, 0)))


def test_a_flood_of_senders_or_autopilots_is_bounded() -> None:
    known = Circumstances()
    for number in range(1000):
        known.note_transfer(files(15), f"bob/{number}", float(number) / 1000)
        known.note_heartbeat(beat(ARDUPILOT, ROVER, number % 250 + 1, number // 250 + 1))
    assert max(len(senders) for senders in known._transfers.values()) == 64
    assert len(known._holds) == 512


def test_what_is_no_heartbeat_tells_of_no_autopilot() -> None:
    known = Circumstances()
    known.note_heartbeat(read(m.ParamRequestList(1, 1)))
    assert not allowed(known, HOLDS[0])


def test_a_known_autopilot_changes_where_no_other_fits() -> None:
    known = Circumstances()
    known.note_heartbeat(beat(ARDUPILOT, ROVER))
    for number in range(1, 600):
        known.note_heartbeat(beat(ARDUPILOT, ROVER, number % 200 + 2, number // 200 + 1))
    assert len(known._holds) == 512
    assert allowed(known, HOLDS[1])
    known.note_heartbeat(beat(PX4, ROVER))
    assert not allowed(known, HOLDS[1])


@each_row("opcode", range(20))
def test_a_file_is_open_after_these_operations(opcode: int) -> None:
    known = Circumstances()
    known.note_transfer(files(opcode), "alice/1", 0.0)
    assert allowed(known, files(2)) is (opcode not in {4, 5, 6, 7, 11, 15})


def test_a_transfer_counts_for_10_s_and_not_longer() -> None:
    known = Circumstances()
    known.note_transfer(files(15), "alice/1", 0.0)
    assert not allowed(known, files(2), now=10.0)
    assert allowed(known, files(2), now=10.1)


def test_of_too_many_senders_the_one_silent_for_longest_goes() -> None:
    known = Circumstances()
    for number in range(64):
        known.note_transfer(files(15), f"bob/{99 - number}", float(number))
    known.note_transfer(files(15), "bob/90", 100.0)  # not new
    (senders,) = known._transfers.values()
    assert len(senders) == 64
    known.note_transfer(files(15), "carol/1", 101.0)
    assert set(senders) == {f"bob/{number}" for number in range(36, 99)} | {"carol/1"}


def test_a_frame_of_no_transfer_is_not_remembered() -> None:
    known = Circumstances()
    known.note_transfer(read(m.ParamRequestList(1, 1)), "alice/1", 0.0)
    known.note_transfer(files(3), "alice/1", 0.0)
    assert known._transfers == {}
