"""A change of a plan is answered when the disk has it, and not made where the disk has it not."""

from __future__ import annotations

from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import MissionResult, MissionType
from link.services.ftp.files import NotReadyError
from link.services.ftp.protocol import FtpError
from link.services.mission.commit import WRITE_TIMEOUT
from link.services.mission.files import PlanFolder, encode_plan
from tests.link.mission_rig import FENCE_CIRCLE, MissionRig, plain, waypoint

MISSION, FENCE, RALLY, ALL = MissionType.MISSION, MissionType.FENCE, MissionType.RALLY, MissionType.ALL
OLD, NEW = [waypoint(1), waypoint(2)], [waypoint(3), waypoint(4), waypoint(5)]
FULL = "No space left on device"


class Disk(MissionRig):
    """A vehicle with OLD as its mission, and a disk that is done when it is told so."""

    def __init__(self) -> None:
        super().__init__()
        self.server.load(MISSION, OLD)
        self.disk = []

    def end(self, problem: str | None = None, now: float = 0.1) -> list[Any]:
        """What is said then."""
        assert self.disk is not None
        for writing in self.disk:
            writing.done, writing.problem = True, problem
        self.disk.clear()
        return self.tick(now)

    @property
    def old(self) -> bool:
        return plain(self.plan) == plain(tuple(OLD))


def result(answers: list[Any]) -> list[tuple[int, int]]:
    assert all(isinstance(each, m.MissionAck) for each in answers)
    return [(each.type, each.mission_type) for each in answers]


def test_the_last_answer_of_an_upload_waits() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    assert vehicle.old
    assert vehicle.tick(0.5) == []
    assert vehicle.give(NEW[2], 2, now=0.6) == []  # said again meanwhile
    (answer,) = vehicle.end(now=0.7)
    assert (answer.type, answer.opaque_id) == (MissionResult.ACCEPTED, vehicle.server.plan_id(MISSION))
    assert plain(vehicle.plan) == plain(tuple(NEW))
    assert vehicle.changes == [(MISSION, 3)]
    (again,) = vehicle.give(NEW[2], 2, now=0.8)  # it was lost
    assert (again.type, again.opaque_id) == (answer.type, answer.opaque_id)


def test_an_older_answer_is_not_the_answer_to_this() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    vehicle.end()
    vehicle.upload(NEW)
    assert vehicle.give(NEW[2], 2) == []


def test_a_disk_that_refuses_leaves_the_old_plan_and_its_id() -> None:
    vehicle = Disk()
    before = vehicle.server.plan_id(MISSION)
    vehicle.upload(NEW)
    (answer,) = vehicle.end(FULL)
    assert (answer.type, answer.opaque_id) == (MissionResult.ERROR, 0)
    assert vehicle.old
    assert vehicle.server.plan_id(MISSION) == before
    assert (vehicle.changes, vehicle.stayed) == ([], [(MISSION, 2, FULL)])
    (again,) = vehicle.give(NEW[2], 2, now=0.8)
    assert (again.type, again.opaque_id) == (answer.type, answer.opaque_id)


def test_a_disk_that_does_not_answer_is_given_up() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    assert vehicle.tick(WRITE_TIMEOUT - 0.1) == []
    assert result(vehicle.tick(WRITE_TIMEOUT)) == [(MissionResult.ERROR, MISSION)]
    assert vehicle.old
    assert vehicle.stayed == [(MISSION, 2, "the disk does not answer")]
    vehicle.upload(NEW)
    assert result(vehicle.end()) == [(MissionResult.ACCEPTED, MISSION)]


def test_a_plan_that_may_no_longer_change_when_written_stays() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    vehicle.verdict = MissionResult.DENIED
    assert result(vehicle.end()) == [(MissionResult.DENIED, MISSION)]
    assert vehicle.old
    assert vehicle.stayed == [(MISSION, 2, None)]


def test_what_may_not_be_changed_is_not_even_written() -> None:
    vehicle = Disk()
    vehicle.ask(m.MissionCount(1, 1, 1))
    vehicle.verdict = MissionResult.DENIED
    assert result(vehicle.give(waypoint(3), 0)) == [(MissionResult.DENIED, MISSION)]
    assert vehicle.disk == []


def test_a_part_waits_too() -> None:
    vehicle = Disk()
    vehicle.ask(m.MissionWritePartialList(1, 1, 1, 1))
    assert vehicle.give(waypoint(9), 1) == []
    assert vehicle.old
    assert result(vehicle.end()) == [(MissionResult.ACCEPTED, MISSION)]
    assert plain(vehicle.plan) == plain((OLD[0], waypoint(9)))


@pytest.mark.parametrize("word", [m.MissionClearAll(1, 1, MISSION), m.MissionCount(1, 1, 0, MISSION)])
@pytest.mark.parametrize(("problem", "verdict"), [(None, MissionResult.ACCEPTED), (FULL, MissionResult.ERROR)])
def test_clearing_waits_and_is_answered_once_however_often_asked(
    word: m.Message, problem: str | None, verdict: MissionResult
) -> None:
    vehicle = Disk()
    assert vehicle.ask(word) == []
    assert vehicle.ask(word, now=0.7) == []
    assert vehicle.old
    assert vehicle.disk is not None
    assert len(vehicle.disk) == 1
    assert result(vehicle.end(problem)) == [(verdict, MISSION)]
    assert vehicle.old is (verdict is not MissionResult.ACCEPTED)


