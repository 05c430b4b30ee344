"""A replay in virtual time: seek, play, backwards, steps, events, search, marks, and damage at every byte."""

from __future__ import annotations

import itertools
import time

import pytest

from dialects import codec
from groundstation.intents import replay as r
from groundstation.intents.driving import DriveKeyDown, Stop
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Arm, SetMode
from groundstation.intents.watch import Watch
from groundstation.replay import log_index
from groundstation.replay.log_replay import LogReplay
from groundstation.snapshot import VehicleView
from groundstation.station.station import Station
from groundstation.views.base import View
from groundstation.views.camera import CameraRequest, CameraView
from groundstation.views.charts import FieldId, SeriesPage, SeriesRequest
from groundstation.views.log import LogPage, LogRequest
from groundstation.views.replay import ReplayRequest, ReplayView
from tests.groundstation.replay.logs import NOON, LogWriter, build_station, drive_log, finish, open_desk


@pytest.fixture(autouse=True)
def small_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut logs into intervals of 4 kB, so that a minute of driving has several."""
    monkeypatch.setattr(log_index, "INTERVAL", 4096)


@pytest.fixture
def desk() -> LogReplay:
    """Return an open drive."""
    return open_desk(bytes(drive_log().data))


def vehicle(desk: LogReplay) -> VehicleView:
    """Return the vehicle of this moment."""
    found = desk.snapshot().vehicle
    assert found is not None
    return found


def press(desk: LogReplay, *intents: AnyIntent) -> None:
    """Send intents and finish what they start."""
    for intent in intents:
        desk.handle(intent)
        finish(desk)


def run(desk: LogReplay, seconds: float, start: float = 100.0) -> None:
    """Let real time pass in steps of 25 ms."""
    for step in range(round(seconds / 0.025) + 1):
        desk.advance(start + step * 0.025)


@pytest.mark.parametrize(
    ("at", "mode", "armed"), [(5, "MANUAL", False), (15, "MANUAL", True), (35, "AUTO", True), (55, "MANUAL", False)]
)
def test_a_seek_shows_the_state_of_that_moment(desk: LogReplay, at: float, mode: str, armed: bool) -> None:
    press(desk, r.ReplayMove(at + 0.05))
    shown = vehicle(desk)
    assert (shown.mode, shown.armed, shown.alive) == (mode, armed, True)
    assert shown.speed == pytest.approx(at, abs=0.11)
    status = desk.snapshot().replay
    assert status is not None
    assert status.wall == pytest.approx(NOON + at + 0.05)
    assert desk.snapshot().operator.throttle == (0.5 if 10 <= at < 50 else 0.0)


def test_playing_and_seeking_show_the_same(desk: LogReplay) -> None:
    press(desk, r.ReplayPlay(playing=True))
    run(desk, 33.0)
    played, status = vehicle(desk), desk.snapshot().replay
    assert status is not None
    assert status.position == pytest.approx(33.0)
    other = open_desk(bytes(drive_log().data), at="33")
    sought = vehicle(other)
    assert (
        (played.mode, played.armed, played.speed) == (sought.mode, sought.armed, sought.speed) == ("AUTO", True, 33.0)
    )


def test_playing_ends_at_the_end_and_begins_anew(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("55"), *[r.ReplaySpeed(1)] * 3, r.ReplayPlay(playing=True))
    run(desk, 3.0)
    assert not desk.player.playing
    assert desk.player.position == pytest.approx(59.9)
    press(desk, r.ReplayPlay(playing=True))
    assert (desk.player.playing, desk.player.position) == (True, 0.0)


def test_backwards_shows_earlier_moments(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("41"), r.ReplayReverse())
    run(desk, 5.0)
    assert desk.player.position == pytest.approx(36.0, abs=0.5)
    assert vehicle(desk).mode == "AUTO"
    run(desk, 60.0, start=200.0)
    assert (desk.player.position, desk.player.playing) == (0.0, False)


@pytest.mark.parametrize("speed", [0.25, 2.0, 32.0])
def test_the_speed_is_that_of_the_log(desk: LogReplay, speed: float) -> None:
    desk.player.speed = speed
    press(desk, r.ReplayPlay(playing=True))
    run(desk, 1.0)
    assert desk.player.position == pytest.approx(speed, rel=0.01)


def test_steps_go_message_by_message_both_ways(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("20"))
    offsets = [desk.player.offset]
    for _ in range(50):
        press(desk, r.ReplayStep(1))
        offsets.append(desk.player.offset)
    assert offsets == sorted(set(offsets))
    for offset in reversed(offsets[:-1]):
        press(desk, r.ReplayStep(-1))
        assert desk.player.offset == offset


def test_events_are_visited_in_order_and_back(desk: LogReplay) -> None:
    seen = []
    for _ in range(7):
        press(desk, r.ReplayNextEvent(1))
        seen.append(round(desk.player.position, 1))
    assert seen == [9.9, 10.0, 20.0, 30.0, 40.0, 50.0, 50.0]
    assert desk.note == "no further event"
    press(desk, r.ReplayNextEvent(-1), r.ReplayNextEvent(-1))
    assert vehicle(desk).mode == "AUTO"
    press(desk, r.ReplayShowEvent(0))
    assert desk.player.position == 0.0


@pytest.mark.parametrize(
    ("text", "at"),
    [
        ("fence", 20.0), ("MODE==AUTO", 30.0), ("mode=auto", 30.0), ("batt<12.3", 31.0), ("speed>=45", 45.0),
        ("armed==1", 10.0), ("VFR_HUD.groundspeed > 12", 12.1), ("COMMAND_ACK", 9.9), ("command_ack.result==0", 9.9),
        ("disarmed", 50.0),
    ],
)  # fmt: skip
def test_search_finds_texts_messages_and_conditions(desk: LogReplay, text: str, at: float) -> None:
    press(desk, r.ReplayMove(0.05), r.ReplaySearch(text))
    assert desk.player.position == pytest.approx(at, abs=0.01), desk.note
    assert desk.note == f"found: {text}"


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ("no such text", "not found: no such text"), ("batt<2", "not found: batt<2"), ("PING", "not found: PING"),
        ("foo.bar>1", "'foo.bar' is not known"), ("batt<x", "'x' is not a number"),
        ("batt<inf", "'inf' is not a number"), ("   ", "type a text"),
    ],
)  # fmt: skip
def test_a_search_in_vain_says_why_and_moves_nothing(desk: LogReplay, text: str, note: str) -> None:
    press(desk, r.ReplayGoTo("33"), r.ReplaySearch(text))
    assert desk.note.startswith(note)
    assert desk.player.position == pytest.approx(33.0)


def test_a_search_goes_on_from_the_start(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("45"), r.ReplaySearch("MODE==AUTO"))
    assert desk.player.position == pytest.approx(30.0)
    assert desk.note == "found from the start again: MODE==AUTO"


def test_times_as_people_write_them(desk: LogReplay) -> None:
    clock = time.strftime("%H:%M:%S", time.localtime(NOON + 42))
    for text, at in ((clock, 42.0), ("0:15", 15.0), ("+10", 25.0), (":-5.5", 19.5), ("7", 7.0), ("-100", 0.0)):
        press(desk, r.ReplayGoTo(text))
        assert desk.player.position == pytest.approx(at), text
    for text in ("", "abc", "1:2:3:4", "+", "1e3", "12:xx"):
        press(desk, r.ReplayGoTo("33"), r.ReplayGoTo(text))
        assert desk.player.position == pytest.approx(33.0), text


def test_a_time_waits_for_the_index() -> None:
    desk = LogReplay("x.tlog", open_desk(bytes(drive_log().data)).source, build_station, at="50")
    desk.work()
    assert desk.player.position < 5
    finish(desk)
    assert desk.player.position == pytest.approx(50.0)


def test_marks_and_the_loop(desk: LogReplay) -> None:
    press(desk, r.ReplayLoop())
    assert desk.note == "mark A and B first: m"
    press(desk, r.ReplayGoTo("20"), r.ReplayMark(), r.ReplayGoTo("22"), r.ReplayMark(), r.ReplayLoop())
    positions = []
    for step in range(200):
        desk.advance(100 + step * 0.025)
        positions.append(desk.player.position)
    assert min(positions) == pytest.approx(20.0)
    assert max(positions) <= 22.0
    assert sum(late < early for early, late in itertools.pairwise(positions)) == 2
    press(desk, r.ReplayMark())
    assert desk.player.marks == (desk.player.position, None)
    assert not desk.player.loop


def test_a_stop_key_pauses_and_nothing_else_has_an_effect(desk: LogReplay) -> None:
    press(
        desk, r.ReplayPlay(playing=True), DriveKeyDown("i", 1, 0), Arm(), SetMode(mode="AUTO"), Stop("another screen")
    )
    assert desk.player.playing
    status = desk.snapshot().replay
    assert status is not None
    assert status.refused == 2
    press(desk, Stop())
    assert not desk.player.playing


def test_nothing_that_a_station_would_send_is_kept() -> None:
    built: list[Station] = []

    def build(system: int, now: float) -> Station:
        built.append(build_station(system, now))
        return built[-1]

    desk = open_desk(bytes(drive_log().data), build=build)
    press(desk, r.ReplayPlay(playing=True))
    run(desk, 20.0)
    assert vehicle(desk).armed
    assert built[-1].messages_to_send() == []
    assert not built[-1].operator.live


# ---- views ----


def views_of(desk: LogReplay, now: float) -> list[View]:
    """Return the views that are sent."""
    sent: list[View] = []

    def send(view: View) -> bool:
        sent.append(view)
        return True

    desk.send_views(send, now)
    return sent


def test_view_has_the_timeline_and_the_events_near_the_position(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("35"), Watch((ReplayRequest(60, 3),)))
    (view,) = (each for each in views_of(desk, 1.0) if isinstance(each, ReplayView))
    assert [(span.text, round(span.start), round(span.end)) for span in view.timeline.modes] == [
        ("MANUAL", 0, 30), ("AUTO", 30, 40), ("MANUAL", 40, 60),
    ]  # fmt: skip
    assert [(round(span.start), round(span.end)) for span in view.timeline.armed] == [(10, 50)]
    assert view.timeline.speed[30] == pytest.approx(30.4, abs=0.6)
    assert view.timeline.demand[5] is None
    assert view.timeline.demand[20] == 0.5
    assert (view.current, view.total, view.top) == (5, 8, 4)
    assert [event.text for event in view.events] == ["fence close", "MANUAL → AUTO", "AUTO → MANUAL"]
    assert [sign.kind for sign in view.timeline.signs] == ["ARM", "TEXT", "ARM"]
    assert (view.damaged, view.lost, view.tail, view.stations, view.vehicles) == (0, 0, 0, (255,), (1,))


def test_views_are_sent_while_the_log_stands_still(desk: LogReplay) -> None:
    press(desk, r.ReplayGoTo("35"), Watch((LogRequest(0),)))
    (page,) = (each for each in views_of(desk, 1.0) if isinstance(each, LogPage))
    texts = [line.text for line in page.lines]
    assert "fence close" in texts
    assert page.lines[texts.index("fence close")].time == pytest.approx(NOON + 20, abs=0.2)
    press(desk, Watch((LogRequest(page.state), ReplayRequest())))
    assert views_of(desk, 1.2)


def test_charts_show_the_time_before_a_seek(desk: LogReplay) -> None:
    field = FieldId(1, 1, False, "VFR_HUD", "groundspeed")
    press(desk, Watch((SeriesRequest((field,)),)), r.ReplayGoTo("35"))
    (page,) = (each for each in views_of(desk, 1.0) if isinstance(each, SeriesPage))
    assert len(page.points[0].times) // 8 > 50
    assert page.wall == pytest.approx(NOON + 35)


# ---- damage ----


def test_cut_and_flipped_bytes_never_raise_and_losses_are_named() -> None:
    log = LogWriter()
    for tenth in range(8):
        log.time = tenth / 10
        log.beat() if tenth % 4 == 0 else log.say(f"t{tenth}", 4)
    data = bytes(log.data)
    borders = {each.at for each in open_desk(data).index.read_interval(0).frames}
    for at in range(len(data)):
        cut = open_desk(data[:at])
        assert cut.index.end + cut.index.tail == at
        assert cut.index.tail == 0 if at in borders or at == 0 else cut.index.tail > 0
        flipped = open_desk(data[:at] + bytes([data[at] ^ 0x41]) + data[at + 1 :])
        assert flipped.snapshot().replay is not None
        named = flipped.index.damaged + flipped.check.damaged + flipped.index.tail
        in_stamp = any(border <= at < border + 8 for border in borders)
        strange = flipped.index.frames == len(borders) and any(
            frame.message_id not in codec.CRC_EXTRA for frame in flipped.index.read_interval(0).frames
        )
        assert in_stamp or named or strange, at


def test_the_camera_gets_the_log_and_its_moment(desk: LogReplay) -> None:
    views: list[View] = []

    def take(view: View) -> bool:
        views.append(view)
        return True

    press(desk, r.ReplayGoTo("35"), Watch((CameraRequest(5600),)))
    desk.send_views(take, 1.0)
    press(desk, r.ReplayMove(2.5))
    desk.send_views(take, 2.0)
    found = [each for each in views if isinstance(each, CameraView)]
    assert [each.log for each in found] == [desk.path] * 2
    assert [each.at for each in found] == pytest.approx([NOON + 35, NOON + 37.5], abs=0.2)
    assert [each.port for each in found] == [0, 0], "no stream is asked for"
