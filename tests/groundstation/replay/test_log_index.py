"""The index of a log: times, events, what it keeps of each kind of message, damage, and files that grow."""

from __future__ import annotations

import random

import pytest

from dialects import codec
from dialects import messages as m
from dialects.messages import MESSAGES
from groundstation.replay import events, log_index
from groundstation.replay.log_check import LogCheck
from groundstation.replay.log_index import LogIndex
from link.tlog.tlog import encode_record
from tests.groundstation.replay.logs import AUTO, NOON, BytesSource, LogWriter, drive_log, indexed


@pytest.fixture
def small_intervals(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut logs into intervals of 2 kB."""
    monkeypatch.setattr(log_index, "INTERVAL", 2048)


def events_of(index: LogIndex) -> list[tuple[float, str, str]]:
    """Return time, kind and text of all events."""
    return [(round(each.time, 1), each.kind, each.text) for each in index.findings.finder.events]


def test_times_messages_and_events_of_a_drive() -> None:
    index = indexed(bytes(drive_log().data))
    assert index.complete
    assert index.duration == pytest.approx(59.9)
    assert index.clock.wall(10.0) == pytest.approx(NOON + 10)
    assert events_of(index) == [
        (0.0, "MODE", "MANUAL"),
        (9.9, "CMD", "arm"),
        (9.9, "ACK", "arm: accepted"),
        (10.0, "ARM", "armed"),
        (20.0, "TEXT", "fence close"),
        (30.0, "MODE", "MANUAL → AUTO"),
        (40.0, "MODE", "AUTO → MANUAL"),
        (50.0, "ARM", "disarmed"),
    ]
    assert index.findings.finder.stations == {(255, 190)}


@pytest.mark.usefixtures("small_intervals")
def test_intervals_cover_the_log_and_frames_have_their_times() -> None:
    data = bytes(drive_log().data)
    index = indexed(data)
    assert len(index.starts) > 10
    frames = [pair for number in range(len(index.starts)) for pair in index.timed_frames(number)]
    assert sum(8 + len(frame.raw) for _, frame in frames) == len(data)
    assert len(frames) == index.frames
    assert all(abs(time - (frame.stamp / 1e6 - NOON)) < 1e-3 for time, frame in frames)
    assert index.find_interval(-5) == 0
    assert index.times[index.find_interval(30.0)] <= 30.0


@pytest.mark.usefixtures("small_intervals")
def test_the_fast_scan_and_the_careful_one_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    data = bytes(drive_log().data)
    fast = indexed(data)
    monkeypatch.setattr(log_index, "scan_fast", lambda *_: None)
    careful = indexed(data)
    assert events_of(fast) == events_of(careful)
    assert fast.places == careful.places
    assert (fast.starts, fast.frames, fast.end) == (careful.starts, careful.frames, careful.end)
    assert fast.findings.speed.columns(20, 60) == careful.findings.speed.columns(20, 60)
    assert set(careful.careful) == {1}
    assert set(fast.careful) == {0}


@pytest.mark.usefixtures("small_intervals")
def test_a_file_that_grows_is_followed() -> None:
    data = bytes(drive_log().data)
    source = BytesSource(data[:5000])
    index = LogIndex(source)
    while index.advance():
        pass
    assert 0 < index.tail < 100
    source.data = data
    assert not index.complete
    while index.advance():
        pass
    assert (index.tail, index.damaged) == (0, 0)
    assert index.frames == indexed(data).frames


def test_a_file_that_becomes_shorter_ends_the_index() -> None:
    source = BytesSource(bytes(drive_log().data))
    index = LogIndex(source)
    source.data = source.data[:0]
    assert not index.advance()


def test_garbage_is_damage_with_its_place() -> None:
    first, noise = drive_log(20), random.Random(3).randbytes(400_000)
    rest = drive_log(5)
    index = indexed(bytes(first.data) + noise + bytes(rest.data))
    assert index.damaged == 400_000
    assert index.frames == indexed(bytes(first.data)).frames + indexed(bytes(rest.data)).frames
    assert any(kind == "DAMAG" for _, kind, _ in events_of(index))


def test_the_check_finds_wrong_checksums_and_lost_packets() -> None:
    log = drive_log(20)
    at = log.say("flip me")
    end = len(log.data)
    log.sequences[1, 1] += 7
    log.beat()
    data = bytearray(log.data)
    data[at + 25] ^= 0x20
    index = indexed(bytes(data))
    check = LogCheck(index)
    while check.advance():
        pass
    assert check.complete
    assert check.lost == 7 + 1  # the damaged one is missing, too
    assert index.damaged + check.damaged == end - at


def test_a_clock_that_jumps_stops_no_time() -> None:
    log = LogWriter(clock=5.0)
    for second in range(10):
        log.time = second
        log.beat()
        log.say(f"text {second}")
    log.clock = NOON
    for second in range(10, 20):
        log.time = second
        log.beat(AUTO)
        log.say(f"text {second}")
    index = indexed(bytes(log.data))
    assert 18.0 <= index.duration <= 19.0
    assert ("CLOCK", "the recorded clock jumps here") in {each[1:] for each in events_of(index)}
    assert index.clock.wall(2.0) == pytest.approx(7.0)
    assert index.clock.wall(index.duration) == pytest.approx(NOON + 19)


def test_a_stamp_that_damage_hit_moves_no_time() -> None:
    log = drive_log(20)
    at = log.say("here")
    log.beat()
    data = bytearray(log.data)
    data[at + 3] ^= 0x04  # 1000 s and more
    index = indexed(bytes(data))
    assert index.duration == pytest.approx(19.9)
    assert index.clock.jumps == 0


def test_a_link_loss_is_an_event() -> None:
    log = drive_log(5)
    log.time = 25.0
    log.beat()
    assert (25.0, "LINK", "no heartbeat for 21.0 s before") in events_of(indexed(bytes(log.data)))


def test_parameters_and_texts_before_a_place_are_found() -> None:
    log = LogWriter()
    log.beat()
    first = log.add(m.ParamValue(b"SPEED", 1.0, 9, 2, 0))
    other = log.add(m.ParamValue(b"TURN", 5.0, 9, 2, 1))
    log.add(m.ParamValue(b"SPEED", 1.0, 9, 2, 0))
    second = log.add(m.ParamValue(b"SPEED", 2.0, 9, 2, 0))
    findings = indexed(bytes(log.data)).findings
    assert findings.params_before(second) == [first, other]
    assert findings.params_before(len(log.data)) == [second, other]


def test_invented_sources_do_not_grow_the_index() -> None:
    log = LogWriter()
    for number in range(6000):
        log.time = number / 100
        log.add(m.Attitude(number, 0, 0, 0, 0, 0, 0), number % 250 + 1, number // 250 + 1)
    assert len(indexed(bytes(log.data)).places) <= log_index.MAX_KEYS


def test_a_camera_that_beats_on_does_not_hide_a_silent_vehicle() -> None:
    log = drive_log(5)
    for second in range(5, 20):
        log.time = second
        log.add(m.Heartbeat(30, 8, 0, 0, 4, 3), 1, 100)
    log.beat()
    assert (19.0, "LINK", "no heartbeat for 15.0 s before") in events_of(indexed(bytes(log.data)))


def test_a_full_list_leaves_out_texts_but_no_warnings(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(events, "MAX_EVENTS", 10)
    log = LogWriter()
    log.beat()
    for number in range(20):
        log.say(f"text {number}")
    log.say("low battery", 4)
    index = indexed(bytes(log.data))
    assert [each.text for each in index.findings.finder.events][-2:] == ["text 8", "low battery"]
    assert index.findings.finder.events.left_out == 11


def test_messages_without_payload_open() -> None:
    """MAVLink 2 leaves out zeros at the end; some programs leave out the first byte, too."""
    log = drive_log(5)
    for number in MESSAGES:
        log.data += encode_record(round((NOON + 5) * 1e6), codec.frame(number, b"", 0, 1, 1))
    index = indexed(bytes(log.data))
    assert index.damaged == 0
    assert index.duration == pytest.approx(5.0)


def test_times_that_no_clock_shows_move_nothing() -> None:
    log = drive_log(5)
    for number in range(5):
        log.data += encode_record((1 << 64) - 9 + number, codec.frame(253, b"\x04late", 0, 1, 1))
    index = indexed(bytes(log.data))
    late = [each.time for each in index.findings.finder.events if each.text == "late"]
    assert len(late) == 5
    assert 4.8 <= min(late) <= max(late) <= index.duration <= 4.9 + 1e-9


def test_an_event_whose_stamp_damage_hit_stands_where_it_was() -> None:
    log = drive_log(20)
    at = log.say("here", 4)
    log.beat()
    data = bytearray(log.data)
    data[at + 3] ^= 0x04
    assert (19.9, "TEXT", "here") in events_of(indexed(bytes(data)))


def test_chunks_of_a_text_are_one_event_of_its_first_moment() -> None:
    log, raw = drive_log(20), b"x" * 49 + "ü and the end".encode()
    log.time = 20.0
    for number, chunk in enumerate((raw[:50], raw[50:])):
        log.add(m.StatusText(4, chunk, 9, number))
        log.time += 0.1
    log.add(m.StatusText(4, b"lost ".ljust(50, b"."), 10, 0))
    log.add(m.StatusText(4, b"its middle", 10, 2))
    found = [each for each in events_of(indexed(bytes(log.data))) if each[1] == "TEXT" and each[0] >= 20]
    assert found == [
        (20.0, "TEXT", "x" * 49 + "ü and the end"),
        (20.2, "TEXT", f"{'lost '.ljust(50, '.')} [...] its middle"),
    ]
