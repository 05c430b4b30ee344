"""Answers to genuine frames whose time is refused, and whose clock a link follows, in a few frames."""

from __future__ import annotations

import hashlib

import pytest

from link.core import GuardReport, LinkReport, Outgoing, SigningCounts
from link.protocol.channel import Channel
from link.protocol.link_events import link_problem
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signature import link_and_stamp
from link.signing.signing import Signing
from link.signing.verifier import Refusal
from tests.link.signing.signed import (
    ARM,
    DAY,
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

SECOND = 100_000
"""In timestamps."""
STATION = SigningPolicy(None, greets_late=True, announces=True)


def answers(channel: Channel, now: float = 0.0) -> list[tuple[object, int]]:
    """The addresses of those to answer, and the time that each is told."""
    found = []
    for peer in channel.pop_untimely():
        for data, address, _ in channel.send(Outgoing(HEARTBEAT, peer), now=now):
            found.append((address, link_and_stamp(data)[1] - NOW))
    return found


def lead(channel: Channel, now: float = 0.0) -> int:
    """How far frames to HERE are signed ahead of our clock."""
    way = channel.signing_way(HERE, now)
    assert way is not None
    return way.lead


def right(*keys: SigningKey) -> Signing:
    """What a vehicle has that knows the right time."""
    return Signing(keep(*keys).ring, wall=NOON, now=0.0, synchronized=True)


# ---- who is answered ----


@pytest.mark.parametrize("stamp", [NOW - DAY, NOW - 61 * SECOND])
def test_a_late_frame_is_answered_at_its_address(stamp: int) -> None:
    channel = vehicle(keep(DRIVER))
    assert channel.receive(signed(ARM, stamp=stamp), HERE, 0.0) == []
    assert answers(channel) == [(HERE, 0)]
    assert channel.pop_untimely() == []


def test_a_frame_of_the_far_future_is_answered_and_counted() -> None:
    channel = vehicle(right(DRIVER))
    assert channel.receive(signed(stamp=NOW + DAY + 1), HERE, 0.0) == []
    assert answers(channel) == [(HERE, 0)]
    assert channel.report().refused == SigningCounts(too_old=1)


def test_a_stranger_and_a_station_are_not_answered() -> None:
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(key=STRANGER, stamp=NOW - DAY), HERE, 0.0)
    assert answers(channel) == []
    near = station(keep(DRIVER), STATION)
    near.receive(signed(ARM, stamp=NOW - DAY, ids=(1, 1)), HERE, 0.0)
    assert near.pop_untimely() == []


@pytest.mark.parametrize(("behind", "answered"), [(0, False), (5 * SECOND - 1, False), (5 * SECOND, True)])
def test_a_replay_at_its_own_place_is_a_copy_for_5_s(behind: int, answered: bool) -> None:
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(), HERE, 0.0)
    assert channel.receive(signed(stamp=NOW - behind), HERE, 0.0) == []
    assert (answers(channel) == [(HERE, 0)]) is answered


def test_a_replay_from_elsewhere_or_of_another_key_is_answered() -> None:
    channel = vehicle(keep(DRIVER, WATCHER))
    channel.receive(signed(), HERE, 0.0)
    channel.receive(signed(), THERE, 0.0)
    assert [address for address, _ in answers(channel)] == [THERE]
    channel.receive(signed(key=WATCHER, ids=(254, 190)), HERE, 0.0)
    channel.receive(signed(), HERE, 0.0)
    assert [address for address, _ in answers(channel)] == [HERE]


def test_behind_one_address_each_key_is_answered_once_a_second() -> None:
    channel, times = vehicle(keep(DRIVER, WATCHER)), []
    for step in range(24):
        now = step / 10
        for key in (DRIVER, WATCHER):
            channel.receive(signed(ARM, key, NOW - DAY + step), HERE, now)
            times += [now for _ in channel.pop_untimely()]
    assert times == [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]


def test_32_senders_are_answered_in_a_second() -> None:
    channel = vehicle(keep(DRIVER))
    for host in range(40):
        channel.receive(signed(stamp=NOW - DAY), (f"10.0.0.{host}", 1), 0.0)
    assert len(channel.pop_untimely()) == 32


