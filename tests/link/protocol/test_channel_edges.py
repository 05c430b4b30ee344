"""What a channel makes of each frame beside its message: who sent it, in which order, and what its report says."""

from __future__ import annotations

from itertools import count

import pytest
from msgspec.structs import fields

from dialects.messages import FileTransferProtocol, Ping, RadioStatus
from link.core import LinkReport, Outgoing, Received
from link.protocol.channel import Channel
from link.protocol.log_tap import LogTap
from link.protocol.peer_table import MAX_PEERS
from link.protocol.sent_frames import SentFrames
from link.protocol.signing_guard import SigningGuard, SigningPolicy
from link.signing.role import SigningRole
from link.signing.signature import SecretHash, link_and_stamp
from tests.link.frames import demand, frame, heartbeat, version_1
from tests.link.signing.signed import (
    ARM,
    DAY,
    DISARM,
    DRIVER,
    HEARTBEAT,
    HERE,
    NOW,
    SIGNED_ONLY,
    STRANGER,
    THERE,
    WATCHER,
    keep,
    send,
    signed,
    station,
)
from tests.link.signing.signed import vehicle as guarded

GREETS = SigningPolicy(unsigned=None, greets_late=True)
NAME = "udpin:127.0.0.1:14550"
SET_BY_THE_RUNNER = {"frames_sent", "bytes_sent", "watch_only", "retry_in", "routes"}
"""Fields of a report that a channel does not know."""


def vehicle(**options: object) -> Channel:
    return Channel(NAME, 0, system=1, component=1, **options)  # type: ignore[arg-type]


def describe(found: list[Received]) -> list[tuple[int, int, int, bool, bool, int, bool]]:
    return [
        (each.system, each.component, each.sequence, each.introduced, each.may_ask, each.numbering, each.clash)
        for each in found
    ]


def test_a_channel_that_heard_nothing_reports_nothing() -> None:
    assert vehicle().report() == LinkReport(NAME)


def test_each_field_of_a_report_is_filled() -> None:
    sent = SentFrames()
    channel = guarded(
        keep(DRIVER), SigningPolicy(SigningRole.WATCH), 3, stream=True, capacity=5760.0, sent=sent, places=1
    )
    numbers = count()
    bad = bytearray(demand(0))
    bad[-1] ^= 0x55
    foreign = bytes([0xFD, 4, 0, 0, 9, 255, 190, 0xAF, 0xB3, 0xEE]) + b"123412"
    channel.receive(b"\x80" + (bytes(bad) + foreign) * 3 + signed(ARM), HERE, 0.0)
    channel.receive(signed(key=STRANGER), HERE, 0.0)
    train = [heartbeat(next(numbers), system=9), heartbeat(3, system=9), heartbeat(2, system=9), heartbeat(3, system=9)]
    channel.receive(b"".join(train), HERE, 0.0)
    channel.receive(b"".join(frame(ARM, number % 256, 8) for number in range(200)), HERE, 0.0)
    channel.receive(frame(HEARTBEAT, 0, 1, 1) + frame(RadioStatus(1, 1, 1, 1, 1, 0, 0), 0, 51, 68), HERE, 0.0)
    channel.receive(heartbeat(0, system=7), THERE, 0.0)
    channel.receive(version_1(HEARTBEAT, 0, 12, 1), HERE, 0.0)
    channel.receive(signed(stamp=NOW + 1), HERE, 0.0)
    report, empty = channel.report("unplugged", dropped=2), LinkReport(NAME)
    same = {each.name for each in fields(LinkReport) if getattr(report, each.name) == getattr(empty, each.name)}
    assert same - SET_BY_THE_RUNNER == set()


def test_overtaken_and_repeated_frames_are_counted_one_by_one() -> None:
    channel = vehicle()
    for number in (0, 5, 3, 4, 5, 5, 5):
        channel.receive(heartbeat(number), HERE, 0.0)
    report = channel.report()
    assert (report.late, report.duplicates) == (2, 3)


def test_the_first_datagram_of_a_sender_counts_once() -> None:
    channel = vehicle()
    assert len(channel.receive(heartbeat(0) + demand(1), HERE, 0.0)) == 2
    assert (channel.report().frames, channel.report().duplicates) == (2, 0)


