"""Bulk answers keep to their share of each peer's link."""

from __future__ import annotations

import pytest

from link.core import Peer
from link.protocol.peer import FILE_RATE
from link.services.pacing import BURST_MAX, LOCAL_FILE_RATE, MAX_FRAME_RATE, MAX_PEERS, BulkPacer

SLOW, FAST = Peer(0, "radio"), Peer(1, "network")


def taken(pacer: BulkPacer, peer: Peer, seconds: float, size: int = 100, start: float = 0.0) -> int:
    """Bytes that go in ticks of 20 ms."""
    total = 0
    for step in range(round(seconds / 0.02)):
        while pacer.consume(peer, size, start + step * 0.02):
            total += size
    return total


@pytest.mark.parametrize(("peer", "rate"), [(SLOW, 2304.0), (FAST, 400_000.0)])
def test_each_peer_has_the_rate_of_its_link(peer: Peer, rate: float) -> None:
    pacer = BulkPacer(lambda asked: 2304.0 if asked == SLOW else 400_000.0)
    assert taken(pacer, peer, 10.0, size=250) == pytest.approx(rate * 10.0, rel=0.03)


def test_short_frames_are_no_more_than_a_ground_station_decodes() -> None:
    assert taken(BulkPacer(), FAST, 10.0, size=40) == pytest.approx(MAX_FRAME_RATE * 40 * 10.0, rel=0.03)


def test_send_at_once_fits_a_socket_buffer_and_uses_a_slow_link() -> None:
    fast, slow = BulkPacer(lambda peer: LOCAL_FILE_RATE), BulkPacer(lambda peer: 4800.0)
    assert taken(fast, FAST, 0.02, size=263) <= BURST_MAX
    assert taken(slow, SLOW, 20.0, size=263) == pytest.approx(4800.0 * 20.0, rel=0.01)


def test_files_at_full_pace_are_what_a_station_accepts() -> None:
    frames = taken(BulkPacer(lambda peer: LOCAL_FILE_RATE), FAST, 10.0, size=266) / 266 / 10.0
    assert 10_000 < frames < FILE_RATE


def test_losses_are_remembered_for_some_peers() -> None:
    pacer = BulkPacer()
    for number in range(MAX_PEERS + 1):
        pacer.note_loss(Peer(0, number))
    assert [pacer.is_lossy(Peer(0, number)) for number in (0, 1, MAX_PEERS)] == [False, True, True]


def test_one_peer_does_not_take_from_the_other() -> None:
    pacer = BulkPacer(lambda peer: 1000.0)
    taken(pacer, SLOW, 1.0)
    assert pacer.consume(FAST, 100, 1.0)


def test_a_link_that_slows_down_slows_the_answers() -> None:
    rate = 10_000.0
    pacer = BulkPacer(lambda peer: rate)
    assert taken(pacer, SLOW, 1.0) > 9_000
    rate = 1_000.0
    assert 900 <= taken(pacer, SLOW, 1.0, start=1.0) < 1_400


def test_the_longest_frame_gets_through_on_the_slowest_link() -> None:
    pacer = BulkPacer(lambda peer: 100.0)
    assert taken(pacer, SLOW, 10.0, size=280) > 0


def test_many_addresses_do_not_fill_the_memory() -> None:
    pacer = BulkPacer()
    for number in range(1000):
        pacer.consume(Peer(0, number), 10, 0.0)
    assert len(pacer._buckets) == MAX_PEERS
