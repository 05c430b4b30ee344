"""A program that restarts a little behind its last packet number is another run; copies and late frames never are."""

from __future__ import annotations

from typing import NamedTuple

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.protocol.sequence import CLASH_SILENCE, LATE_WINDOW, NUMBERING_SILENCE, FrameOrder, SequenceTracker
from tests.rows import each_row

DEMAND, HEARTBEAT = 69, 0
NEW, LATE, DUPLICATE = FrameOrder.NEW, FrameOrder.LATE, FrameOrder.DUPLICATE
RATE = 20.0


class Frame(NamedTuple):
    """A frame of the former run; the digest tells each from all others."""

    number: int
    kind: int
    digest: int


class Former:
    """A run that has ended: frames at RATE, of which some got lost."""

    def __init__(self, first: int = 0, count: int = 60, lost: frozenset[int] = frozenset()) -> None:
        self.frames = [Frame((first + n) % 256, HEARTBEAT if n % 20 == 0 else DEMAND, 1000 + n) for n in range(count)]
        self.tracker = SequenceTracker(*self.frames[0], 0.0)
        self.ended = (count - 1) / RATE
        for n, frame in enumerate(self.frames[1:], 1):
            if n not in lost:
                self.tracker.accept(*frame, n / RATE)

    def after(self, silence: float, behind: int, digest: int, kind: int = DEMAND) -> FrameOrder:
        """Let a frame arrive `behind` the last number, `silence` s after the end."""
        return self.tracker.accept((self.frames[-1].number - behind) % 256, kind, digest, self.ended + silence)


@each_row("behind", [0, 1, 5, 31, LATE_WINDOW])
@each_row("silence", [CLASH_SILENCE + 0.01, 2.0, NUMBERING_SILENCE - 0.1])
def test_another_frame_with_number_of_a_silent_run_begins_a_run(silence: float, behind: int) -> None:
    former = Former()
    assert former.after(silence, behind, 1) is NEW
    assert (former.tracker.numbering.index, former.tracker.numbering.former) == (2, 1)
    assert not former.tracker.clash
    for step in range(1, behind + 20):  # past the last number of the former run
        assert former.after(silence + step * 0.002, behind - step, 1 + step) is NEW
        assert former.tracker.numbering.index == 2
        assert not former.tracker.clash


@pytest.mark.parametrize("silence", [0.0, 0.3, CLASH_SILENCE - 0.01])
def test_while_the_run_is_in_use_it_is_a_clash(silence: float) -> None:
    former = Former()
    assert former.after(silence, 5, 1) is NEW
    assert former.tracker.numbering.index == 1
    assert former.tracker.clash


def test_a_number_that_the_silent_run_has_not_used_is_late() -> None:
    former = Former(lost=frozenset(range(50, 56)))
    assert [former.after(1.0 + n * 0.05, 59 - 50 - n, n) for n in range(6)] == [LATE] * 6
    assert former.tracker.numbering.index == 1
    assert former.after(1.4, 59 - 56, 6) is NEW
    assert former.tracker.numbering.index == 2


def test_a_copy_of_the_former_run_within_the_next_is_a_clash() -> None:
    former = Former()
    former.after(1.0, 20, 1)
    copies = former.frames[-19:-12]  # next in the new run, by their numbers
    assert [former.tracker.accept(*copy, former.ended + 1.1) for copy in copies] == [NEW] * 7
    assert former.tracker.clash
    assert former.after(1.2, 11, 2) is NEW
    assert not former.tracker.clash, "it had another frame with this number"
    former.after(1.3, 8, 3)
    assert (
        former.tracker.accept(
            *former.frames[-11],
            former.ended + 1.3,
        )
        is LATE
    )
    assert former.tracker.accept(*former.frames[-10]._replace(kind=30), former.ended + 1.3) is NEW
    assert former.tracker.clash, "also one that others have overtaken"


def test_run_far_from_the_former_one_does_not_clash_with_copies() -> None:
    former = Former()
    assert former.after(1.0, LATE_WINDOW + 6, 1) is NEW
    assert former.tracker.numbering.former == 0
    for step, frame in enumerate(former.frames[-LATE_WINDOW - 6 : -1], 1):
        former.tracker.accept(*frame, former.ended + 1.0 + step * 0.02)
        assert not former.tracker.clash


def test_a_former_run_that_is_forgotten_counts_no_more() -> None:
    former = Former()
    former.after(1.0, 20, 1)
    copy = former.frames[-19]
    assert former.tracker.accept(*copy, former.ended + NUMBERING_SILENCE + 0.5) is NEW
    assert not former.tracker.clash


arrivals = st.lists(st.tuples(st.integers(0, LATE_WINDOW), st.floats(0.0, 0.1)), min_size=1, max_size=40)


@given(st.integers(0, 255), st.frozensets(st.integers(60, 98), max_size=25), st.floats(0.0, 0.9), arrivals)
def test_copies_and_late_frames_of_a_run_are_never_another_run(
    first: int, lost: frozenset[int], silence: float, again: list[tuple[int, float]]
) -> None:
    """Frames of the last 33 numbers, received or lost before, in any order, many times, while the run is silent."""
    former = Former(first, 100, lost)
    taken, now = {each for n, each in enumerate(former.frames) if n not in lost}, former.ended + silence
    newest = former.frames[-1]
    for behind, wait in again:
        frame = former.frames[-1 - behind]
        now += wait
        order = former.tracker.accept(*frame, now)
        assert former.tracker.numbering.index == 1
        assert order is (DUPLICATE if frame in taken else LATE) or frame.kind != newest.kind
        assert not former.tracker.clash
        taken.add(frame)
