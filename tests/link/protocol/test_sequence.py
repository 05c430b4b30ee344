"""Sequence numbers of one sender: lost, repeated, overtaken; and the runs of numbers that are kept apart."""

from __future__ import annotations

import pytest

from link.protocol.sequence import (
    CLASH_SILENCE,
    CLOSE,
    LATE_WINDOW,
    NUMBERING_SILENCE,
    NUMBERINGS_MAX,
    REACH_MAX,
    FrameOrder,
    SequenceTracker,
)

ONE, OTHER = 69, 76
"""Message ids."""
NEW, LATE, DUPLICATE = FrameOrder.NEW, FrameOrder.LATE, FrameOrder.DUPLICATE


class Sender:
    """A tracker, and frames that all differ unless a test says otherwise."""

    def __init__(self, first: int = 0, message_id: int = ONE) -> None:
        self.now = 100.0
        self.digest = first + 1000
        self.tracker = SequenceTracker(first, message_id, self.digest, self.now)

    def take(self, sequence: int, message_id: int = ONE, *, digest: int | None = None, wait: float = 0.0) -> FrameOrder:
        self.now += wait
        self.digest = sequence + 1000 if digest is None else digest
        return self.tracker.accept(sequence % 256, message_id, self.digest, self.now)

    def stream(self, start: int, count: int, rate: float) -> Sender:
        """Frames in order at `rate`/s."""
        for number in range(start, start + count):
            assert self.take(number, wait=1.0 / rate) is NEW
        return self

    @property
    def numbering(self) -> int:
        return self.tracker.numbering.index


def test_a_gap_is_a_loss_until_the_late_frame_fills_it() -> None:
    sender = Sender(250)
    assert sender.take(251) is NEW
    assert sender.take(256 + 2) is NEW  # over the end of the numbers
    assert (sender.tracker.received, sender.tracker.lost) == (3, 6)
    assert sender.take(256 + 1) is LATE
    assert sender.tracker.lost == 5


def test_a_number_counts_once() -> None:
    sender = Sender(7)
    assert sender.take(7) is DUPLICATE
    assert sender.take(8) is NEW
    assert sender.take(7) is DUPLICATE
    assert sender.tracker.received == 2
    assert not sender.tracker.clash


def test_an_overtaken_frame_of_another_message_is_new() -> None:
    sender = Sender(1)
    sender.take(3)
    assert sender.take(2, OTHER) is NEW
    assert sender.tracker.lost == 0
    assert sender.numbering == 1


def test_a_frame_that_fills_a_gap_is_a_duplicate_the_second_time() -> None:
    sender = Sender(1)
    sender.take(4)
    assert [sender.take(2), sender.take(2)] == [LATE, DUPLICATE]
    assert [sender.take(3, OTHER), sender.take(3, OTHER)] == [NEW, DUPLICATE]


def test_old_frames_never_pass_for_a_restart() -> None:
    sender = Sender().stream(1, 100, 20)
    orders = [sender.take(70 + number, digest=1) for number in range(30)]  # seen before, as other frames
    assert orders == [NEW] * 30
    assert sender.tracker.clash
    sender = Sender()
    sender.take(0)
    sender.stream(1, 60, 20).tracker.lost = 0
    gap = Sender(100)
    gap.tracker.numbering.advance(120, ONE, 1, gap.now)
    assert [gap.take(number) for number in range(101, 120)] == [LATE] * 19


@pytest.mark.parametrize("lag", [33, 60, 90, 120])
def test_frames_from_further_back_are_another_numbering(lag: int) -> None:
    sender = Sender().stream(1, 200, 20)
    assert sender.take(200 - lag) is NEW
    assert sender.numbering == 2
    assert not sender.tracker.clash
    assert sender.take(201, wait=0.05) is NEW
    assert sender.numbering == 1
    assert sender.take(201 - lag) is NEW
    assert sender.numbering == 2


@pytest.mark.parametrize(("gap", "same"), [(CLOSE, True), (CLOSE + 1, True), (10, True), (11, False), (127, False)])
def test_a_sender_cannot_count_faster_than_it_sends(gap: int, same: bool) -> None:
    sender = Sender().stream(1, 60, 20)
    assert sender.take(60 + gap, wait=0.05) is NEW  # 8 + 2 * 20 / s * 0.05 s = 10
    assert (sender.numbering == 1) is same
    assert sender.tracker.lost == (gap - 1 if same else 0)


@pytest.mark.parametrize(("gap", "same"), [(60, True), (REACH_MAX, True), (REACH_MAX + 1, False), (200, False)])
def test_after_a_silence_it_may_have_counted_half_of_the_numbers(gap: int, same: bool) -> None:
    sender = Sender().stream(1, 60, 20)
    sender.take(60 + gap, wait=4.0)
    assert (sender.numbering == 1) is same


def test_the_rate_is_at_least_five_a_second() -> None:
    sender = Sender()
    assert sender.take(CLOSE + 10, wait=1.0) is NEW  # 8 + 2 * 5 / s * 1 s
    assert sender.numbering == 1
    sender = Sender()
    sender.take(CLOSE + 11, wait=1.0)
    assert sender.numbering == 2


