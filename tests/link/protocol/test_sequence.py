"""Sequence numbers of one sender: lost, repeated, overtaken, restarted."""

from __future__ import annotations

from link.protocol.sequence import LATE_WINDOW, RESTART_AFTER, FrameOrder, SequenceTracker

ONE, OTHER = 69, 76
"""Message ids."""


def test_a_gap_is_a_loss_until_the_late_frame_fills_it() -> None:
    tracker = SequenceTracker(250, ONE)
    assert tracker.accept(251, ONE) is FrameOrder.NEW
    assert tracker.accept(2, ONE) is FrameOrder.NEW  # over the end of the numbers
    assert (tracker.received, tracker.lost) == (3, 6)
    assert tracker.accept(1, ONE) is FrameOrder.LATE
    assert tracker.lost == 5


def test_a_number_counts_once() -> None:
    tracker = SequenceTracker(7, ONE)
    assert tracker.accept(7, ONE) is FrameOrder.DUPLICATE
    assert tracker.accept(8, ONE) is FrameOrder.NEW
    assert tracker.accept(7, ONE) is FrameOrder.DUPLICATE
    assert tracker.received == 2


def test_an_overtaken_frame_of_another_message_is_new() -> None:
    tracker = SequenceTracker(1, ONE)
    tracker.accept(3, ONE)
    assert tracker.accept(2, OTHER) is FrameOrder.NEW
    assert tracker.lost == 0


def test_old_frames_in_a_row_are_a_restart_and_so_is_one_far_behind() -> None:
    tracker = SequenceTracker(100, ONE)
    for number in range(RESTART_AFTER):
        assert tracker.accept(80 + number, ONE) is FrameOrder.LATE
    assert tracker.accept(80 + RESTART_AFTER, ONE) is FrameOrder.NEW
    assert SequenceTracker(100, ONE).accept(100 - LATE_WINDOW - 1, ONE) is FrameOrder.NEW