def test_the_newest_32_senders_can_be_answered() -> None:
    channel = vehicle(keep(DRIVER))
    for host in range(33):
        channel.receive(signed(stamp=NOW - DAY), (f"10.0.0.{host}", 1), 0.0 if host < 20 else 1.0)
    assert [address for address, _ in answers(channel, 1.0)] == [(f"10.0.0.{host}", 1) for host in range(1, 33)]


def test_a_time_too_far_ahead_is_answered_at_its_own_place() -> None:
    channel = vehicle(right(DRIVER))
    channel.receive(signed(), HERE, 0.0)
    channel.receive(signed(stamp=NOW + DAY + 1), HERE, 0.0)
    assert [address for address, _ in answers(channel)] == [HERE]


def test_an_answer_costs_no_place_and_its_numbers_go_on() -> None:
    channel = vehicle(keep(DRIVER))
    sequences = []
    for now in (0.0, 1.0, 2.0):
        channel.receive(signed(stamp=NOW - DAY), HERE, now)
        for peer in channel.pop_untimely():
            sequences += [number for _, _, number in channel.send(Outgoing(HEARTBEAT, peer), now=now)]
    assert sequences == [0, 1, 2]
    assert list(channel._peers) == []
    assert send(channel) == []


def test_the_answer_tells_the_time_that_is_accepted() -> None:
    """That of the key's newest stream, where it is ahead of the clock; after that only the newest counts."""
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(stamp=NOW + 900 * SECOND), HERE, 0.0)
    channel.receive(signed(stamp=NOW + 1), THERE, 0.0)
    assert answers(channel) == [(THERE, 900 * SECOND)]


# ---- whose clock is followed ----


@pytest.mark.parametrize(("ahead", "at_once"), [(DAY, True), (DAY + 1, False)])
def test_station_follows_one_day_at_once_and_more_once_reported(ahead: int, at_once: bool) -> None:
    channel = station(keep(DRIVER), STATION)
    channel.receive(signed(stamp=NOW + ahead, ids=(1, 1)), HERE, 0.0)
    assert link_and_stamp(send(channel)[0])[1] - NOW == (ahead if at_once else 0)
    guard = channel.report(now=0.0).guard
    assert guard is not None
    assert guard.ahead == {1: ahead / SECOND}
    assert link_and_stamp(send(channel)[0])[1] - NOW >= ahead


@pytest.mark.parametrize("reported", [0, SECOND, DAY])
def test_what_a_report_did_not_call_ahead_is_not_followed(reported: int) -> None:
    channel = station(keep(DRIVER), STATION)
    channel.receive(signed(stamp=NOW + reported, ids=(1, 1)), HERE, 0.0)
    channel.report(now=0.0)
    channel.receive(signed(stamp=NOW + 9 * DAY, ids=(1, 1)), HERE, 0.0)
    assert lead(channel) == 0
    channel.report(now=0.0)
    assert lead(channel) == 9 * DAY


def test_a_station_with_right_time_follows_what_it_reports() -> None:
    channel = station(right(DRIVER), STATION)
    assert channel.receive(signed(stamp=NOW + 9 * DAY, ids=(1, 1)), HERE, 0.0)
    channel.report(now=0.0)
    channel.receive(signed(stamp=NOW + 8 * DAY, ids=(1, 1), link_id=1), HERE, 0.0)
    assert lead(channel) == 9 * DAY


