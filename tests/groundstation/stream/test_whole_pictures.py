"""A decoder of a screen gets whole pictures whose references are whole, in virtual time and without ffmpeg."""

from __future__ import annotations

import random

from groundstation.stream.rtp import WAIT
from tests.groundstation.stream.screens import GROUP, OTHER, PERIOD, SCREEN, Ground, stream


def test_a_whole_picture_goes_on_at_once() -> None:
    ground, sent = Ground(SCREEN, OTHER), stream(3 * GROUP, first=65_520)
    ground.take(sent)
    assert ground.pictures() == ground.pictures(OTHER) == list(range(3 * GROUP))
    ends = {packet[4:8]: at for at, packet in sent}
    assert all(at == ends[packet[4:8]] for at, packet in ground.got[SCREEN]), "when its last packet came"


def test_after_a_lost_packet_nothing_goes_until_a_key_picture() -> None:
    sent = stream(4 * GROUP)
    places = [at for at, (_, packet) in enumerate(sent) if GROUP <= int.from_bytes(packet[4:8], "big") // 6000 < 10]
    assert len(places) == 4 + 4 * 3
    for lost in places:
        ground = Ground(SCREEN)
        ground.take(sent[:lost] + sent[lost + 1 :])
        broken = int.from_bytes(sent[lost][1][4:8], "big") // 6000
        assert ground.pictures() == [*range(broken), *range(2 * GROUP, 4 * GROUP)], lost


def test_packets_out_of_order_break_nothing() -> None:
    chance = random.Random(3)
    sent = [(at + chance.random() * 0.4 * WAIT, packet) for at, packet in stream(4 * GROUP)]
    ground = Ground(SCREEN)
    twice = [(at + 0.3 * WAIT, packet) for at, packet in sent[5:9]]
    ground.take(stream(1) + sent[4:] + twice)
    assert ground.pictures() == list(range(4 * GROUP))


def test_a_sender_that_starts_again_begins_with_a_key_picture() -> None:
    ground = Ground(SCREEN)
    ground.take(stream(GROUP + 2) + stream(2 * GROUP, first=30_000, source=8, begin=2.0)[4:])
    seen = ground.got[SCREEN]
    assert [int.from_bytes(packet[4:8], "big") // 6000 for at, packet in seen if at > 2.0][:4] == [GROUP] * 4
    numbers = [int.from_bytes(packet[2:4], "big") for _, packet in seen]
    assert numbers == list(range(len(numbers))), "a decoder waits for none"


def test_a_screen_that_joins_gets_whole_groups() -> None:
    ground, sent = Ground(SCREEN), stream(3 * GROUP)
    ground.take(each for each in sent if each[0] < 2 * PERIOD)
    ground.screens = SCREEN, OTHER
    ground.take(each for each in sent if 2 * PERIOD <= each[0] < 8 * PERIOD)
    ground.screens = (OTHER,)
    ground.take(each for each in sent if each[0] >= 8 * PERIOD)
    assert ground.pictures() == list(range(8))
    assert min(int.from_bytes(packet[4:8], "big") // 6000 for _, packet in ground.got[OTHER]) == GROUP
