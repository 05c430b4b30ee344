"""A program that is started again soon after it, or a verb before it, has ended must not seem to repeat old frames."""

from __future__ import annotations

import contextlib
from unittest import mock

import pytest

from dialects.messages import Heartbeat, RoverOperatorPresence
from link.core import Outgoing
from link.endpoint import Side
from link.links import open_links
from link.protocol.sequence import NEW, FrameOrder, SequenceTracker
from tests.ports import free_port

FRAMES = 24
"""Frames of a short verb."""
LOST = frozenset((2, 3, 5, 6))
"""Of these: the vehicle has not seen their numbers."""
PROOF, HEARTBEAT = RoverOperatorPresence.id, 0


def first_sequence(at: float) -> int:
    """Return the first packet sequence of a ground station that starts at a time."""
    with mock.patch("link.runner.time.monotonic", return_value=at):
        [link] = open_links([f"udpout:127.0.0.1:{free_port()}"], system=254, component=190, side=Side.GROUND_STATION)
    with contextlib.closing(link.transport):
        [frame] = link.channel.send(Outgoing(Heartbeat(6, 8, 0, 0, 4, 3)))
        return frame[2]


def second_program(first: int, second: int, after: float) -> list[FrameOrder]:
    """Return the orders of the first proofs of a program that starts `after` s behind the end of another one."""
    tracker = SequenceTracker(first, HEARTBEAT, 1, 10.0)
    for number in range(1, FRAMES):
        if number not in LOST:
            tracker.accept((first + number) & 0xFF, PROOF, 1000 + number, 10.0 + number * 0.01)
    began = 10.0 + FRAMES * 0.01 + after
    return [tracker.accept((second + n) & 0xFF, PROOF, 2000 + n, began + n * 0.01) for n in range(7)]


@pytest.mark.parametrize("after", [0.15, 0.5, 1.0, 2.0, 3.0, 4.7])
def test_the_first_proofs_of_the_next_program_are_new(after: float) -> None:
    first, second = first_sequence(10.0), first_sequence(10.0 + FRAMES * 0.01 + after)
    assert second_program(first, second, after) == [NEW] * 7


def test_with_the_same_first_number_they_would_be_late_at_first() -> None:
    assert FrameOrder.LATE in second_program(0, 0, 0.2)
    assert second_program(0, 0, 1.0) == [NEW] * 7  # a run of its own, by the numbers that were not lost
