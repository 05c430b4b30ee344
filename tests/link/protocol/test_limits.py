"""Limits in literal numbers: what a table holds, how fast messages may come, how long something is remembered."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

import pytest

from dialects.messages import FileTransferProtocol, RadioStatus
from link.core import LinkReport, Outgoing, SigningCounts, SourceCount
from link.protocol.channel import Channel
from link.protocol.failed_frame import MAX_MISMATCHES
from link.protocol.flow_control import FlowControl
from link.protocol.frame import MAX_UNKNOWN, MISMATCH_AFTER, NOISE_HINT_BYTES
from link.protocol.link_events import PROVEN_AFTER, link_problem
from link.protocol.log_tap import MAX_REMEMBERED, LogTap, _Copies
from link.protocol.peer import MAX_SOURCES, PeerState, _buckets
from link.protocol.peer_table import MAX_PEERS, PEER_SILENCE, RESERVED_PLACES
from link.protocol.rate import RateMeter
from link.protocol.sent_frames import FRAMES_MAX
from link.protocol.signing_guard import LANES, WATCHDOG_LANE
from link.signing.signature import link_and_stamp
from link.signing.verifier import AHEAD_MAX
from tests.link.frames import frame, heartbeat
from tests.link.signing.signed import DRIVER, HEARTBEAT, HERE, NOW, THERE, keep, send, signed, station
from tests.link.signing.signed import vehicle as guarded
from tests.rows import each_row


def vehicle(**options: object) -> Channel:
    return Channel("udpin:127.0.0.1:14550", 0, system=1, component=1, **options)  # type: ignore[arg-type]


def test_tables_are_as_large_as_their_memory_was_reckoned_with() -> None:
    assert (MAX_PEERS, RESERVED_PLACES, MAX_SOURCES) == (24, 4, 64)
    assert (MAX_UNKNOWN, MAX_MISMATCHES) == (64, 64)
    assert (FRAMES_MAX, MAX_REMEMBERED) == (1024, 4096)


def test_what_counts_as_proof_and_as_silence() -> None:
    assert (MISMATCH_AFTER, PROVEN_AFTER, NOISE_HINT_BYTES) == (3, 3, 512)
    assert PEER_SILENCE == 10.0


def test_link_ids_of_a_byte_are_shared_by_32_links_and_watchdogs() -> None:
    assert (LANES, WATCHDOG_LANE) == (4, 128)
    assert AHEAD_MAX == 86_400 * 100_000, "a day of 10 us"


# ---- rates ----


@pytest.mark.parametrize(
    ("kind", "rate", "burst"),
    [("demand", 200, 50), ("command", 200, 100), ("file", 14_000, 2_000), ("rest", 2500, 1000)],
)
def test_each_kind_of_message_has_its_rate_and_burst(kind: str, rate: int, burst: int) -> None:
    bucket = _buckets()[kind]
    assert sum(bucket.consume(0.0) for _ in range(burst + 10)) == burst
    eighths = [sum(bucket.consume(eighth / 8) for _ in range(rate // 8 + 2)) for eighth in range(1, 9)]
    assert sum(eighths) == rate


@pytest.mark.parametrize(("downloads", "burst"), [(True, 2000), (False, 1000)])
def test_files_come_in_larger_bursts_to_a_station_that_downloads(downloads: bool, burst: int) -> None:
    channel, piece = vehicle(downloads=downloads), FileTransferProtocol(0, 1, 1, bytes(251))
    assert sum(len(channel.receive(frame(piece, number % 256), HERE, 0.0)) for number in range(burst + 10)) == burst


def test_a_meter_counts_what_came_in_its_window() -> None:
    chance = random.Random(1)
    for window in (0.5, 1.0, 2.0):
        meter, events, now = RateMeter(window), list[tuple[float, float]](), 0.0
        for _ in range(300):
            now += chance.choice((0.0, 0.125, 0.25, 0.5, 1.0))
            if chance.random() < 0.7:
                events.append((now, float(chance.randrange(1, 5))))
                meter.add(*events[-1])
            recent = sum(amount for at, amount in events if at > now - window)
            assert meter.rate(now) == recent / window


def test_a_meter_counts_single_events_of_one_second() -> None:
    meter = RateMeter()
    for eighth in range(8):
        meter.add(eighth / 8)
    assert meter.rate(0.875) == 8.0
    assert meter.rate(1.0) == 7.0
    assert meter.rate(1.874) == 1.0


def test_a_meter_that_nobody_reads_keeps_its_window_only() -> None:
    meter = RateMeter(1.0)
    for number in range(1000):
        meter.add(number / 10)
    assert len(meter._events) == 10


# ---- flow control ----


@each_row("free", range(101, 256, 11))
def test_a_radio_that_reports_no_percentage_changes_nothing(free: int) -> None:
    flow = FlowControl()
    for _ in range(5):
        flow.handle_radio_status(30, 0.0)
    before = flow.headroom(0.0)
    flow.handle_radio_status(free, 0.0)
    assert flow.headroom(0.0) == before


def test_a_radio_limits_to_a_share_in_literal_seconds() -> None:
    flow = FlowControl()
    flow.handle_radio_status(0, 0.0)
    assert flow.headroom(0.0) == pytest.approx(0.2 / 0.26)
    for _ in range(100):
        flow.handle_radio_status(0, 0.0)
    assert flow.headroom(5.0) == pytest.approx(0.2 / 2.2)
    assert flow.headroom(5.001) == 1.0


# ---- copies in the log ----


def recorder(kept: list[bytes]) -> Callable[[float, Sequence[bytes]], None]:
    return lambda now, frames: kept.extend(frames)


def test_a_copy_is_known_for_one_second_at_least_and_two_at_most() -> None:
    copies = _Copies()
    assert not copies.is_copy(b"a", 0, 0.0)
    assert not copies.is_copy(b"b", 0, 1.0)
    assert copies.is_copy(b"a", 1, 1.9)
    assert not copies.is_copy(b"a", 1, 2.0)
    assert copies.is_copy(b"b", 1, 2.0)


@pytest.mark.parametrize(("age", "copy"), [(0.999, True), (1.0, True), (1.999, True), (2.0, False), (2.9, False)])
def test_a_copy_behind_a_silence_is_known_for_two_seconds(age: float, copy: bool) -> None:
    for start in (0.0, 100.0):
        copies = _Copies()
        copies.is_copy(b"before", 0, start)
        copies.is_copy(b"a", 0, start)
        assert copies.is_copy(b"a", 1, start + age) is copy


def test_a_frame_is_forgotten_after_twice_4096_others() -> None:
    for others, copy in ((8190, True), (8191, False)):
        copies = _Copies()
        for number in range(others + 1):
            copies.is_copy(number.to_bytes(4, "little"), 0, 0.0)
        assert copies.is_copy(bytes(4), 1, 0.0) is copy


def test_a_log_that_keeps_signatures_gets_frames_as_they_were() -> None:
    for keeps in (False, True):
        kept: list[bytes] = []
        tap = LogTap(recorder(kept), system=1, component=1, signatures=keeps)
        tap.record_received([(0, 255, 190, 0, signed()), (0, 255, 190, 1, heartbeat(1))], 0, 0.0)
        assert kept == [signed() if keeps else frame(HEARTBEAT), heartbeat(1)]


def test_nothing_is_passed_on_if_nothing_is_recorded() -> None:
    calls: list[int] = []
    tap = LogTap(lambda now, frames: calls.append(len(frames)), system=1, component=1)
    assert tap.unsent
    for link in (0, 1):
        tap.record_received([(0, 255, 190, 0, heartbeat(0))], link, 0.0)
    assert calls == [1]


# ---- times and counts of a channel ----


def test_reports_and_frames_default_to_time_0_and_no_drops() -> None:
    channel = vehicle(stream=True, target="x", capacity=5760.0)
    channel.receive(frame(RadioStatus(200, 200, 1, 30, 30, 0, 0), 0, 51, 68), "x", -4.5)
    assert channel.report().headroom < 1.0
    assert (channel.report().dropped, channel.report(dropped=3).dropped) == (0, 3)
    assert link_and_stamp(next(station(keep(DRIVER)).send(Outgoing(HEARTBEAT)))[0])[1] == NOW


def test_the_numbers_of_a_peer_begin_with_0_and_wrap() -> None:
    channel = vehicle(target=HERE)
    numbers = [number for _ in range(600) for _, _, number in channel.send(Outgoing(HEARTBEAT))]
    assert numbers == [number % 256 for number in range(600)]


def test_the_frames_of_a_source_are_summed_over_its_addresses() -> None:
    channel = vehicle()
    for address, number in ((HERE, 0), (HERE, 3), (THERE, 9), (THERE, 11), (THERE, 12)):
        channel.receive(heartbeat(number), address, 0.0)
    assert channel.report().sources == {(255, 190): SourceCount(5, 3)}


def test_each_refused_sender_has_its_own_counts() -> None:
    channel = guarded(keep(DRIVER))
    for system, times in ((100, 1), (101, 3)):
        for number in range(times):
            channel.receive(heartbeat(number, system=system), HERE, 0.0)
    report = channel.report()
    assert report.refused == SigningCounts(unsigned=4)
    assert report.guard is not None
    assert report.guard.refused == {100: SigningCounts(unsigned=1), 101: SigningCounts(unsigned=3)}


def test_the_clock_of_a_peer_is_followed_until_2100() -> None:
    until = (4_102_444_800 - 1_420_070_400) * 100_000
    for stamp, followed in ((until - 1, True), (until, True), (until + 1, False)):
        channel = guarded(keep(DRIVER))
        channel.receive(signed(stamp=stamp), HERE, 0.0)
        assert (link_and_stamp(send(channel)[0])[1] >= stamp) is followed


def test_the_lead_of_a_clock_is_reported_in_seconds() -> None:
    channel = station(keep(DRIVER))
    channel.receive(signed(stamp=NOW + 250_000, ids=(1, 1)), HERE, 0.0)
    channel.receive(signed(stamp=NOW, ids=(2, 1)), THERE, 0.0)
    guard = channel.report().guard
    assert guard is not None
    assert guard.ahead == {1: 2.5}
    assert guard.key == f"{DRIVER.name} ({DRIVER.fingerprint})"


# ---- texts ----


def test_five_foreign_messages_are_named() -> None:
    names = tuple(f"MESSAGE_{letter}" for letter in "ABCDEF")
    text = link_problem(LinkReport("udpin:127.0.0.1:14550", dialect_mismatch=names)) or ""
    assert "MESSAGE_E;" in text
    assert "MESSAGE_F" not in text


def test_a_new_peer_has_sent_and_received_nothing() -> None:
    (state,) = vehicle(target=HERE)._peers
    assert isinstance(state, PeerState)
    assert (state.sequence, state.clocks, state.fixed, state.connected, state.silent) == (0, {}, True, False, True)
