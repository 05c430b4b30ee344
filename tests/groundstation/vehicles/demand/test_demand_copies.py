"""Copies of a changed demand: how soon, how many, and how much of a line they take."""

from __future__ import annotations

import pytest

from dialects.axes import NEUTRAL, Axes
from groundstation.vehicles.demand.demand_copies import DEMAND_BYTES, MOST, PERIOD, SHARE, DemandCopies
from groundstation.vehicles.demand.demand_stream import CLOSEST, DRIVING_PERIOD, DemandStream
from link.transport.memory import LossyPipe

AHEAD = Axes(0.6, 0.0)
STEP = 0.0005


def play(stream: DemandStream, demand: Axes, start: float, seconds: float) -> list[float]:
    """Return when something was sent, asked whenever the stream says so and at a coarse tick."""
    steps = [start + STEP * step for step in range(round(seconds / STEP))]
    sent = []
    for number, now in enumerate(steps):
        due = stream.due_at
        if (number % 50 == 0 or (due is not None and now >= due)) and stream.next_due(demand, True, now) == demand:
            sent.append(now)
    return sent


@pytest.mark.parametrize(("loss", "least"), [(None, 1), (0.0, 1), (0.05, 3), (0.10, 5), (0.20, 5)])
def test_more_loss_means_more_copies_within_one_period(loss: float | None, least: int) -> None:
    stream = DemandStream(DemandCopies())
    stream.adapt(loss, None)
    sent = play(stream, AHEAD, 0.0, DRIVING_PERIOD)
    assert len(sent) == 1 + least
    assert sent[0] == 0.0
    assert all(at <= 0.017 for at in sent)


def test_a_newer_change_ends_the_copies_of_the_one_before() -> None:
    stream = DemandStream(DemandCopies())
    stream.adapt(0.2, None)
    assert stream.next_due(AHEAD, True, 0.0) == AHEAD
    assert stream.next_due(NEUTRAL, True, 0.001) == NEUTRAL
    assert stream.next_due(NEUTRAL, True, 0.002) is None, "due for the change at 0 only"
    assert stream.next_due(NEUTRAL, True, 0.0031) == NEUTRAL
    assert stream.copying


def test_what_is_no_longer_demanded_is_not_copied() -> None:
    stream = DemandStream(DemandCopies())
    stream.next_due(AHEAD, True, 0.0)
    assert stream.next_due(Axes(0.3, 0.0), True, 0.004) is None
    assert stream.due_at == CLOSEST, "the newer one goes out as soon as the vehicle takes it, and at no tick"
    assert stream.next_due(Axes(0.3, 0.0), True, CLOSEST) == Axes(0.3, 0.0)


def test_the_last_neutral_of_a_drive_is_copied_too() -> None:
    stream = DemandStream(DemandCopies())
    stream.next_due(AHEAD, True, 0.0)
    assert stream.next_due(AHEAD, False, 0.001) == NEUTRAL
    assert stream.next_due(AHEAD, False, 0.0041) == NEUTRAL
    assert stream.copying


def count_in_any_period(times: list[float]) -> int:
    return max(sum(start <= at < start + PERIOD for at in times) for start in times)


@pytest.mark.parametrize("capacity", [1200.0, 5760.0, 11520.0])
@pytest.mark.parametrize("loss", [0.0, 0.2])
def test_copies_never_take_more_than_their_share_of_a_slow_line(capacity: float, loss: float) -> None:
    copies = DemandCopies()
    copies.adapt(loss, capacity)
    sent = []
    for step in range(3000):
        now = step * 0.001
        if step % 20 == 0:
            copies.plan(now)
        if copies.take(now, neutral=step % 40 < 20):
            sent.append(now)
    assert sent
    assert count_in_any_period(sent) * DEMAND_BYTES <= SHARE * capacity * PERIOD


def test_room_is_kept_for_neutral() -> None:
    copies = DemandCopies()
    copies.adapt(0.2, 5760.0)
    moving = []
    for step in range(100):
        copies.plan(step * 0.009)
        moving += [copies.take(step * 0.009 + 0.002, neutral=False)]
        if not moving[-1]:
            break
    assert any(moving)
    assert not moving[-1]
    assert copies.take(step * 0.009 + 0.004, neutral=True)


def test_without_a_known_capacity_the_vehicle_takes_all_copies() -> None:
    copies = DemandCopies()
    copies.adapt(0.5, None)
    sent = []
    for step in range(4000):
        if step % 10 == 0:
            copies.plan(step * 0.001)
        if copies.take(step * 0.001, neutral=True):
            sent.append(step * 0.001)
    assert count_in_any_period(sent) == MOST


@pytest.mark.parametrize(("loss", "within"), [(0.1, 0.010), (0.2, 0.020)])
def test_p99_over_a_bad_network(loss: float, within: float) -> None:
    stream, pipe = DemandStream(DemandCopies()), LossyPipe[bytes](delay=0.010, jitter=0.003, loss=loss, seed=5)
    stream.adapt(loss, None)
    late = []
    for change in range(1000):
        demand, start = (AHEAD, NEUTRAL)[change % 2], change * 0.12
        arrived = None
        for step in range(200):
            now = start + step * STEP
            if stream.next_due(demand, True, now) is not None:
                pipe.send(repr(demand).encode(), now)
            if arrived is None and repr(demand).encode() in pipe.receive(now):
                arrived = now - start
        assert arrived is not None
        late.append(arrived)
    assert sorted(late)[990] <= 0.010 + within