def test_each_message_comes_with_its_sender() -> None:
    channel = vehicle()
    found = channel.receive(demand(7), HERE, 0.0)
    found += channel.receive(heartbeat(8) + demand(9) + heartbeat(0, system=254, component=25), HERE, 0.0)
    assert describe(found) == [
        (255, 190, 7, False, False, 1, False),
        (255, 190, 8, True, True, 1, False),
        (255, 190, 9, True, True, 1, False),
        (254, 25, 0, True, True, 1, False),
    ]
    assert len({each.digest for each in found}) == 4
    assert [(each.role, each.signed) for each in found] == [(SigningRole.SET_UP, False)] * 4, "nothing is verified here"
    assert describe(vehicle(target=HERE).receive(demand(7), HERE, 0.0)) == [(255, 190, 7, False, True, 1, False)]


def test_the_verdicts_of_signing_belong_to_their_frames() -> None:
    channel = guarded(keep(DRIVER), SigningPolicy(SigningRole.WATCH))
    data = heartbeat(0, system=0) + heartbeat(0, system=9) + signed(ARM) + heartbeat(1, system=9)
    assert [(each.system, each.role, each.signed) for each in channel.receive(data, HERE, 0.0)] == [
        (9, SigningRole.WATCH, False),
        (255, SigningRole.SET_UP, True),
        (9, SigningRole.WATCH, False),
    ]


def test_a_program_with_our_ids_is_no_peer_that_speaks() -> None:
    channel = vehicle(target=HERE)
    channel.receive(frame(HEARTBEAT, 0, 1, 1), HERE, 0.0)
    channel.receive(heartbeat(0, system=0), HERE, 0.0)
    (state,) = channel._peers
    assert (state.silent, state.sources, state.newest) == (True, {}, {})


def test_only_our_ids_are_ours_as_a_pair() -> None:
    channel = vehicle()
    assert (
        len(channel.receive(heartbeat(0, system=1, component=2) + heartbeat(0, system=2, component=1), HERE, 0.0)) == 2
    )
    assert not channel.report().own_id


def test_own_ids_that_were_seen_once_stay_reported() -> None:
    channel = vehicle()
    channel.receive(frame(HEARTBEAT, 0, 1, 1) + heartbeat(0, system=0), HERE, 0.0)
    assert channel.report().own_id


def test_frames_that_return_on_another_channel_are_our_own() -> None:
    sent = SentFrames()
    one, other = vehicle(sent=sent, target=THERE), vehicle(sent=sent)
    for data in send(one):
        other.receive(data, HERE, 0.0)
    assert not other.report().own_id
    alone = vehicle(target=THERE)
    for data in send(alone):
        alone.receive(data, HERE, 0.0)
    assert not alone.report().own_id


def test_a_log_gets_what_arrives_and_nothing_of_noise() -> None:
    calls: list[list[bytes]] = []
    channel = vehicle()
    channel.log_tap = LogTap(lambda now, frames: calls.append(list(frames)), system=1, component=1)
    channel.receive(b"noise", HERE, 0.0)
    channel.receive(heartbeat(0) + demand(1), HERE, 0.0)
    channel.receive(demand(2), HERE, 0.0)
    assert calls == [[heartbeat(0), demand(1)], [demand(2)]]


def test_wanted_messages_are_handed_on_and_others_not_limited() -> None:
    channel = vehicle(wanted=frozenset({Ping.id}))
    for number in range(1100):
        assert channel.receive(frame(FileTransferProtocol(0, 1, 1, bytes(251)), number % 256), HERE, 0.0) == []
    assert len(channel.receive(frame(Ping(0, 1, 1, 1), 1100 % 256), HERE, 0.0)) == 1
    assert channel.report().rate_limited == 0


def test_commands_beyond_the_limit_are_dropped_and_stops_are_not() -> None:
    channel = vehicle()
    numbers = count()
    for _ in range(100):
        assert len(channel.receive(frame(ARM, next(numbers) % 256), HERE, 0.0)) == 1
    assert channel.receive(frame(ARM, next(numbers) % 256), HERE, 0.0) == []
    assert len(channel.receive(frame(DISARM, next(numbers) % 256), HERE, 0.0)) == 1
    assert channel.report().rate_limited == 1