@pytest.mark.parametrize("ahead", [20 * SECOND, 2 * DAY])
def test_a_lead_is_the_same_whenever_it_was_heard(ahead: int) -> None:
    """Without the right time the largest lead is kept, however large."""
    channel = vehicle(keep(DRIVER))
    channel.receive(signed(stamp=NOW + 100 * SECOND + ahead), HERE, 100.0)
    channel.receive(signed(stamp=NOW + 200 * SECOND + ahead // 2, link_id=1), HERE, 200.0)
    assert lead(channel, 200.0) == ahead
    assert lead(channel, 300.0) == ahead


def test_a_report_of_one_key_says_nothing_of_another() -> None:
    channel = station(keep(DRIVER, WATCHER), STATION)
    channel.receive(signed(key=WATCHER, stamp=NOW + 9 * DAY, ids=(1, 1)), HERE, 0.0)
    channel.report(now=0.0)
    channel.receive(signed(stamp=NOW + 9 * DAY, ids=(2, 1)), HERE, 0.0)
    assert link_and_stamp(send(channel)[0])[1] - NOW < DAY


@pytest.mark.parametrize(("ahead", "followed"), [(DAY, True), (DAY + 1, False)])
def test_who_knows_the_right_time_follows_a_day(ahead: int, followed: bool) -> None:
    signing = keep(DRIVER)
    channel = vehicle(signing)
    channel.receive(signed(stamp=NOW + ahead), HERE, 0.0)
    assert link_and_stamp(send(channel)[0])[1] - NOW == ahead
    signing.update(NOON, 0.0, synchronized=True)
    assert lead(channel) == (ahead if followed else 0)
    channel.receive(signed(stamp=NOW + 30 * SECOND, link_id=1), HERE, 0.0)
    told = link_and_stamp(send(channel)[0])[1] - NOW
    assert told >= ahead if followed else 30 * SECOND <= told < 31 * SECOND


def test_clock_behind_is_not_followed_and_largest_lead_is_kept() -> None:
    channel = vehicle(keep(DRIVER))
    for link_id, stamp in enumerate((NOW - 30 * SECOND, NOW + 20 * SECOND, NOW + 10 * SECOND)):
        channel.receive(signed(stamp=stamp, link_id=link_id), HERE, 0.0)
        told = link_and_stamp(send(channel)[0])[1] - NOW
        assert told // SECOND == (0 if link_id == 0 else 20)


def test_clocks_of_16_keys_are_kept_at_an_address() -> None:
    keys = [SigningKey(f"k{n}", SigningRole.DRIVE, hashlib.sha256(bytes([n])).digest()) for n in range(17)]
    signing = keep(*keys[:16])
    channel = vehicle(signing)
    for n, key in enumerate(keys[:16]):
        channel.receive(signed(key=key, stamp=NOW + n), HERE, 0.0)
    (state,) = channel._peers
    assert len(state.clocks) == 16
    channel.receive(signed(key=keys[3], stamp=NOW + 900), HERE, 0.0)
    assert len(state.clocks) == 16
    signing.set_ring(signing.ring.remove("k0").add(keys[16]))
    channel.receive(signed(key=keys[16]), HERE, 0.0)
    assert list(state.clocks) == [keys[16]]


def test_without_keys_there_is_no_time() -> None:
    channel = Channel("udpout:x", 0, system=255, component=190, target=HERE)
    channel.guard = SigningGuard(keep(), STATION, 0)
    assert len(send(channel)) == 1


def test_the_system_that_is_most_ahead_is_named() -> None:
    guard = GuardReport("laptop", ahead={1: 3 * 86_400.0, 2: 9 * 86_400.0, 3: 2 * 86_400.0})
    text = link_problem(LinkReport("udpin:x", refused=SigningCounts(), verified=frozenset({1}), guard=guard)) or ""
    assert text.startswith("system 2 signs 9 days ahead")


# ---- ranks ----


def test_the_best_key_of_a_datagram_decides_about_its_place() -> None:
    channel = vehicle(keep(DRIVER, WATCHER))
    for number in range(24):
        channel.receive(signed(key=WATCHER, stamp=NOW + number, ids=(100, 190)), (f"10.0.0.{number}", 1), 0.0)
    data = signed(key=WATCHER, ids=(254, 190)) + signed(stamp=NOW + 1) + signed(ARM, WATCHER, ids=(253, 190))
    assert channel.receive(data, HERE, 0.1) != []
    assert HERE in [peer.address for peer in channel.report().audience]


def test_a_key_that_was_withdrawn_is_answered_nothing() -> None:
    guard = SigningGuard(keep(DRIVER), STATION, 0)
    late = [(0, 255, 190, 0, signed(key=key, stamp=NOW - DAY)) for key in (STRANGER, DRIVER)]
    assert guard.find_untimely(None, [(late[0], Refusal.REPLAYED)], HERE, 0.0) is None
    assert guard.find_untimely(None, [(each, Refusal.REPLAYED) for each in late], HERE, 0.0) == DRIVER