def test_a_fast_sender_with_losses_stays_in_one_numbering() -> None:
    sender = Sender()
    number = 0
    for step in range(1, 3000):  # 500/s, and every second frame of each half second lost in a row of 40
        number += 41 if step % 250 == 0 else 1
        sender.take(number, wait=(41 if step % 250 == 0 else 1) / 500)
    assert sender.numbering == 1
    assert sender.tracker.lost == 40 * 11


@pytest.mark.parametrize(("gap", "same"), [(69, True), (70, False)])
def test_overtaken_frame_ends_a_second_of_the_rate_measurement(gap: int, same: bool) -> None:
    sender = Sender().stream(1, 60, 100)
    assert sender.take(62, wait=0.3) is NEW
    assert sender.take(61, OTHER, wait=0.11) is NEW  # the 62 frames before it took 1.01 s
    sender.take(62 + gap, wait=0.5)  # 8 + 2 * 61.4 / s * 0.5 s = 69.4
    assert (sender.numbering == 1) is same


def test_a_numbering_is_forgotten_after_its_silence() -> None:
    sender = Sender().stream(1, 20, 20)
    assert sender.take(21, wait=NUMBERING_SILENCE) is NEW
    assert sender.numbering == 1
    assert sender.take(22, wait=NUMBERING_SILENCE + 0.01) is NEW
    assert sender.numbering == 2


def test_it_knows_which_messages_any_run_of_numbers_has_had() -> None:
    sender = Sender().stream(1, 20, 20)
    sender.take(200, OTHER)
    assert sender.numbering == 2
    assert [sender.tracker.has_received(number) for number in (ONE, OTHER, 0)] == [True, True, False]


def test_two_programs_with_one_number_clash() -> None:
    sender = Sender().stream(1, 20, 20)
    assert sender.take(20, digest=5) is NEW
    assert sender.tracker.clash
    assert sender.take(21) is NEW
    assert not sender.tracker.clash


def test_two_numberings_clash_while_they_cross() -> None:
    sender = Sender().stream(1, 100, 20)
    clashes = []
    for step in range(40):  # another program counts twice as fast, from 30 numbers behind the window
        sender.take(101 + step, wait=0.02)
        for half in (0, 1):
            sender.take(101 - 45 + 2 * step + half, digest=9000 + step, wait=0.015)
            clashes.append(sender.tracker.clash)
    assert any(clashes)
    assert not clashes[0]


def test_a_silent_numbering_clashes_with_none() -> None:
    def cross(silence: float) -> bool:
        sender = Sender().stream(1, 100, 20)
        sender.take(50)
        assert sender.numbering == 2
        sender.tracker.numbering.newest = 94  # of the second
        return sender.take(101, wait=silence) is NEW and sender.numbering == 1 and sender.tracker.clash

    assert cross(CLASH_SILENCE - 0.01)
    assert not cross(CLASH_SILENCE + 0.01)


def test_a_silent_numbering_takes_no_frames_from_one_in_use() -> None:
    sender = Sender().stream(1, 100, 20)
    sender.take(50)
    sender.tracker.numbering.newest = 120
    for number in range(101, 140):
        assert sender.take(number, wait=0.05) is NEW
        if number > 101 + 20 * CLASH_SILENCE:
            assert sender.numbering == 1
            assert not sender.tracker.clash


def test_of_too_many_numberings_the_least_used_is_forgotten() -> None:
    sender = Sender().stream(1, 100, 20)
    for index, start in enumerate((160, 200, 240, 30)):
        sender.take(start)
        assert sender.numbering == index + 2
    assert NUMBERINGS_MAX == 4
    assert sender.take(101) is NEW
    assert sender.numbering == 1  # the most used one stays
    sender.take(161)
    assert sender.numbering > 4  # one frame only, and the first of those
    assert LATE_WINDOW == 32


def test_numbers_that_are_left_out_on_purpose_are_not_lost() -> None:
    sender = Sender()
    sender.tracker.expect_gaps(sender.now + 10.0)
    for step in range(1, 20):
        assert sender.take(100 * step, wait=0.05) is NEW
    assert (sender.tracker.received, sender.tracker.lost, sender.numbering) == (20, 0, 1)
    assert sender.take(1900) is DUPLICATE
    sender.take(1900 + 200)
    assert (sender.tracker.lost, sender.numbering) == (0, 2), "another numbering, as without gaps"


def test_from_then_on_they_are_lost_again() -> None:
    sender = Sender()
    sender.tracker.expect_gaps(sender.now + 1.0)
    sender.take(50, wait=1.0)
    assert sender.numbering == 1
    sender.take(53, wait=0.1)
    assert sender.tracker.lost == 2


def test_late_frames_and_jumps_among_expected_gaps_are_no_loss() -> None:
    sender = Sender().stream(1, 60, 20)
    sender.take(63)
    sender.take(200)
    assert (sender.tracker.lost, sender.numbering) == (2, 2)
    sender.tracker.expect_gaps(sender.now + 10.0)
    assert sender.take(62) is LATE
    assert sender.tracker.lost == 1
    assert sender.take(70) is NEW
    assert (sender.tracker.lost, sender.numbering) == (1, 1)