@pytest.mark.parametrize("repeats", [1, 3])
def test_a_stop_is_handed_on_each_time_and_other_frames_once(repeats: int) -> None:
    for message, handed_on in ((DISARM, 1 + repeats), (ARM, 1)):
        channel = vehicle()
        found = [each for _ in range(1 + repeats) for each in channel.receive(frame(message, 9), HERE, 0.0)]
        assert len(found) == handed_on
        assert channel.report().duplicates == repeats


def test_a_greeted_peer_is_the_same_at_its_next_heartbeat() -> None:
    channel = guarded(keep(DRIVER), GREETS)
    for number in (0, 1):
        channel.receive(signed(stamp=NOW - DAY + number), HERE, 0.0)
        assert [raw[4] for raw in send(channel)] == [number]
    guard = channel.report(now=0.0).guard
    assert guard is not None
    assert set(guard.behind) == {255}


def test_link_ids_begin_again_after_32_links() -> None:
    for index, first in ((0, 0), (31, 124), (32, 0), (33, 4)):
        signing = keep(DRIVER)
        channel = station(signing)
        channel.guard = SigningGuard(signing, SIGNED_ONLY, index)
        assert link_and_stamp(send(channel)[0])[0] == first + 3


def test_only_stops_of_a_signing_sender_without_a_place_count() -> None:
    channel = guarded(keep(DRIVER), SigningPolicy(None, open_stops=True))
    for port in range(MAX_PEERS):
        channel.receive(signed(stamp=NOW + port), ("192.0.2.9", port), 0.0)
    data = frame(DISARM, 3) + signed(DISARM, stamp=NOW + 50, sequence=50) + signed(ARM, stamp=NOW + 51, sequence=51)
    assert [each.sequence for each in channel.receive(data, THERE, 0.0)] == [3, 50]


def test_a_broadcast_goes_to_all_and_foreign_messages_to_none() -> None:
    channel = vehicle()
    channel.receive(heartbeat(0), HERE, 0.0)
    assert [len(list(channel.send(Outgoing(each)))) for each in (HEARTBEAT, ARM)] == [1, 0]


def test_a_forged_or_replayed_heartbeat_is_not_greeted() -> None:
    channel = guarded(keep(DRIVER), GREETS)
    channel.receive(signed(key=STRANGER), HERE, 0.0)
    assert send(channel) == []
    channel.receive(signed(), HERE, 0.0)
    channel.receive(signed(), THERE, 0.0)
    assert [address for _, address, _ in channel.send(Outgoing(HEARTBEAT), now=0.0)] == [HERE]


def test_a_place_is_given_away_after_more_than_ten_seconds() -> None:
    for age, found in ((10.0, 0), (10.001, 1)):
        channel = vehicle(places=1)
        channel.receive(heartbeat(0), HERE, 0.0)
        assert len(channel.receive(heartbeat(0, system=9), THERE, age)) == found


def test_a_system_whose_key_was_withdrawn_is_not_verified() -> None:
    signing = keep(DRIVER)
    channel = guarded(signing)
    channel.receive(signed(), HERE, 0.0)
    assert channel.report().verified == {255}
    signing.set_ring(keep(WATCHER).ring)
    assert channel.report().verified == frozenset()


def test_system_with_replaced_key_is_not_verified_and_gets_none() -> None:
    signing = keep(DRIVER, WATCHER)
    signing.set_ring(signing.ring.choose(WATCHER.name))
    channel = guarded(signing)
    channel.receive(signed(), HERE, 0.0)
    (before, _, _), *_ = channel.send(Outgoing(HEARTBEAT), now=0.0)
    assert SecretHash(DRIVER.secret).matches(before)
    signing.set_ring(signing.ring.remove(DRIVER.name).add(STRANGER))
    assert channel.report().verified == frozenset()
    (after, _, _), *_ = channel.send(Outgoing(HEARTBEAT), now=0.0)
    assert SecretHash(WATCHER.secret).matches(after), "ours, as to a peer that has not signed"
    way = channel.signing_way(HERE, 0.0)
    assert way is not None
    assert way.key == WATCHER.name


def test_a_wanted_stop_without_a_place_is_handed_on() -> None:
    channel = vehicle(places=1, wanted=frozenset({type(ARM).id, type(HEARTBEAT).id}))
    channel.receive(heartbeat(0), HERE, 0.0)
    assert len(channel.receive(frame(DISARM), THERE, 0.0)) == 1
