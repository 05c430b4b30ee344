"""Packet numbers against a plain model, which keeps every frame under a number that never wraps; and exact limits."""

from __future__ import annotations

import random
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import pytest

from link.protocol.sequence import LATE_WINDOW, FrameOrder, SequenceTracker
from tests.link.calls import called
from tests.rows import each_row

NEW, LATE, DUPLICATE = FrameOrder.NEW, FrameOrder.LATE, FrameOrder.DUPLICATE


class Sent(NamedTuple):
    """A frame that arrives."""

    sequence: int
    kind: int
    digest: int
    now: float


@dataclass(eq=False)
class Run:
    """One run of numbers: all of its frames, and the times of those in the second that is measured."""

    index: int
    newest: int
    at: float
    digests: dict[int, int]
    kinds: dict[int, int]
    times: list[float]
    rate: float = 5.0
    received: int = 1
    former: int = 0
    """Index of the silent run in whose numbers this one has begun."""

    def place(self, frame: Sent) -> int | None:
        """The number of a frame here, without wrapping; None if it is of another run."""
        ahead = (frame.sequence - self.newest) % 256
        if ahead == 0 or ahead >= 256 - 32:
            return self.newest - (256 - ahead) % 256
        reach = min(127.0, 8 + 2 * max(self.rate, len(self.times)) * (frame.now - self.at))
        return self.newest + ahead if ahead <= reach else None

    def in_use(self, now: float) -> bool:
        return now - self.at <= 0.7

    def has_taken(self, frame: Sent) -> bool:
        behind = (self.newest - frame.sequence) % 256
        return behind <= 32 and self.digests.get(self.newest - behind) == frame.digest

    def add(self, number: int, frame: Sent) -> None:
        self.newest = max(number, self.newest)
        self.digests[number] = frame.digest
        self.kinds[frame.kind] = number

    def count(self, now: float) -> None:
        self.at = now
        self.received += 1
        self.times.append(now)
        if now - self.times[0] >= 1.0:
            self.rate = max(5.0, (len(self.times) - 1) / (now - self.times[0]))
            self.times = [now]


@dataclass
class Model:
    """What a SequenceTracker does, with everything kept."""

    received: int = 0
    lost: int = 0
    index: int = 0
    clash: bool = False
    runs: list[Run] = field(default_factory=list)
    begun: int = 0

    def accept(self, frame: Sent) -> FrameOrder:
        self.runs = [run for run in self.runs if frame.now - run.at <= 5.0]
        near = [(run, place) for run in self.runs if (place := run.place(frame)) is not None]
        if not near:
            return self.begin(frame)
        run, place = min(near, key=lambda each: (not each[0].in_use(frame.now), abs(each[1] - each[0].newest)))
        self.index, self.clash = run.index, False
        if place <= run.newest:
            return self.accept_old(run, place, frame)
        self.lost += place - run.newest - 1
        self.received += 1
        run.add(place, frame)
        run.count(frame.now)
        self.clash = self.is_crossed(run, frame.now) or self.is_of_former(run, frame)
        return NEW

    def accept_old(self, run: Run, place: int, frame: Sent) -> FrameOrder:
        if place in run.digests:
            if run.digests[place] != frame.digest and not run.in_use(frame.now):
                return self.begin(frame, former=run.index)
            self.clash = run.digests[place] != frame.digest
            self.received += self.clash
            return NEW if self.clash else DUPLICATE
        self.lost = max(0, self.lost - 1)
        run.digests[place] = frame.digest
        newer = run.kinds.get(frame.kind)
        if newer is not None and (newer - place) % 256 <= 32:
            return LATE
        run.add(place, frame)
        run.count(frame.now)
        self.received += 1
        self.clash = self.is_crossed(run, frame.now) or self.is_of_former(run, frame)
        return NEW

    def begin(self, frame: Sent, former: int = 0) -> FrameOrder:
        if len(self.runs) == 4:
            self.runs.remove(min(self.runs, key=lambda run: run.received))
        self.begun += 1
        number, kind, digest, now = frame
        self.runs.append(Run(self.begun, number, now, {number: digest}, {kind: number}, [now], former=former))
        self.received += 1
        self.index, self.clash = self.begun, False
        return NEW

    def is_crossed(self, run: Run, now: float) -> bool:
        others = [each for each in self.runs if each is not run and each.in_use(now)]
        return any((each.newest - run.newest + 8) % 256 <= 16 for each in others)

    def is_of_former(self, run: Run, frame: Sent) -> bool:
        return any(each.index == run.former and each.has_taken(frame) for each in self.runs)


