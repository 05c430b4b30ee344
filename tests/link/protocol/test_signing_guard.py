"""Signing on a link: unsigned frames, MAVLink 1, stops, RADIO_STATUS, roles, and clocks that differ by years."""

from __future__ import annotations

import pytest

from dialects.codec import MAGIC_V1
from dialects.messages import Attitude, CommandLong, Heartbeat, ManualControl, RadioStatus
from link.core import Outgoing, SigningCounts
from link.protocol.log_tap import LogTap
from link.protocol.peer_table import MAX_PEERS
from link.protocol.signing_guard import LANES, SigningGuard, SigningPolicy, lane_of
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signature import is_signed, link_and_stamp
from link.signing.verifier import Refusal, Verified
from tests.link.frames import frame, heartbeat, version_1
from tests.link.signing.signed import (
    ARM,
    DAY,
    DISARM,
    DRIVER,
    HEARTBEAT,
    HERE,
    NOON,
    NOW,
    STRANGER,
    THERE,
    WATCHER,
    keep,
    send,
    signed,
    station,
    vehicle,
)

OPEN_STOPS = SigningPolicy(unsigned=None, open_stops=True)
WATCHED = SigningPolicy(unsigned=SigningRole.WATCH, open_stops=True)
GREETS = SigningPolicy(unsigned=None, greets_late=True)
RADIO = RadioStatus(200, 200, 10, 50, 50, 0, 0)


def test_the_key_gives_the_role() -> None:
    channel = vehicle(keep(DRIVER, WATCHER))
    first = channel.receive(signed(ARM), HERE, 0.0)[0]
    other = channel.receive(signed(ARM, WATCHER, ids=(254, 190)), THERE, 0.0)[0]
    assert (first.role, first.signed) == (SigningRole.SET_UP, True)
    assert (other.role, other.signed) == (SigningRole.WATCH, True)


def test_unsigned_frames_are_refused_counted_and_get_no_place() -> None:
    channel = vehicle(keep(DRIVER))
    assert channel.receive(heartbeat(0), HERE, 0.0) == []
    assert channel.receive(frame(ARM, 1), HERE, 0.0) == []
    report = channel.report()
    assert report.refused == SigningCounts(unsigned=2)
    assert report.audience == ()
    assert send(channel) == []


def test_10_mavlink_1_has_no_signatures_and_is_refused() -> None:
    channel = vehicle(keep(DRIVER))
    assert channel.receive(version_1(HEARTBEAT), HERE, 0.0) == []
    assert channel.report().refused == SigningCounts(unsigned=1)


@pytest.mark.parametrize(("keys", "is_old"), [((DRIVER,), False), ((), True)])
def test_mavlink_1_is_answered_in_it_if_nothing_is_signed(keys: tuple[SigningKey, ...], is_old: bool) -> None:
    channel = station(keep(*keys), SigningPolicy(unsigned=SigningRole.SET_UP))
    assert channel.receive(version_1(HEARTBEAT, 0, 1, 1), HERE, 0.0)
    [answer] = send(channel, ARM)
    assert (answer[0] == MAGIC_V1, is_signed(answer)) == (is_old, not is_old)
    assert channel.speaks_version_1(HERE, 1) is is_old
    assert not channel.speaks_version_1(THERE, 1)


def test_unsigned_frames_have_the_role_that_the_link_grants() -> None:
    channel = vehicle(keep(DRIVER), WATCHED)
    found = channel.receive(frame(ARM), HERE, 0.0)[0]
    assert (found.role, found.signed) == (SigningRole.WATCH, False)


def test_nobody_unsigned_has_the_ids_of_a_sender_who_signs() -> None:
    """Else the numbers of a forger would clash with those of the driver, and stop the vehicle."""
    channel = vehicle(keep(DRIVER), SigningPolicy(unsigned=SigningRole.SET_UP))
    channel.receive(signed(), HERE, 0.0)
    assert channel.receive(frame(ARM, 1), HERE, 0.1) == []
    assert channel.receive(frame(ARM, 1), THERE, 0.1) == []
    assert channel.receive(frame(ARM, 1, system=254), THERE, 0.1)
    assert channel.report().refused == SigningCounts(unsigned=2)


@pytest.mark.parametrize("late", [0.0, 11.0])
def test_forged_frames_take_no_place_and_no_number_of_the_sender(late: float) -> None:
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(sequence=0), HERE, 0.0)
    for n in range(200):
        assert channel.receive(signed(ARM, STRANGER, NOW + n, sequence=n), HERE, late) == []
    found = channel.receive(signed(ARM, stamp=NOW + 1, sequence=1), HERE, late)[0]
    assert not found.clash
    assert channel.report().refused == SigningCounts(bad=200)


