"""Plans in a log: after each move in it the station has the mission, fence and rally points of that moment."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from dialects import messages as m
from dialects.enums import MissionType
from groundstation.intents import replay as r
from groundstation.intents.watch import Watch
from groundstation.replay import log_index
from groundstation.replay.log_replay import LogReplay
from groundstation.replay.plans import MAX_OPEN
from groundstation.views.base import View, ViewRequest
from groundstation.views.plan import PlanPage, PlanPageRequest, PlanRequest, PlanView
from tests.groundstation.replay.logs import LogWriter, finish, open_desk

ACCEPTED, ERROR = 0, 1
GCS = 255
MISSION, FENCE, RALLY, ALL = MissionType.MISSION, MissionType.FENCE, MissionType.RALLY, MissionType.ALL


@pytest.fixture(autouse=True)
def small_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut logs into intervals of 1 kB: transfers reach over their borders."""
    monkeypatch.setattr(log_index, "INTERVAL", 1024)


class PlanLog(LogWriter):
    """Writes what a ground station and an ArduPilot rover send each other about plans."""

    def pause(self, until: float) -> None:
        """Write the HEARTBEATs of both up to a time."""
        while self.time < until:
            self.beat()
            self.station_beat()
            self.time += 0.25

    def upload(self, kind: MissionType, places: Sequence[int], *, ack: int = ACCEPTED, lost: int = -1) -> None:
        """Write an upload; `lost`: an item that is not in the log."""
        self.add(m.MissionCount(1, 1, len(places), kind), GCS, 190)
        for seq, place in enumerate(places):
            self.add(m.MissionRequestInt(GCS, 190, seq, kind))
            if seq != lost:
                self.add(item((1, 1), seq, place, kind), GCS, 190)
        self.add(m.MissionAck(GCS, 190, ack, kind))

    def upload_part(self, kind: MissionType, first: int, places: Sequence[int], *, ack: int = ACCEPTED) -> None:
        """Write an upload of some items, numbered from `first` on."""
        self.add(m.MissionWritePartialList(1, 1, first, first + len(places) - 1, kind), GCS, 190)
        for seq, place in enumerate(places, first):
            self.add(m.MissionRequestInt(GCS, 190, seq, kind))
            self.add(item((1, 1), seq, place, kind), GCS, 190)
        self.add(m.MissionAck(GCS, 190, ack, kind))

    def download(self, kind: MissionType, places: Sequence[int]) -> None:
        """Write a download, whose last MISSION_ACK was lost."""
        self.add(m.MissionRequestList(1, 1, kind), GCS, 190)
        self.add(m.MissionCount(GCS, 190, len(places), kind))
        for seq, place in enumerate(places):
            self.add(m.MissionRequestInt(1, 1, seq, kind), GCS, 190)
            self.add(item((GCS, 190), seq, place, kind))

    def clear(self, kind: MissionType) -> None:
        """Write that the ground station clears a plan."""
        self.add(m.MissionClearAll(1, 1, kind), GCS, 190)
        self.add(m.MissionAck(GCS, 190, ACCEPTED, kind))


def item(target: tuple[int, int], seq: int, place: int, kind: MissionType) -> m.MissionItemInt:
    """Return an item at `place` degrees north."""
    command = {MISSION: 16, FENCE: 5003, RALLY: 5100}[kind]
    return m.MissionItemInt(*target, seq, 3, command, 0, 1, 0, 0, 0, 0, place * 10_000_000, 80_000_000, 0, kind)


def plan_log() -> PlanLog:
    """Return uploads, downloads, a refusal and clears, ten seconds apart."""
    log = PlanLog()
    log.pause(10)
    log.upload(MISSION, [0, 11, 12])
    log.pause(20)
    log.download(FENCE, [21, 22, 23])
    log.upload(RALLY, [24])
    log.pause(30)
    log.upload(MISSION, [0, 31], ack=ERROR)
    log.pause(40)
    log.upload(MISSION, [0, 41, 42, 43])
    log.pause(50)
    log.clear(FENCE)
    log.pause(60)
    log.upload(MISSION, [0, 61, 62], lost=1)
    log.pause(70)
    log.clear(ALL)
    log.pause(80)
    return log