def traffic(chance: random.Random, steps: int) -> Iterator[Sent]:
    """Frames of up to three programs with losses, repeats, overtaken frames, silences and jumps."""
    now, senders, past = 0.0, [chance.randrange(256) for _ in range(chance.choice((1, 1, 2, 3)))], list[Sent]()
    for _ in range(steps):
        now += chance.choice(
            (0.0, 0.0, 0.01, 0.01, 0.02, 0.05, 0.125, 0.25, 0.75, 1.0, chance.choice((0.01, 3.0, 6.0)))
        )
        which, event = chance.randrange(len(senders)), chance.random()
        if past and event < 0.15:
            yield past[-chance.randrange(1, 1 + min(40, len(past)))]._replace(now=now)
            continue
        step = chance.choice((1, 1, 1, 1, 2, 3, 8, 9, -1, -2, -5, -32, -33, 0, 20, 127, 128)) if event < 0.6 else 1
        senders[which] += step
        frame = Sent(senders[which] % 256, chance.choice((30, 30, 69)), chance.randrange(1, 1000), now)
        past.append(frame)
        yield frame


@pytest.mark.parametrize("seed", range(8))
def test_numbers_count_as_in_the_model(seed: int) -> None:
    chance = random.Random(seed)
    for _ in range(25):
        model = Model()
        tracker: SequenceTracker | None = None
        for frame in traffic(chance, 80):
            expected = model.accept(frame)
            if tracker is None:
                tracker, order = SequenceTracker(*frame), NEW
            else:
                order = tracker.accept(*frame)
            state = (order, tracker.numbering.index, tracker.clash, tracker.received, tracker.lost)
            assert state == (expected, model.index, model.clash, model.received, model.lost), frame


@each_row("ahead", range(1, 9))
@each_row("wait", [0.0, 0.5, 5.0])
def test_the_next_frame_of_the_only_sender_takes_one_call(ahead: int, wait: float) -> None:
    for start in (0, 250):
        tracker = SequenceTracker(start, 30, 1, 100.0)
        calls = called(partial(tracker.accept, (start + ahead) % 256, 30, 2, 100.0 + wait))
        assert [each for each in calls if each != "_begin_window"] == ["accept", "advance"]
        assert (tracker.received, tracker.lost) == (2, ahead - 1)


def test_a_numbering_remembers_a_bounded_number_of_frames() -> None:
    tracker = SequenceTracker(0, 30, 1, 0.0)
    for number in range(1, 1000):
        tracker.accept(number % 256, 30, number, number / 100)
    assert tracker.numbering._seen.bit_length() == LATE_WINDOW + 1 == 33
    assert len(tracker.numbering._digests) >= 33


@pytest.mark.parametrize("overtaken", [False, True])
@pytest.mark.parametrize(("gap", "numbering"), [(40, 1), (41, 2)])
def test_the_rate_is_that_of_exactly_one_second(overtaken: bool, gap: int, numbering: int) -> None:
    tracker = SequenceTracker(0, 30, 1, 0.0)
    for number in range(1, 31):
        tracker.accept(number, 30, number, number / 32)
    order = ((32, 30), (31, 69)) if overtaken else ((31, 30), (32, 30))
    for at, (number, kind) in zip((31 / 32, 1.0), order, strict=True):
        assert tracker.accept(number, kind, number, at) is NEW
    tracker.accept(32 + gap, 30, 99, 1.5)  # 8 + 2 * 32 / s * 0.5 s = 40
    assert tracker.numbering.index == numbering