def test_a_stop_of_anybody_is_obeyed_only_if_stops_are_open() -> None:
    for policy, stopped in ((OPEN_STOPS, True), (SigningPolicy(unsigned=None), False)):
        for stop in (frame(DISARM), signed(DISARM, STRANGER), signed(DISARM, stamp=NOW - DAY), version_1(DISARM)):
            channel = vehicle(keep(DRIVER), policy)
            assert len(channel.receive(stop, HERE, 0.0)) == stopped
            assert len(channel.receive(stop, HERE, 0.1)) == stopped, "nor is a repeat"
        assert vehicle(keep(DRIVER), policy).receive(frame(ARM), HERE, 0.0) == []


def test_the_sender_of_an_open_stop_can_be_answered() -> None:
    channel = vehicle(keep(DRIVER), OPEN_STOPS)
    received = channel.receive(frame(DISARM), HERE, 0.0)[0]
    assert [address for _, address, _ in channel.send(Outgoing(HEARTBEAT, received.peer))] == [HERE]


def test_unsigned_radio_status_controls_the_flow_only() -> None:
    channel = vehicle(keep(DRIVER), capacity=5760.0)
    assert channel.receive(frame(RADIO, system=51, component=68), HERE, 0.0) == []
    report = channel.report(now=0.0)
    assert report.headroom < 1.0
    assert report.refused == SigningCounts()


def test_streams_in_pieces_are_verified_once() -> None:
    channel = vehicle(keep(DRIVER), stream=True)
    data = signed() + signed(ARM, stamp=NOW + 1, sequence=1)
    found = [each for n in range(len(data)) for each in channel.receive(data[n : n + 1], HERE, n / 1000)]
    assert [type(each.message) for each in found] == [Heartbeat, CommandLong]
    assert channel.report().refused == SigningCounts()


def test_a_new_connection_is_sent_to_before_its_first_frame() -> None:
    channel = vehicle(keep(DRIVER), stream=True)
    assert channel.receive(b"", HERE, 0.0) == []
    assert len(send(channel)) == 1


def test_frames_to_a_peer_are_signed_with_its_own_key() -> None:
    channel = vehicle(keep(DRIVER, WATCHER))
    channel.receive(signed(key=WATCHER, ids=(254, 190)), HERE, 0.0)
    channel.receive(signed(), THERE, 0.0)
    frames = {address: data for data, address, _ in channel.send(Outgoing(HEARTBEAT), now=0.0)}
    assert station(keep(WATCHER)).receive(frames[HERE], HERE, 0.0)
    assert station(keep(DRIVER)).receive(frames[THERE], HERE, 0.0)
    assert not station(keep(DRIVER)).receive(frames[HERE], HERE, 0.0)


def test_timestamps_rise_within_10_us_and_advance_with_the_clock() -> None:
    channel = station(keep(DRIVER))
    stamps = [link_and_stamp(each)[1] for now in (0.0, 0.0, 0.0, 0.5) for each in send(channel, now=now)]
    assert stamps == [NOW, NOW + 1, NOW + 2, NOW + 50_000]


def test_frames_that_overtake_others_have_link_ids_of_their_own() -> None:
    """A slow link sends a demand before telemetry that waits; no receiver may take that for a replay."""
    lanes = [lane_of(kind.id) for kind in (Attitude, type(ARM), ManualControl, Heartbeat)]
    assert lanes == list(range(LANES))
    signing = keep(DRIVER)
    for index, first in ((0, 0), (1, 4), (31, 124)):
        guard = SigningGuard(signing, OPEN_STOPS, index)
        channel = station(signing)
        channel.guard = guard
        assert link_and_stamp(send(channel)[0])[0] == first + 3


def test_peer_with_a_clock_ahead_gets_its_own_time_others_theirs() -> None:
    """The specification says to take over the later time: but a wrong one must not spread to other vehicles."""
    ahead = vehicle(keep(DRIVER, wall=NOON + 3650 * 86_400.0))
    ground = station(keep(DRIVER))
    assert ahead.receive(send(ground)[0], HERE, 0.0) == []
    assert ahead.report().refused == SigningCounts(too_old=1)
    ground.receive(signed(stamp=NOW + 3650 * DAY, ids=(1, 1)), HERE, 0.0)
    assert ahead.receive(send(ground)[0], HERE, 0.0)
    assert send(station(keep(DRIVER)))[0] != send(ground)[0]