class MapScreen:
    """What the Map screen gets of a desk."""

    def __init__(self, desk: LogReplay) -> None:
        self._desk = desk
        self._now = 0.0
        self._views: list[View] = []

    @property
    def plans(self) -> list[list[float] | None]:
        """Degrees north of the items of the three plans; None: not known."""
        self._request(PlanRequest())
        (plan,) = [each for each in self._views if isinstance(each, PlanView)]
        return [self._page(kind, each.version) for kind, each in enumerate(plan.plans)]

    def _page(self, kind: int, version: int) -> list[float] | None:
        if not version:
            return None
        self._request(PlanPageRequest(1, kind, version, 0))
        (page,) = [each for each in self._views if isinstance(each, PlanPage)]
        assert (page.kind, page.version) == (kind, version)
        return [each.x / 1e7 for each in page.items]

    def _request(self, request: ViewRequest) -> None:
        self._views.clear()
        self._now += 10
        self._desk.handle(Watch(()))
        self._desk.handle(Watch((request,)))
        self._desk.send_views(self._take, self._now)

    def _take(self, view: View) -> bool:
        self._views.append(view)
        return True


MOMENTS = {
    5.0: [None, None, None],
    15.0: [[11, 12], None, None],
    25.0: [[11, 12], [21, 22, 23], [24]],
    35.0: [[11, 12], [21, 22, 23], [24]],
    45.0: [[41, 42, 43], [21, 22, 23], [24]],
    55.0: [[41, 42, 43], [], [24]],
    65.0: [None, [], [24]],
    75.0: [[], [], []],
}


def test_each_moment_has_its_plans_forwards_and_backwards() -> None:
    desk = open_desk(bytes(plan_log().data))
    screen = MapScreen(desk)
    for at in (*MOMENTS, *reversed(MOMENTS)):
        desk.handle(r.ReplayGoTo(f"0:{at}" if at < 60 else f"1:{at - 60}"))
        finish(desk)
        assert screen.plans == MOMENTS[at], at


def test_plans_come_while_the_log_plays() -> None:
    desk = open_desk(bytes(plan_log().data))
    desk.handle(r.ReplayPlay(playing=True))
    screen = MapScreen(desk)
    for tenth in range(800):
        desk.advance(100 + tenth / 10)
        if (at := tenth / 10) in MOMENTS:
            assert screen.plans == MOMENTS[at], at


def test_uploads_and_clears_are_events() -> None:
    desk = open_desk(bytes(plan_log().data))
    texts = [each.text for each in desk.index.findings.finder.events if each.kind == "PLAN"]
    assert texts == [
        "mission: 3 items",
        "rally points: 1 item",
        "mission: 4 items",
        "fence cleared",
        "mission replaced; its items are not in the log",
        "mission cleared",
        "fence cleared",
        "rally points cleared",
    ]


def test_items_in_any_order_of_two_stations_are_told_apart() -> None:
    log = PlanLog()
    log.pause(5)
    for station in (255, 254):
        log.add(m.MissionCount(station, 190, 3, MISSION))
    for seq in (2, 0, 1, 1):
        log.add(item((255, 190), seq, 10 + seq, MISSION))
        log.add(item((254, 190), min(seq, 1), 50, MISSION))
    log.pause(10)
    desk = open_desk(bytes(log.data), at="0:08")
    assert MapScreen(desk).plans[0] == [11, 12]


def test_a_part_that_is_uploaded_replaces_these_items() -> None:
    log = PlanLog()
    log.pause(5)
    log.upload_part(MISSION, 1, [99])  # of a plan that is not in the log
    log.pause(10)
    log.upload(MISSION, [0, 11, 12, 13])
    log.pause(20)
    log.upload_part(MISSION, 2, [22, 23])
    log.pause(30)
    log.upload_part(MISSION, 1, [31], ack=ERROR)
    log.upload_part(MISSION, 3, [33, 34])  # more than there are
    log.pause(40)
    screen = MapScreen(desk := open_desk(bytes(log.data)))
    for at, plan in {8: None, 15: [11, 12, 13], 25: [11, 22, 23], 35: None}.items():
        desk.handle(r.ReplayGoTo(f"0:{at}"))
        finish(desk)
        assert screen.plans[0] == plan, at


def test_invented_transfers_do_not_grow() -> None:
    log = PlanLog()
    log.pause(5)
    for number in range(2000):
        log.add(m.MissionCount(number % 250, 0, 60_000, number // 250), 2, 1)
        log.add(item((number % 250, 0), number, 1, MISSION), 2, 1)
    desk = open_desk(bytes(log.data))
    assert all(not each.items for each in desk.index.findings.plans._open.values())
    assert len(desk.index.findings.plans._open) <= MAX_OPEN
    assert MapScreen(desk).plans == [None, None, None]