def test_an_overtaken_frame_ends_no_window_early() -> None:
    tracker = SequenceTracker(0, 30, 1, 0.0)
    for number in (*range(1, 20), 21):
        tracker.accept(number, 30, number, number / 40)
    assert tracker.accept(20, 69, 20, 0.6) is NEW
    tracker.accept(21 + 25, 30, 99, 0.9)  # 8 + 2 * 22 / s * 0.3 s = 21
    assert tracker.numbering.index == 2


def test_a_rare_message_that_was_overtaken_is_not_late() -> None:
    tracker = SequenceTracker(0, 69, 1, 0.0)
    for number in (*range(1, 223), 224):
        tracker.accept(number, 30, number, number / 100)
    assert tracker.accept(223, 69, 223, 2.25) is NEW


def test_newest_frames_are_known_again_where_the_numbers_wrap() -> None:
    tracker = SequenceTracker(0, 30, 1000, 0.0)
    for number in range(1, 600):
        assert tracker.accept(number % 256, 30, 1000 + number, number / 100) is NEW
        for back in range(min(number, 32) + 1):
            assert tracker.accept((number - back) % 256, 30, 1000 + number - back, number / 100) is DUPLICATE


@pytest.mark.parametrize(("back", "numbering"), [(32, 1), (33, 2)])
def test_a_frame_is_late_up_to_32_numbers_behind(back: int, numbering: int) -> None:
    tracker = SequenceTracker(100, 30, 1, 0.0)
    tracker.accept(101, 30, 2, 0.0)
    tracker.accept((101 - back) % 256, 69, 3, 0.0)
    assert tracker.numbering.index == numbering


@pytest.mark.parametrize(("ahead", "wait", "numbering"), [(8, 0.0, 1), (9, 0.0, 2), (127, 4.9, 1), (128, 4.9, 2)])
def test_a_number_may_be_8_ahead_at_once_and_127_after_a_silence(ahead: int, wait: float, numbering: int) -> None:
    tracker = SequenceTracker(100, 30, 1, 0.0)
    for step in range(50):
        tracker.accept(101 + step, 30, 2 + step, 0.0)
    tracker.accept((150 + ahead) % 256, 30, 99, wait)
    assert tracker.numbering.index == numbering


@pytest.mark.parametrize(("silence", "numbering"), [(5.0, 1), (5.001, 2)])
@pytest.mark.parametrize("others", [0, 1])
def test_a_numbering_lives_for_5_s_of_silence(silence: float, numbering: int, others: int) -> None:
    tracker = SequenceTracker(100, 30, 1, 0.0)
    for _ in range(others):
        tracker.accept(200, 30, 2, 0.0)
    tracker.accept(101, 30, 3, silence)
    assert tracker.numbering.index == (1 if silence == 5.0 else numbering + others)


@pytest.mark.parametrize(("silence", "clash"), [(0.7, True), (0.701, False)])
def test_numberings_clash_up_to_a_silence_of_700_ms(silence: float, clash: bool) -> None:
    tracker = SequenceTracker(100, 30, 1, 0.0)
    tracker.accept(110, 30, 2, 0.0)  # too far for the first: another one
    assert tracker.numbering.index == 2
    tracker.accept(101, 30, 3, silence)
    assert (tracker.numbering.index, tracker.clash) == (1, False)
    tracker.accept(102, 30, 4, silence)
    assert tracker.clash is clash, "8 numbers apart"


def test_the_numbering_with_the_fewest_frames_is_given_up() -> None:
    tracker = SequenceTracker(10, 30, 1, 0.0)
    for number, kind in ((14, 30), (13, 69), (12, 76)):  # 4 frames, two of them overtaken
        assert tracker.accept(number, kind, number, 0.0) is NEW
    for start in (100, 150, 200):  # 3, 5 and 5 frames in order
        for step in range(3 if start == 100 else 5):
            tracker.accept(start + step, 30, start, 0.0)
    tracker.accept(60, 30, 60, 0.0)
    tracker.accept(15, 30, 15, 0.0)
    assert tracker.numbering.index == 1
    tracker.accept(205, 30, 205, 0.0)
    assert tracker.numbering.index == 4
    tracker.accept(103, 30, 103, 0.0)
    assert tracker.numbering.index == 6
