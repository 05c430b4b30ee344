"""Whose place is kept when a channel has not enough: verified before unsigned, drive before watch, fair shares."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Hashable

import pytest

from dialects.messages import Attitude, CommandAck
from link.core import Outgoing
from link.protocol.channel import Channel
from link.protocol.signing_guard import SigningPolicy
from link.signing.keys import SigningKey
from link.signing.role import SigningRole
from link.signing.signature import link_and_stamp
from tests.link.frames import frame, heartbeat
from tests.link.signing.signed import DISARM, DRIVER, HEARTBEAT, HERE, NOW, THERE, WATCHER, keep, signed, vehicle

OPEN = SigningPolicy(unsigned=SigningRole.WATCH, open_stops=True)
OTHER = SigningKey("other", SigningRole.DRIVE, hashlib.sha256(b"another driver's").digest())
SECOND_WATCHER = SigningKey("phone", SigningRole.WATCH, hashlib.sha256(b"the phone's").digest())
PLACES = 24
ATTITUDE = Attitude(0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def hosts(channel: Channel) -> list[Hashable]:
    return [peer.address for peer in channel.report().audience]


def places(channel: Channel) -> list[Hashable]:
    """Those of `hosts`, and who has sent no HEARTBEAT yet."""
    return [each.peer.address for each in channel._peers]


def crowd(*, one_host: bool = False, ids: int = 100) -> Channel:
    """A channel of a vehicle with keys whose places are all taken by unsigned programs."""
    channel = vehicle(keep(DRIVER, WATCHER, OTHER, SECOND_WATCHER), OPEN)
    for number in range(PLACES):
        address = ("10.0.0.1", number) if one_host else (f"10.0.0.{number}", 14550)
        channel.receive(heartbeat(0, system=ids), address, 0.001 * number)
    assert len(hosts(channel)) == PLACES
    return channel


def watched_crowd() -> Channel:
    """The same, with the runs of a watch key."""
    channel = vehicle(keep(DRIVER, WATCHER, OTHER, SECOND_WATCHER), OPEN)
    for number in range(PLACES):
        data = signed(key=WATCHER, stamp=NOW + number, ids=(100, 190), sequence=number)
        channel.receive(data, (f"10.0.0.{number}", 14550), 0.001 * number)
    assert len(hosts(channel)) == PLACES
    return channel


# ---- ranks ----


def test_unsigned_newcomer_of_a_new_host_has_no_place_in_a_crowd() -> None:
    channel = crowd()
    assert channel.receive(heartbeat(0), HERE, 1.0) == []
    assert channel.report().refused_peers == 1


def test_a_verified_newcomer_takes_the_place_heard_longest_ago() -> None:
    channel = crowd()
    channel.receive(heartbeat(1, system=100), ("10.0.0.0", 14550), 0.5)
    assert channel.receive(signed(key=WATCHER), HERE, 1.0) != []
    assert HERE in hosts(channel)
    assert ("10.0.0.1", 14550) not in hosts(channel)
    assert ("10.0.0.0", 14550) in hosts(channel)


def test_nobody_takes_the_place_back_from_a_verified_peer() -> None:
    channel = crowd()
    channel.receive(signed(), HERE, 1.0)
    for number in range(200):
        channel.receive(heartbeat(0, system=100), (f"10.2.0.{number}", 14550), 1.0 + number / 100)
    assert HERE in hosts(channel)


def test_a_drive_key_takes_the_place_of_a_watch_key() -> None:
    channel = watched_crowd()
    assert channel.receive(signed(key=OTHER), HERE, 1.0) != []
    assert channel.receive(signed(stamp=NOW + 1), THERE, 1.0) != []
    assert {HERE, THERE} <= set(hosts(channel))


def test_an_unsigned_peer_leaves_before_a_watch_key() -> None:
    channel = crowd()
    channel.receive(signed(key=WATCHER), HERE, 0.0)  # heard before all others
    for number in range(PLACES - 1):
        channel.receive(signed(stamp=NOW + number, sequence=number), (f"10.3.0.{number}", 14550), 1.0)
    assert HERE in hosts(channel)
    assert len(hosts(channel)) == PLACES


def test_the_unsigned_ids_in_control_keep_4_places() -> None:
    """An unsigned driver, where the vehicle allows one, goes on; strangers with its ids do not fill the table."""
    channel = crowd()
    for number in range(4):
        channel.receive(heartbeat(1), (f"10.0.0.{number}", 14550), 0.0)
    channel.reserve((255, 190))
    for number in range(PLACES + 10):
        data = signed(stamp=NOW + number, ids=(254, 190), sequence=number)
        channel.receive(data, (f"10.3.0.{number}", 1), 1.0)
    kept = [f"10.0.0.{number}" for number in range(4)]
    assert [each[0] for each in hosts(channel) if isinstance(each, tuple)][:4] == kept


def test_more_than_4_strangers_with_the_ids_in_control_leave() -> None:
    channel = crowd(ids=255)
    channel.reserve((255, 190))
    assert channel.receive(signed(ids=(254, 190)), HERE, 1.0) != []
    assert HERE in hosts(channel)


def test_a_verified_sender_without_heartbeat_keeps_its_place() -> None:
    channel = vehicle(keep(DRIVER), OPEN)
    channel.receive(signed(DISARM), HERE, 0.0)
    for number in range(200):
        channel.receive(heartbeat(0, system=100), (f"10.2.0.{number}", 14550), 1.0 + number / 100)
    (place,) = [peer for peer in channel._peers if peer.peer.address == HERE]
    assert [address for _, address, _ in channel.send(Outgoing(CommandAck(400, 0), place.peer))] == [HERE]


def watch_keys(count: int) -> list[SigningKey]:
    return [SigningKey(f"w{n}", SigningRole.WATCH, hashlib.sha256(bytes([n])).digest()) for n in range(count)]


@pytest.mark.parametrize(("newcomer", "admitted"), [(DRIVER, True), (OTHER, True), (SECOND_WATCHER, False)])
def test_a_drive_key_comes_before_watch_keys(newcomer: SigningKey, admitted: bool) -> None:
    """Each has one place, so that no key has more than its share."""
    keys = watch_keys(12)
    channel = vehicle(keep(*keys, newcomer), OPEN, places=12)
    for number, key in enumerate(keys):
        channel.receive(signed(key=key, ids=(number + 1, 190)), (f"10.0.0.{number}", 14550), 0.0)
    assert len(hosts(channel)) == 12
    channel.receive(signed(key=newcomer, ids=(200, 190)), HERE, 1.0)
    assert (HERE in hosts(channel)) is admitted


@pytest.mark.parametrize("newcomer", [heartbeat(0), signed(key=WATCHER)])
def test_a_sender_without_heartbeat_leaves_to_one_of_its_rank(newcomer: bytes) -> None:
    channel = vehicle(keep(DRIVER, WATCHER), OPEN)
    for number in range(PLACES):
        data = frame(ATTITUDE if number == 7 else HEARTBEAT, system=100)
        channel.receive(data, (f"10.0.0.{number}", 14550), 0.0)
    assert channel.receive(newcomer, HERE, 1.0) != []
    assert len(places(channel)) == PLACES
    assert ("10.0.0.7", 14550) not in places(channel)


# ---- shares ----


@pytest.mark.parametrize(("held", "admitted"), [((3, 0), True), ((2, 1), False), ((3, 1), True), ((3, 2), False)])
def test_a_key_gives_a_place_to_one_with_two_less(held: tuple[int, int], admitted: bool) -> None:
    """With one less the two would take the place from each other for ever."""
    keys = (WATCHER, SECOND_WATCHER)
    channel = vehicle(keep(*keys), OPEN, places=sum(held))
    for key, count in zip(keys, held, strict=True):
        for number in range(count):
            data = signed(key=key, stamp=NOW + number, ids=(100, 190), link_id=number)
            channel.receive(data, (f"10.{keys.index(key)}.0.{number}", 1), 0.0)
    assert len(hosts(channel)) == sum(held)
    channel.receive(signed(key=SECOND_WATCHER, stamp=NOW + 50, ids=(101, 190)), HERE, 1.0)
    assert (HERE in hosts(channel)) is admitted


def test_the_key_with_most_places_is_the_one_that_gives() -> None:
    keys = watch_keys(3)
    channel = vehicle(keep(*keys), OPEN, places=7)
    for key, count in zip(keys, (3, 4, 0), strict=True):
        for number in range(count):
            data = signed(key=key, stamp=NOW + number, ids=(100 + keys.index(key), 190), link_id=number)
            channel.receive(data, (f"10.{keys.index(key)}.0.{number}", 1), 0.0)
    assert channel.receive(signed(key=keys[2]), HERE, 1.0) != []
    assert len([each for each in hosts(channel) if str(each).startswith("('10.0")]) == 3
    assert len([each for each in hosts(channel) if str(each).startswith("('10.1")]) == 3


def test_a_host_does_not_pay_for_a_key_with_many_places() -> None:
    channel = vehicle(keep(WATCHER), OPEN, places=12)
    for number in range(6):
        channel.receive(signed(key=WATCHER, stamp=NOW + number, sequence=number), (f"10.0.0.{number}", 1), 0.0)
        channel.receive(heartbeat(0, system=100), (f"10.1.0.{number}", 1), 0.0)
    assert len(hosts(channel)) == 12
    assert channel.receive(heartbeat(0, system=101), THERE, 1.0) == []


def test_a_host_with_more_than_4_places_gives_one_up() -> None:
    channel = crowd(one_host=True)
    for number in range(PLACES - 4):
        assert channel.receive(heartbeat(0), (f"10.2.0.{number}", 14550), 1.0) != []
    assert channel.receive(heartbeat(0), HERE, 1.0) == []
    assert Counter(address[0] for address in hosts(channel) if isinstance(address, tuple))["10.0.0.1"] == 4


def test_the_key_with_most_places_gives_one_up_to_another_key() -> None:
    channel = watched_crowd()
    for number in range(12):
        data = signed(key=SECOND_WATCHER, stamp=NOW + number, ids=(101, 190), sequence=number)
        assert channel.receive(data, (f"10.4.0.{number}", 14550), 1.0) != []
    data = signed(key=SECOND_WATCHER, stamp=NOW + 50, ids=(101, 190), sequence=50)
    assert channel.receive(data, ("10.4.0.50", 14550), 1.0) == [], "each key has half of the places"


def test_programs_of_one_key_do_not_take_each_others_places() -> None:
    channel = watched_crowd()
    data = signed(key=WATCHER, stamp=NOW + 50, ids=(101, 190), sequence=50)
    assert channel.receive(data, HERE, 1.0) == []


# ---- a fleet ----


def fleet(runs: int, operator: str = "eve", now: float = 0.0) -> Channel:
    channel = Channel("zenoh:x", 0, system=1, component=1, stream=True, named=True)
    for number in range(runs):
        channel.receive(b"", f"{operator}/{number}", now)
        channel.receive(heartbeat(0, system=200), f"{operator}/{number}", now)
    return channel


def test_an_operator_of_a_fleet_has_4_places() -> None:
    channel = fleet(40)
    assert hosts(channel) == [f"eve/{number}" for number in range(4)]
    for address in ("alice/1", "carol/1"):
        channel.receive(b"", address, 0.1)
        assert channel.receive(heartbeat(0), address, 0.1) != []


def test_run_that_missed_heartbeat_leaves_its_place_to_the_next() -> None:
    channel = fleet(4)
    channel.receive(heartbeat(1, system=200), "eve/0", 1.0)
    assert channel.receive(heartbeat(0), "eve/9", 1.5) == []
    assert channel.receive(heartbeat(0), "eve/9", 1.51) != []
    assert hosts(channel) == ["eve/0", "eve/2", "eve/3", "eve/9"]


def test_a_run_takes_no_place_of_another_operator_or_of_a_name() -> None:
    channel = Channel("zenoh:x", 0, system=1, component=1, stream=True, named=True, target="eve/named")
    for address, now in (("bob/0", 0.0), ("eve/0", 3.0), ("eve/1", 3.0), ("eve/2", 3.0)):
        channel.receive(b"", address, now)
        channel.receive(heartbeat(0, system=200), address, now)
    assert channel.receive(heartbeat(0), "eve/9", 3.1) == []
    assert places(channel) == ["eve/named", "bob/0", "eve/0", "eve/1", "eve/2"]


@pytest.mark.parametrize(
    ("heard", "leaves"),
    [((2.0, 1.0, 1.0, 0.5), 3), ((2.0, 0.1, 0.2, 2.0), 1), ((2.0, None, 2.0, 2.0), 1), ((0.1, None, 2.0, 2.0), 0)],
)
def test_the_run_that_is_silent_for_longest_leaves(heard: tuple[float | None, ...], leaves: int) -> None:
    """None: it has connected just now and sent no HEARTBEAT."""
    channel = Channel("zenoh:x", 0, system=1, component=1, stream=True, named=True)
    for number, now in enumerate(heard):
        channel.receive(b"", f"eve/{number}", now or 2.0)
        if now is not None:
            channel.receive(heartbeat(0, system=200), f"eve/{number}", now)
    assert channel.receive(heartbeat(0), "eve/9", 2.1) != []
    assert {0, 1, 2, 3} - {leaves} == {int(str(each).split("/")[1]) for each in places(channel)} - {9}


def test_six_operators_do_not_keep_a_seventh_out() -> None:
    channel = fleet(4)
    for operator in "bcdfg":
        for number in range(4):
            channel.receive(heartbeat(0, system=200), f"{operator}/{number}", 0.0)
    assert len(hosts(channel)) == PLACES
    assert channel.receive(heartbeat(0), "carol/1", 0.1) != []
    assert "carol/1" in hosts(channel)


# ---- stops ----


def test_verified_stop_without_a_place_is_answered_with_its_key() -> None:
    channel = vehicle(keep(DRIVER, WATCHER), OPEN)
    for number in range(PLACES):
        data = signed(stamp=NOW + number, ids=(100, 190), sequence=number)
        channel.receive(data, (f"10.0.0.{number}", 14550), 0.0)
    ahead = NOW + 3600 * 100_000
    (found,) = channel.receive(signed(DISARM, WATCHER, ahead, ids=(254, 190)), HERE, 0.0)
    assert HERE not in hosts(channel)
    ((answer, address, _),) = channel.send(Outgoing(HEARTBEAT, found.peer), now=0.0)
    assert address == HERE
    assert link_and_stamp(answer)[1] >= ahead
    assert keep(WATCHER).verifier.check(answer, 1, 1, 0.0)


def test_a_stop_of_a_stranger_costs_no_place() -> None:
    channel = crowd()
    before = hosts(channel)
    assert channel.receive(frame(DISARM), HERE, 1.0) != []
    assert hosts(channel) == before


def test_a_stop_goes_to_peers_from_which_no_vehicle_was_heard() -> None:
    channel = crowd()
    assert [address for _, address, _ in channel.send(Outgoing(DISARM), now=1.0)] == hosts(channel)