@pytest.mark.parametrize("years", [-40, -1, 1, 10])
def test_both_ends_meet_however_wrong_the_vehicles_clock_is(years: int) -> None:
    rover = keep(DRIVER, wall=NOON + years * 365 * 86_400.0)
    ground = station(keep(DRIVER), GREETS)
    far = vehicle(rover, stream=True)
    far.receive(b"", THERE, 0.0)
    heard, obeyed = 0, 0
    for step in range(1, 20):
        now = step * 0.1
        for each in send(far, now=now):
            heard += len(ground.receive(each, HERE, now))
        for each in send(ground, now=now):
            obeyed += len(far.receive(each, THERE, now))
    assert heard > 15
    assert obeyed > 15


def test_vehicle_sends_nothing_to_the_sender_of_an_old_heartbeat() -> None:
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(stamp=NOW - DAY), HERE, 0.0)
    assert send(channel) == []


def test_logs_hold_no_signatures_and_no_refused_frames() -> None:
    kept: list[bytes] = []
    channel = vehicle(keep(DRIVER))
    channel.log_tap = LogTap(lambda now, frames: kept.extend(frames), system=1, component=1)
    channel.receive(signed(), HERE, 0.0)
    channel.receive(signed(key=STRANGER), HERE, 0.0)
    assert kept == [frame(HEARTBEAT)]


def test_signed_frame_behind_forged_header_is_verified_in_end() -> None:
    channel = vehicle(keep(DRIVER), stream=True)
    channel.receive(signed(), HERE, 0.0)
    forged = bytes([0xFD, 255, 0, 0, 0, 1, 1, 69, 0, 0])
    assert channel.receive(forged + signed(ARM, stamp=NOW + 1) + frame(ARM, 2), HERE, 0.1) == []
    assert channel.tick(0.11) == []
    (found,) = channel.tick(0.3)
    assert (found.role, found.signed) == (SigningRole.SET_UP, True)
    assert channel.report().refused == SigningCounts(unsigned=1)


def test_a_replay_is_counted() -> None:
    channel = vehicle(keep(DRIVER))
    for address in (HERE, THERE):
        channel.receive(signed(ARM), address, 0.0)
    assert channel.report().refused == SigningCounts(replayed=1)


def test_without_a_key_frames_are_sent_unsigned() -> None:
    channel = vehicle(keep(), WATCHED)
    channel.receive(heartbeat(0), HERE, 0.0)
    assert [is_signed(raw) for raw in send(channel)] == [False]


def test_a_late_sender_gets_no_place_where_there_is_none() -> None:
    channel = vehicle(keep(DRIVER), GREETS)
    for port in range(MAX_PEERS):
        channel.receive(signed(stamp=NOW + port, ids=(100, 190)), ("192.0.2.9", port), 0.0)
    assert channel.receive(signed(stamp=NOW - DAY), HERE, 0.1) == []
    assert HERE not in [peer.address for peer in channel.report().audience]


def test_the_watchdog_is_told_how_frames_to_a_peer_are_signed() -> None:
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(), HERE, 0.0)
    way = channel.signing_way(HERE, 0.0)
    assert way is not None
    assert way.key == DRIVER.name
    assert channel.signing_way(THERE, 0.0) is None


def test_a_signed_datagram_with_a_wrong_checksum_is_none() -> None:
    data = bytearray(signed())
    data[-14] ^= 1
    channel = vehicle(keep(DRIVER))
    assert channel.receive(bytes(data), HERE, 0.0) == []
    assert channel.report().crc_errors == 1


def test_two_keys_on_one_address_are_obeyed_and_last_is_answered() -> None:
    """Two ground stations behind a bridge: each has its own role, and one of them cannot verify the vehicle."""
    channel = vehicle(keep(DRIVER, WATCHER))
    first, second = keep(DRIVER), keep(WATCHER)
    for number, (key, ids) in enumerate(((DRIVER, (255, 190)), (WATCHER, (254, 190)), (DRIVER, (255, 190)))):
        (found,) = channel.receive(signed(HEARTBEAT, key, NOW + number, ids=ids, sequence=number), HERE, 0.1 * number)
        assert found.role is key.role
        (frame_back,) = send(channel, now=0.1 * number)
        ours = (first if key is DRIVER else second).verifier
        other = (second if key is DRIVER else first).verifier
        assert isinstance(ours.check(frame_back, 1, 1, 0.1 * number), Verified)
        assert other.check(frame_back, 1, 1, 0.1 * number) is Refusal.BAD_SIGNATURE
