"""Copies of packets stand in for lost ones, from the vehicle's end to the ground's, in virtual time."""

from __future__ import annotations

import random

from groundstation.stream.copies import KEPT, PacketCopies
from link.services.video_stream import COPY_PAYLOAD_TYPE
from tests.groundstation.stream.screens import GROUP, SCREEN, Ground, Sent, stream
from vehicle.camera.copies import COPY_DELAY, DelayedCopies

COUNT = 40 * GROUP


def copy_all(sent: list[Sent], count: int = 1) -> list[Sent]:
    """Return the copies that the vehicle sends, so many of each packet."""
    delayed, copies = DelayedCopies(count), []
    for at, packet in sent:
        delayed.add(packet, at)
    while (due := delayed.next_due) is not None:
        copies += [(due, packet) for packet in delayed.pop_due(due)]
    return copies


def pictures_of(came: list[Sent]) -> list[int]:
    copies, ground = PacketCopies(), Ground(SCREEN)
    firsts = [(at, copies.take(packet)) for at, packet in sorted(came, key=lambda each: each[0])]
    ground.take((at, first) for at, first in firsts if first is not None)
    return ground.pictures()


def test_a_copy_stands_in_for_a_lost_packet() -> None:
    sent = stream(COUNT, first=65_000)
    copies = copy_all(sent)
    assert [at for at, _ in copies] == [at + COPY_DELAY for at, _ in sent]
    assert {packet[1] & 0x7F for _, packet in copies} == {COPY_PAYLOAD_TYPE}
    assert copy_all(sent, 0) == []
    twice = copy_all(sent, 2)
    assert [at for at, _ in twice if at < COPY_DELAY + sent[1][0]] == [COPY_DELAY]
    assert sorted(packet for _, packet in twice) == sorted(packet for _, packet in copies * 2)
    assert max(at for at, _ in twice) == sent[-1][0] + 2 * COPY_DELAY
    chance = random.Random(1)
    came = [each for each in sent if chance.random() > 0.2 or each is sent[0]]
    assert len(pictures_of(came)) < COUNT / 2, "without them"
    assert pictures_of(came + copies) == pictures_of(copies) == list(range(COUNT))


def test_what_came_comes_once() -> None:
    copies, sent = PacketCopies(), stream(KEPT)
    assert len(sent) > 2 * KEPT
    for (_, packet), (_, copy) in zip(sent, copy_all(sent), strict=True):
        assert copies.take(packet) == packet
        assert copies.take(copy) is None
    assert len(copies._seen) == len(copies._order) == KEPT
    other = sent[-1][1][:8] + b"else" + sent[-1][1][12:]
    [(_, copy)] = copy_all([(0.0, other)])
    assert copies.take(copy) == other, "of another sender"