def test_all_plans_are_cleared_together_or_none() -> None:
    vehicle = Disk()
    assert vehicle.ask(m.MissionClearAll(1, 1, ALL)) == []
    assert vehicle.disk is not None
    fence = next(each for each in vehicle.disk if each.kind is FENCE)
    fence.problem = FULL
    for writing in vehicle.disk:
        assert vehicle.tick(0.1) == []
        writing.done = True
    assert result(vehicle.tick(0.2)) == [(MissionResult.ERROR, ALL)]
    assert vehicle.old
    assert {kind for kind, *_ in vehicle.stayed} == {MISSION, FENCE, RALLY}


@pytest.mark.parametrize(
    "word", [m.MissionCount(1, 1, 1), m.MissionWritePartialList(1, 1, 0, 0), m.MissionClearAll(1, 1, MISSION)]
)
def test_who_begins_anew_hears_no_answer_to_the_former_request(word: m.Message) -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    assert vehicle.ask(word) == []
    assert vehicle.end() == []
    assert plain(vehicle.plan) == plain(tuple(NEW))
    vehicle.ask(word)  # said again, as clients do
    if not isinstance(word, m.MissionClearAll):
        vehicle.give(waypoint(7), 0)
    assert result(vehicle.end()) == [(MissionResult.ACCEPTED, MISSION)]


def test_a_second_sender_is_denied_until_then() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    for word in (m.MissionCount(1, 1, 1), m.MissionClearAll(1, 1, MISSION), m.MissionClearAll(1, 1, ALL)):
        (answer,) = vehicle.ask(word, system=254)
        assert answer.type == MissionResult.DENIED
    (asked,) = vehicle.ask(m.MissionCount(1, 1, 1, RALLY), system=254)  # another plan is not busy
    assert isinstance(asked, m.MissionRequestInt)
    vehicle.end()
    (asked,) = vehicle.ask(m.MissionCount(1, 1, 1), system=254)
    assert isinstance(asked, m.MissionRequestInt)


def test_plans_of_different_kinds_are_written_side_by_side() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    vehicle.ask(m.MissionCount(1, 1, 1, FENCE))
    vehicle.give(waypoint(command=FENCE_CIRCLE, params=(5.0, 0.0, 0.0, 0.0)), 0, kind=FENCE)
    assert vehicle.disk is not None
    vehicle.disk[1].done = True
    assert result(vehicle.tick(0.1)) == [(MissionResult.ACCEPTED, FENCE)]
    assert vehicle.old


@pytest.mark.parametrize(("problem", "answer"), [(None, None), (FULL, FtpError.FAIL)])
def test_a_file_waits_as_well(problem: str | None, answer: FtpError | None) -> None:
    vehicle = Disk()
    folder = PlanFolder(vehicle.server)
    for _ in range(2):
        with pytest.raises(NotReadyError):
            folder.store("mission.waypoints", encode_plan(NEW))
    assert vehicle.old
    vehicle.end(problem)
    assert folder.store("mission.waypoints", encode_plan(NEW)) is answer
    assert vehicle.old is (problem is not None)
    with pytest.raises(NotReadyError):
        folder.remove("mission.waypoints")
    vehicle.end(problem)
    assert folder.remove("mission.waypoints") is answer


def test_another_file_meanwhile_is_refused() -> None:
    vehicle = Disk()
    folder = PlanFolder(vehicle.server)
    with pytest.raises(NotReadyError):
        folder.store("mission.waypoints", encode_plan(NEW))
    assert folder.store("mission.waypoints", encode_plan(OLD)) is FtpError.FAIL
    vehicle.end()
    assert plain(vehicle.plan) == plain(tuple(NEW))
    assert folder.store("mission.waypoints", encode_plan(NEW)) is None  # who wrote first hears how that went


def test_a_written_file_that_may_not_be_in_force_is_refused() -> None:
    vehicle, driving = Disk(), False
    folder = PlanFolder(vehicle.server, lambda kind: "AUTO drives by it" if driving else None)
    with pytest.raises(NotReadyError):
        folder.store("mission.waypoints", encode_plan(NEW))
    driving = True
    vehicle.end()
    assert vehicle.old
    assert folder.store("mission.waypoints", encode_plan(NEW)) is FtpError.FAIL


def test_unreported_file_is_written_anew_once_the_plan_differs() -> None:
    vehicle = Disk()
    folder = PlanFolder(vehicle.server)
    with pytest.raises(NotReadyError):
        folder.store("mission.waypoints", encode_plan(NEW))
    vehicle.end()
    assert plain(vehicle.plan) == plain(tuple(NEW))
    vehicle.upload(OLD)
    vehicle.end()
    assert vehicle.old
    with pytest.raises(NotReadyError):
        folder.store("mission.waypoints", encode_plan(NEW))
    vehicle.end()
    assert folder.store("mission.waypoints", encode_plan(NEW)) is None
    assert plain(vehicle.plan) == plain(tuple(NEW))


def test_an_answer_that_comes_due_meanwhile_is_not_lost() -> None:
    vehicle = Disk()
    vehicle.upload(NEW)
    assert vehicle.disk is not None
    vehicle.disk[0].done = True
    with pytest.raises(NotReadyError):
        PlanFolder(vehicle.server).store("rally.waypoints", encode_plan([waypoint(command=5100)]))
    assert result(vehicle.tick(0.1)) == [(MissionResult.ACCEPTED, MISSION)]
